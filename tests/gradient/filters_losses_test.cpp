// Every estimator, shift and target agrees with the baseline under every reconstruction filter and
// every loss. The adjoint is that of the loss between an image and a target that lies above it in
// some pixels and below it in others, and the other way round one iteration later.
//
// A thorough run takes the full product. An ordinary run takes a Latin square of it: method e and
// filter f meet under loss k mod 3 and target k / 3, where k = (e + f) mod 6, so that every value
// of every factor meets every value of every other.
//
// The target `luminance` has a scene of its own, gray and under gray light, and a loss whose
// weights differ between channels alone: then w(x) has one sign in all channels, whatever the
// filter adds up, and g / q is bounded.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>

#include "core/parallel.h"
#include "gradient/gradient_runs.h"
#include "gradient/small_scene.h"
#include "ledger_entries.h"
#include "optimize/loss.h"
#include "optimize/option_value.h"
#include "render/render.h"

namespace burnish {
namespace {

using namespace test::ledger;
using test::accepted;
using test::Estimates;
using test::rejected;
using test::Runs;
using test::scaled;
using test::seed_of;
using test::Tamper;

constexpr std::size_t kCellIterations = 3;

constexpr std::size_t kFilterCount = 6, kLossCount = 3, kTargetCount = 2, kMethodCount = 6;

struct NamedFilter {
    const char* name;
    ReconstructionFilter filter;
};
const NamedFilter kFilters[kFilterCount] = {
    {"box", {FilterKind::kBox, 0.5f}},
    {"tent", {FilterKind::kTent, 1.0f}},
    {"gaussian", {FilterKind::kGaussian, 2.0f}},
    {"mitchell", {FilterKind::kMitchell, 2.0f}},
    {"catmullrom", {FilterKind::kCatmullRom, 2.0f}},
    {"lanczos", {FilterKind::kLanczos, 3.0f}},
};
struct NamedTarget {
    const char* name;
    TargetFunction target;
};
const NamedTarget kTargets[kTargetCount] = {{"integrand", TargetFunction::kIntegrand},
                                            {"luminance", TargetFunction::kLuminance}};

Reservoirs with(Reservoirs options, Shift shift) {
    options.shift = shift;
    return options;
}
const Reservoirs kMethods[kMethodCount] = {
    test::ris(),
    test::pris(),
    with(test::gris(), Shift::kReplay),
    with(test::gris(), Shift::kIdentity),
    with(test::pgris(), Shift::kReplay),
    with(test::pgris(), Shift::kIdentity),
};

/// Indices into the tables above, and the merge rule.
struct Cell {
    std::size_t method, filter, loss, target;
    /// Balance and defensive in turn, so that each meets every value of every factor.
    MergeRule merge() const {
        return (method + filter / 3) % 2 == 0 ? MergeRule::kBalance : MergeRule::kDefensive;
    }
    bool in_latin_square() const { return (method + filter) % 6 == loss + kLossCount * target; }
};

std::vector<Cell> all_cells() {
    std::vector<Cell> cells;
    for (std::size_t f = 0; f < kFilterCount; ++f)
        for (std::size_t t = 0; t < kTargetCount; ++t)
            for (std::size_t l = 0; l < kLossCount; ++l)
                for (std::size_t e = 0; e < kMethodCount; ++e) cells.push_back({e, f, l, t});
    return cells;
}

/// What happens from outside, whatever the estimates are.
struct CellScript {
    Scene scene;
    std::vector<Theta> theta;
    std::vector<Image> adjoint;
    test::Direction direction = {};
};

/// Runs along the script, one for each seed from `seeds` on.
Runs runs_along(const CellScript& script, const Estimator& estimator, std::size_t count,
                std::uint32_t seeds, const Tamper& tamper = {}) {
    const TracedScene traced = prepare(script.scene);
    Runs runs(count);
    parallel_for(count, [&](std::size_t run) {
        runs[run] = test::run_along(traced, {script.theta, script.adjoint}, estimator,
                                    seeds + static_cast<std::uint32_t>(run), tamper);
    });
    return runs;
}

/// Texels move, all channels alike where `gray`.
Theta moved(const Theta& theta, bool gray, test::RandomSource& random) {
    Theta result = theta;
    for (ThetaTexture& t : result.textures) {
        float move = 0;
        for (std::size_t i = 0; i < t.values.values.size(); ++i) {
            if (!gray || i % static_cast<std::size_t>(t.values.channels) == 0)
                move = random.next(-0.06f, 0.06f);
            t.values.values[i] += move;
        }
    }
    return result;
}

/// Weights of the channels; all ones where empty.
Image weights_of(TargetFunction target) {
    if (target != TargetFunction::kLuminance) return {};
    Image weights = make_image(16, 16, 3);
    for (std::size_t i = 0; i < weights.values.size(); ++i)
        weights.values[i] = 0.6f + 0.3f * static_cast<float>(i % 3);
    return weights;
}

Scene scene_of(TargetFunction target) {
    const bool gray = target == TargetFunction::kLuminance;
    Scene scene = test::make_small_scene({.gray = gray});
    if (gray)
        scene.emitters = {AreaEmitter{{5, 5, 5}, {1}}, AreaEmitter{{6, 6, 6}, {2}},
                          ConstantEmitter{{0.3f, 0.3f, 0.3f}}};
    return scene;
}

CellScript make_script(const ReconstructionFilter& filter, Loss loss,
                       TargetFunction target_function) {
    CellScript script;
    script.scene = scene_of(target_function);
    script.scene.film.filter = filter;
    const TracedScene traced = prepare(script.scene);
    test::RandomSource random{41};
    std::vector<float> above(16 * 16);
    for (float& a : above) a = random.next(-0.5f, 0.5f);
    for (std::uint32_t v = 0; v < kCellIterations; ++v) {
        script.theta.push_back(moved(test::theta_of(script.scene),
                                     target_function == TargetFunction::kLuminance, random));
        const TextureTable textures = texture_table(script.scene, script.theta[v]);
        const TraceInput input{&traced, &textures,           {42, Stream::kImage},
                               16,      SurfaceChoice::kAll, {}};
        const Image image = render(input, v, 16);
        Image target = image;
        for (std::size_t i = 0; i < target.values.size(); ++i)
            target.values[i] *= 1 + (v % 2 == 0 ? above[i / 3] : -above[i / 3]);
        script.adjoint.push_back(
            evaluate_loss(loss, image, target, weights_of(target_function)).adjoint);
    }
    script.direction = test::direction_of(runs_along(script, test::mc(32), 4, 84000));
    return script;
}

/// Runs along the script, each with a seed of its own.
Estimates follow(const CellScript& script, const Estimator& estimator, std::size_t count,
                 std::uint32_t first_seed, const Tamper& tamper = {}) {
    return test::sum_runs(runs_along(script, estimator, scaled(kFiltersAndLosses, count),
                                     seed_of(kFiltersAndLosses, first_seed), tamper),
                          script.direction);
}

/// Enough runs to know the skewness.
Estimates baseline(const CellScript& script) { return follow(script, test::mc(8), 240, 50000); }

double p_value(const CellScript& script, const Estimates& expected, const Cell& cell,
               const Tamper& tamper = {}) {
    Reservoirs options = kMethods[cell.method];
    options.merge = cell.merge();
    options.target_function = kTargets[cell.target].target;
    options.confidence_cap = 4;
    return test::agreement_p_value(follow(script, options, 400, 0, tamper), expected);
}

CellScript script_of(const Cell& cell) {
    return make_script(kFilters[cell.filter].filter, choices<Loss>()[cell.loss].value,
                       kTargets[cell.target].target);
}

/// Indices, and the merge rule where there is history to merge.
std::array<std::size_t, 5> row_of(const Cell& c) {
    const bool merges = kMethods[c.method].reuse;
    return {c.method, c.filter, c.loss, c.target,
            merges ? static_cast<std::size_t>(c.merge()) : std::size_t{2}};
}

TEST(FiltersAndLossesDesign, LatinSquareCoversEveryPair) {
    std::set<std::array<std::size_t, 4>> of_all, of_square;  // factor, value, factor, value
    for (const Cell& cell : all_cells()) {
        const auto row = row_of(cell);
        for (std::size_t a = 0; a < row.size(); ++a)
            for (std::size_t b = 0; b < a; ++b) {
                of_all.insert({a, row[a], b, row[b]});
                if (cell.in_latin_square()) of_square.insert({a, row[a], b, row[b]});
            }
    }
    EXPECT_EQ(of_square, of_all);
    EXPECT_EQ(choices<Loss>().size(), kLossCount + 1) << "another loss needs a square of its own";
    EXPECT_EQ(choices<Loss>().back().value, Loss::kReweighted) << "relMSE with other weights";
    EXPECT_EQ(choices<TargetFunction>().size(), kTargetCount);
}

/// The index of a filter.
class FiltersAndLosses : public testing::TestWithParam<std::size_t> {};

TEST_P(FiltersAndLosses, EveryEstimatorAgreesWithTheBaseline) {
    for (std::size_t target = 0; target < kTargetCount; ++target)
        for (std::size_t loss = 0; loss < kLossCount; ++loss) {
            const CellScript script = script_of({0, GetParam(), loss, target});
            const Estimates expected = baseline(script);
            std::vector<double> p;
            for (std::size_t method = 0; method < kMethodCount; ++method) {
                const Cell cell{method, GetParam(), loss, target};
                if (test::is_thorough() || cell.in_latin_square())
                    p.push_back(p_value(script, expected, cell));
            }
            EXPECT_TRUE(accepted(kFiltersAndLosses,
                                 fmt::format("{}, {}, {}", kFilters[GetParam()].name,
                                             choices<Loss>()[loss].name, kTargets[target].name),
                                 test::holm_minimum(p)));
        }
}

INSTANTIATE_TEST_SUITE_P(Filters, FiltersAndLosses, testing::Range(std::size_t{0}, kFilterCount),
                         [](const auto& test) { return std::string(kFilters[test.param].name); });

/// The adjoint under which q_{v-1} is evaluated, as if the filter had not been normalised.
void forget_normalisation(const Film& film, Image& adjoint) {
    const FilmNormalization n = film_normalization(film);
    for (int y = 0; y < adjoint.height; ++y)
        for (int x = 0; x < adjoint.width; ++x)
            for (int c = 0; c < 3; ++c)
                adjoint.at(x, y, c) /=
                    n.x[static_cast<std::size_t>(x)] * n.y[static_cast<std::size_t>(y)];
}

TEST(FiltersAndLossesDefect, HistoryUnderAnotherNormalisationIsRejected) {
    for (std::size_t target = 0; target < kTargetCount; ++target) {
        const Cell cell{4, 2, 0, target};
        const CellScript script = script_of(cell);
        const auto forget = [&](ReservoirsState& state, std::size_t) {
            forget_normalisation(script.scene.film, state.history.normalized_adjoint);
        };
        EXPECT_TRUE(rejected(kFiltersAndLosses,
                             "q of the history without the filter's normalisation",
                             p_value(script, baseline(script), cell, forget)))
            << kTargets[target].name;
    }
}

}  // namespace
}  // namespace burnish
