#include "optimize/option_table.h"

#include "burnish/error.h"
#include "gradient/estimator.h"
#include "render/renderer.h"

namespace burnish {

namespace {

constexpr OptionLevel kBasic = OptionLevel::kBasic;
constexpr double kMaxCount = std::numeric_limits<std::uint32_t>::max();
constexpr double kNever = std::numeric_limits<double>::infinity();

constexpr Range kSamples{1, 4096, true};
constexpr Range kImageSamples{1, kMaxSamplesPerPixel, true};
constexpr Range kDecay{0, 0.999999};

// One sentence each for what several estimators have.
constexpr const char* kFreshSpp =
    "Fresh samples per pixel of an iteration's image, by default in two halves: an odd number "
    "loses one, 1 counts as 2; no more than twice a window are traced";
constexpr const char* kImageWindow =
    "The most passes of the image that each half keeps and shades again; 0: fresh samples alone";
constexpr const char* kGradientSpp = "Samples per pixel of the derivative in an iteration";
constexpr const char* kAdaptive = "The derivative's samples go where pixels matter, else evenly";

template <class E>
bool holds(const Options& o) {
    return std::holds_alternative<E>(o.estimator);
}
bool reuses(const Options& o) {
    const auto* r = std::get_if<Reservoirs>(&o.estimator);
    return r && r->reuse;
}
bool has_levels(const Options& o) { return has_pyramid(o) && o.pyramid.levels > 1; }

constexpr OptionCondition kPathCache{"the estimator path_cache", holds<PathCache>};
constexpr OptionCondition kMonteCarlo{"the estimator mc", holds<MonteCarlo>};
constexpr OptionCondition kReservoirs{"the estimator ris, pris, gris or pgris", holds<Reservoirs>};
constexpr OptionCondition kReuse{"an estimator that reuses reservoirs, gris or pgris", reuses};
constexpr OptionCondition kPyramid{"the parameterization pyramid", has_pyramid};
constexpr OptionCondition kLevels{"the parameterization pyramid of two levels or more", has_levels};
constexpr OptionCondition kSplit{"an estimator with a split-sample gradient, path_cache",
                                 [](const Options& o) { return has_split_gradient(o.estimator); }};
constexpr OptionCondition kUnrated{"an unknown without a learning rate of its own", nullptr};
constexpr OptionCondition kSearchedStart{"an unknown whose start is searched", nullptr};
constexpr OptionCondition kNoImageStart{"a start that is searched or a number", nullptr};
constexpr OptionCondition kSeveralViews{"several views", nullptr};

/// A field of the options, and of an estimator.
template <auto member>
constexpr auto of_options() {
    return +[](Options& o) { return &(o.*member); };
}
template <auto part, auto member>
constexpr auto of_part() {
    return +[](Options& o) { return &(o.*part.*member); };
}
template <class E, auto member>
constexpr auto of() {
    return +[](Options& o) {
        E* e = std::get_if<E>(&o.estimator);
        return e ? &(e->*member) : nullptr;
    };
}

constexpr OptionRow kTable[] = {
    {{.name = "estimator",
      .flag = "--estimator",
      .level = kBasic,
      .sentence = "How the gradient is estimated"},
     of_options<&Options::estimator>()},
    {{.name = "path_cache.samples",
      .flag = "--spp",
      .level = kBasic,
      .sentence = "Fresh samples per pixel of an iteration; at most twice a window are traced",
      .range = kSamples},
     of<PathCache, &PathCache::samples>(),
     kPathCache},
    {{.name = "path_cache.window",
      .sentence = "The most passes that each half of the path cache keeps",
      .range = {1, 1 << 20, true}},
     of<PathCache, &PathCache::window>(),
     kPathCache},
    {{.name = "path_cache.sequence",
      .sentence = "How the random numbers of a pixel depend on each other from pass to pass"},
     of<PathCache, &PathCache::sequence>(),
     kPathCache},
    {{.name = "path_cache.max_bytes",
      .sentence = "What the records may take; fewer passes are kept where it is short",
      .unit = "bytes",
      .range = {1, 1e15, true},
      .unset = "any"},
     of<PathCache, &PathCache::max_bytes>(),
     kPathCache},
    {{.name = "monte_carlo.image_samples",
      .flag = "--spp",
      .level = kBasic,
      .sentence = kFreshSpp,
      .range = kImageSamples},
     of<MonteCarlo, &MonteCarlo::image_samples>(),
     kMonteCarlo},
    {{.name = "monte_carlo.image_window", .sentence = kImageWindow, .range = {0, 1 << 20, true}},
     of<MonteCarlo, &MonteCarlo::image_window>(),
     kMonteCarlo},
    {{.name = "monte_carlo.samples",
      .flag = "--gradient-spp",
      .sentence = kGradientSpp,
      .range = kSamples},
     of<MonteCarlo, &MonteCarlo::samples>(),
     kMonteCarlo},
    {{.name = "monte_carlo.adaptive_sampling", .sentence = kAdaptive},
     of<MonteCarlo, &MonteCarlo::adaptive_sampling>(),
     kMonteCarlo},
    {{.name = "reservoirs.image_samples",
      .flag = "--spp",
      .level = kBasic,
      .sentence = kFreshSpp,
      .range = kImageSamples},
     of<Reservoirs, &Reservoirs::image_samples>(),
     kReservoirs},
    {{.name = "reservoirs.image_window", .sentence = kImageWindow, .range = {0, 1 << 20, true}},
     of<Reservoirs, &Reservoirs::image_window>(),
     kReservoirs},
    {{.name = "reservoirs.samples",
      .flag = "--gradient-spp",
      .sentence = kGradientSpp,
      .range = kSamples},
     of<Reservoirs, &Reservoirs::samples>(),
     kReservoirs},
    {{.name = "reservoirs.adaptive_sampling", .sentence = kAdaptive},
     of<Reservoirs, &Reservoirs::adaptive_sampling>(),
     kReservoirs},
    {{.name = "reservoirs.target_function",
      .sentence = "Which signed number stands for the derivative when samples are resampled"},
     of<Reservoirs, &Reservoirs::target_function>(),
     kReservoirs},
    {{.name = "reservoirs.shift",
      .sentence = "How a sample of an earlier iteration becomes one of this iteration"},
     of<Reservoirs, &Reservoirs::shift>(),
     kReuse},
    {{.name = "reservoirs.merge", .sentence = "How history and fresh samples share their weight"},
     of<Reservoirs, &Reservoirs::merge>(),
     kReuse},
    {{.name = "reservoirs.confidence_cap",
      .sentence = "History counts at most this many candidates per pixel",
      .range = {0, 1e6, false, true}},
     of<Reservoirs, &Reservoirs::confidence_cap>(),
     kReuse},
    {{.name = "loss",
      .flag = "--loss",
      .sentence = "What is minimised; reweighted is relmse, but for pixels that are too bright"},
     of_options<&Options::loss>()},
    {{.name = "learning_rate",
      .sentence =
          "Step of the optimiser, divided by the number of unknowns of the material, those with "
          "a rate of their own included; auto: 0.005 from a searched start, 0.003 where known "
          "textures guide that search, else 0.01",
      .range = {kMinLearningRate, kMaxLearningRate, false, true},
      .unset = "auto"},
     of_options<&Options::learning_rate>(),
     kUnrated},
    {{.name = "adam.beta1", .sentence = "Decay of the mean of gradients", .range = kDecay},
     of_part<&Options::adam, &Adam::beta1>()},
    {{.name = "adam.beta2", .sentence = "Decay of the mean of squares", .range = kDecay},
     of_part<&Options::adam, &Adam::beta2>()},
    {{.name = "adam.gate",
      .sentence = "Steps are multiplied with a signal-to-noise gate, Wiener's factor; auto: with a "
                  "pyramid, of textures of more than one texel",
      .unset = "auto"},
     of_part<&Options::adam, &Adam::gate>(),
     kSplit},
    {{.name = "adam.initial_rate",
      .sentence = "Learning rate of the first ten steps, at most four times that of the others, to "
                  "which it falls; auto: 0.02 where adam.gate is on, or auto and estimator and "
                  "parameterisation have one, and the start is not searched, else 0",
      .range = {0, kMaxLearningRate},
      .unset = "auto"},
     of_part<&Options::adam, &Adam::initial_rate>()},
    {{.name = "parameterization",
      .sentence =
          "What the optimiser moves: a pyramid, whose neighbouring texels share evidence, or "
          "every texel on its own"},
     of_options<&Options::parameterization>()},
    {{.name = "pyramid.levels",
      .sentence = "Levels of the pyramid: a coarsest texel spans 2^(N-1) texels a side",
      .range = {1, 30, true}},
     of_part<&Options::pyramid, &Pyramid::levels>(),
     kPyramid},
    {{.name = "pyramid.weight_decay",
      .sentence = "Decay of all levels but the coarsest towards the initial value, in units of the "
                  "learning rate",
      .range = {0, 1000}},
     of_part<&Options::pyramid, &Pyramid::weight_decay>(),
     kLevels},
    {{.name = "unvisited",
      .sentence =
          "What becomes of texels that no sample visited: filled from their surroundings, or "
          "kept as the last search or the start has them; those of a start that is an image, or "
          "that known textures guided, are kept"},
     of_options<&Options::unvisited>(),
     kNoImageStart},
    {{.name = "search_again",
      .sentence =
          "Iterations from one search for better values of regions to the next, the first after a "
          "quarter; of searched textures beside no searched colour or constant; 0: none",
      .range = {0, kMaxCount, true}},
     of_options<&Options::search_again>(),
     kSearchedStart},
    {{.name = "search_effort",
      .sentence =
          "Samples of the search for the start, in units of those beside a run of a minute; "
          "auto: in proportion to the seconds of a longer run",
      .range = {1, kMaxSearchEffort},
      .unset = "auto"},
     of_options<&Options::search_effort>(),
     kSearchedStart},
    {{.name = "background_samples",
      .sentence =
          "Samples per pixel, over the iterations, of the part of the image that no unknown "
          "reaches",
      .range = kImageSamples},
     of_options<&Options::background_samples>()},
    {{.name = "batch",
      .sentence = "Views that an iteration visits, in a shuffled order",
      .range = {1, kMaxCount, true}},
     of_options<&Options::batch>(),
     kSeveralViews},
    {{.name = "seed",
      .flag = "--seed",
      .level = kBasic,
      .sentence = "Random numbers: same seed and iterations, same bytes",
      .range = {0, kMaxCount, true}},
     of_options<&Options::seed>()},
    {{.name = "stop.iterations",
      .flag = "--iterations",
      .level = kBasic,
      .sentence = "Ends after N iterations; without any rule after 200",
      .range = {1, 1e9, true},
      .unset = "none",
      .unset_value = kMaxCount},
     of_part<&Options::stop, &Stop::iterations>()},
    {{.name = "stop.seconds",
      .flag = "--time",
      .level = kBasic,
      .sentence = "Ends after so many seconds of iterations",
      .unit = "seconds",
      .range = {0, 1e9, false, true},
      .unset = "none",
      .unset_value = kNever},
     of_part<&Options::stop, &Stop::seconds>()},
    {{.name = "stop.patience",
      .flag = "--patience",
      .level = kBasic,
      .sentence =
          "Ends when N checks in a row, 20 iterations apart, find no lower loss in up to 16 views",
      .range = {1, 1e6, true},
      .unset = "none"},
     of_part<&Options::stop, &Stop::patience>()},
    {{.name = "evaluation_samples",
      .flag = "--evaluation-spp",
      .sentence =
          "Samples per pixel that evaluate the result, in two halves: an odd number loses one, 1 "
          "counts as 2; auto: a fifth of a pixel's visits, at least 4 million in all, at most 256",
      .range = {1, kMaxSamplesPerPixel, true},
      .unset = "auto"},
     of_options<&Options::evaluation_samples>()},
};

/// Calls body(T{}) with the type of the row's value.
template <class Body>
auto with_type(const OptionRow& row, const Body& body) {
    return std::visit(
        [&](auto field) {
            Options* none = nullptr;
            using T = std::remove_pointer_t<decltype(field(*none))>;
            return body(T{});
        },
        row.field);
}

[[noreturn]] void fail_for_estimator(const OptionRow& row, const Options& options) {
    throw InputError(std::string(row.info.name) + " needs " + row.condition.needs +
                     ", found the estimator " + name_of(options.estimator));
}

}  // namespace

std::span<const OptionRow> option_table() { return kTable; }

const OptionRow* find_option(const std::string& name) {
    for (const OptionRow& row : kTable)
        if (name == row.info.name) return &row;
    return nullptr;
}

bool is_held(const OptionRow& row, const Options& options) {
    Options copy = options;
    return std::visit([&](auto field) { return field(copy) != nullptr; }, row.field);
}

bool has_effect(const OptionRow& row, const Options& options) {
    return !row.condition.holds || row.condition.holds(options);
}

std::string get_option(const OptionRow& row, const Options& options) {
    Options copy = options;
    return std::visit(
        [&](auto field) {
            const auto* value = field(copy);
            if (!value) fail_for_estimator(row, options);
            return to_text(row.info, *value);
        },
        row.field);
}

void set_option(const OptionRow& row, const std::string& text, Options& options) {
    std::visit(
        [&](auto field) {
            auto* value = field(options);
            if (!value) fail_for_estimator(row, options);
            if (const std::string wrong = from_text(row.info, text, *value); !wrong.empty())
                throw InputError(std::string(row.info.name) + ": " + wrong);
        },
        row.field);
}

std::string placeholder(const OptionRow& row) {
    return with_type(row, [&](auto value) { return placeholder<decltype(value)>(row.info); });
}

std::string expected_text(const OptionRow& row) {
    return with_type(row, [&](auto value) { return expected_text<decltype(value)>(row.info); });
}

std::string complaint(const OptionRow& row, const std::string& text) {
    return with_type(row, [&](auto value) { return from_text(row.info, text, value); });
}

std::string default_text(const OptionRow& row) {
    Options options;
    for (const Choice<Estimator>& c : choices<Estimator>())
        if (!is_held(row, options)) options.estimator = c.value;
    return get_option(row, options);
}

bool is_number(const OptionRow& row) { return row.info.range.high > row.info.range.low; }

}  // namespace burnish
