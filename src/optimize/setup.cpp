#include "optimize/setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "burnish/error.h"
#include "core/require.h"
#include "gradient/estimator.h"
#include "image/image.h"
#include "image/whole.h"
#include "optimize/option_table.h"
#include "optimize/ranks.h"
#include "optimize/search_guide.h"
#include "optimize/search_plan.h"
#include "optimize/views.h"
#include "render/renderer.h"

namespace burnish {

namespace {

/// Each is in the range that the table of options gives it.
void check_options(const Options& o) {
    for (const OptionRow& row : option_table()) {
        if (!is_held(row, o)) continue;
        const std::string wrong = complaint(row, get_option(row, o));
        require(wrong.empty(), fmt::format("{}: {}", row.info.name, wrong));
    }
}

void check_rate(const Unknown& u) {
    const double rate = u.learning_rate;
    require(rate == 0 || (rate > kMinLearningRate && rate <= kMaxLearningRate),
            fmt::format("the learning rate of {} is {:g}, expected one above {:g}, at most {:g}",
                        u.name, rate, kMinLearningRate, kMaxLearningRate));
}

StartKind kind_of_start(const Problem& problem, const Unknown& unknown) {
    if (std::holds_alternative<Image>(unknown.start)) return StartKind::kGiven;
    const bool searched = std::holds_alternative<SearchStart>(unknown.start) && !problem.loss;
    return searched ? StartKind::kSearched : StartKind::kConstant;
}

/// The texels that an unknown starts from, or 0.5 where they are searched; an image is taken out of
/// it.
Image take_start(Unknown& unknown, const Bitmap& bitmap) {
    if (std::holds_alternative<SearchStart>(unknown.start))
        return make_image(bitmap.width, bitmap.height, bitmap.channels, 0.5f);
    const auto in_range = [](float v) { return v >= 0 && v <= 1; };
    if (const float* value = std::get_if<float>(&unknown.start)) {
        require(in_range(*value),
                fmt::format("the start of {} is {:g}, expected a value from 0 to 1", unknown.name,
                            *value));
        return make_image(bitmap.width, bitmap.height, bitmap.channels, *value);
    }
    Image image = std::move(std::get<Image>(unknown.start));
    const std::string what = "the start of " + unknown.name;
    require(image.width == bitmap.width && image.height == bitmap.height &&
                (image.channels == 1 || image.channels == 3),
            what + " has " + size_text(image.width, image.height) +
                " texels: expected the texture's " + size_text(bitmap.width, bitmap.height));
    require_whole(image, what);
    require(std::all_of(image.values.begin(), image.values.end(), in_range),
            what + " holds values outside of [0, 1]");
    return with_channels(std::move(image), bitmap.channels);
}

/// Without the learning rate. Where a start has details that pictures do not resolve, only what
/// moves the pictures leaves it.
AdamOptions adam_of(const Options& o, const Bitmap& bitmap, StartKind start, bool is_guided) {
    constexpr float kGatedInitialRate = 0.02f, kDamping = 0.03f, kGuidedDamping = 0.3f;
    AdamOptions adam;
    adam.beta1 = o.adam.beta1, adam.beta2 = o.adam.beta2;
    // All pixels tell one texel: nothing of its gradient is noise that the gate would keep out, and
    // that of the first iterations would hold it for hundreds of others.
    adam.gate = uses_gate(o) && (o.adam.gate || bitmap.width > 1 || bitmap.height > 1);
    adam.initial_rate = o.adam.initial_rate.value_or(
        uses_gate(o) && start != StartKind::kSearched ? kGatedInitialRate : 0.0f);
    if (has_pyramid(o))
        adam.weight_decay = o.pyramid.weight_decay,
        adam.damping = is_guided ? kGuidedDamping : kDamping;
    return adam;
}

/// Whether known textures guide the search for the start.
bool is_guided(const Scene& scene, std::span<const TextureId> unknowns, TextureId texture,
               StartKind start) {
    return start == StartKind::kSearched && !guides_of(scene, texture, unknowns).empty();
}

/// Of an unknown alone: the nearer its start, the slower.
double default_rate(const Scene& scene, std::span<const TextureId> unknowns, TextureId texture,
                    StartKind start) {
    if (start != StartKind::kSearched) return 0.01;
    return is_guided(scene, unknowns, texture, start) ? 0.003 : 0.005;
}

PyramidMaps maps_of(const Scene& scene, const Options& o, TextureId texture,
                    const ChartMap& charts) {
    const auto& bitmap = std::get<Bitmap>(scene[texture]);
    if (!has_pyramid(o)) return make_maps(1, bitmap.width, bitmap.height, {}, false);
    return make_maps(o.pyramid.levels, bitmap.width, bitmap.height, charts,
                     bitmap.wrap == TextureWrap::kRepeat);
}

/// Of what a run searches.
float max_mask_of(const Setup& setup) {
    std::vector<TextureId> unknowns;
    for (const UnknownTexture& u : setup.unknowns)
        if (u.start_kind == StartKind::kSearched) unknowns.push_back(u.texture);
    std::vector<SearchView> views;
    for (const std::size_t i : searched_views(setup.fitted.size())) {
        const View& v = setup.problem.views[setup.fitted[i]];
        views.push_back({scene_of(setup, setup.fitted[i]), v.image, v.mask});
    }
    return max_mask(views, unknowns);
}

}  // namespace

std::optional<std::size_t> which_fitted(const Setup& setup, std::size_t view) {
    const auto at = std::find(setup.fitted.begin(), setup.fitted.end(), view);
    if (at == setup.fitted.end()) return {};
    return static_cast<std::size_t>(at - setup.fitted.begin());
}

bool uses_gate(const Options& o) {
    return o.adam.gate.value_or(has_pyramid(o)) && has_split_gradient(o.estimator);
}

Stop effective_stop(const Options& options) {
    constexpr std::uint32_t kDefaultIterations = 200;
    Stop stop = options.stop;
    if (stop == Stop{}) stop.iterations = kDefaultIterations;
    return stop;
}

float learning_rate_of(const Scene& scene, std::span<const TextureId> unknowns, TextureId texture,
                       StartKind start, const Options& options, double own) {
    if (own > 0) return static_cast<float>(own);
    const double rate = options.learning_rate ? *options.learning_rate
                                              : default_rate(scene, unknowns, texture, start);
    const double share =
        static_cast<double>(std::max<std::size_t>(1, read_together(scene, unknowns, texture)));
    return static_cast<float>(rate / share);
}

Setup make_setup(Problem problem, Options options) {
    check_options(options);
    require(!problem.unknowns.empty(), "the problem has no unknown: expected at least one");
    check(problem.ranks);
    Setup setup{std::move(problem), std::move(options)};
    setup.problem.ranks = stoppable(std::move(setup.problem.ranks));
    setup.views = make_views(setup.problem);
    check_pictures(setup.problem, setup.views);
    setup.fitted = fitted_views(setup.problem);
    setup.owners = owners_of_views(setup.problem, setup.options.batch);
    const Scene& scene = scene_of(setup);
    std::vector<std::string> names;
    for (const Unknown& u : setup.problem.unknowns) names.push_back(u.name);
    const std::vector<TextureId> ids = find_textures(scene, names);
    for (std::size_t i = 0; i < ids.size(); ++i) check_unknown(scene, names[i], ids[i]);
    for (std::size_t i = 0; i < ids.size(); ++i) {
        Unknown& u = setup.problem.unknowns[i];
        check_rate(u);
        const StartKind start = kind_of_start(setup.problem, u);
        const bool guided = is_guided(scene, ids, ids[i], start);
        const auto& bitmap = std::get<Bitmap>(scene[ids[i]]);
        AdamOptions adam = adam_of(setup.options, bitmap, start, guided);
        adam.learning_rate =
            learning_rate_of(scene, ids, ids[i], start, setup.options, u.learning_rate);
        ChartMap charts = texture_charts(scene, ids[i]);
        PyramidMaps maps = maps_of(scene, setup.options, ids[i], charts);
        setup.unknowns.push_back({ids[i], start, guided, take_start(u, bitmap), std::move(charts),
                                  adam, std::move(maps)});
    }
    setup.max_mask = max_mask_of(setup);
    return setup;
}

Theta initial_theta(const Setup& setup) {
    Theta theta;
    for (const UnknownTexture& u : setup.unknowns) theta.textures.push_back({u.texture, u.start});
    return theta;
}

}  // namespace burnish
