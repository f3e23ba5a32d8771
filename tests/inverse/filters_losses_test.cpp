// Every estimator with history and without agrees with the baseline under every reconstruction
// filter and every loss. The adjoint is that of the loss between an image and a target that lies
// above it in some pixels and below it in others, and the other way round one iteration later.
//
// An ordinary run takes two of the six estimators for each filter and loss, chosen so that every
// estimator meets every filter and every loss; a thorough run takes all.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "burnish/core/parallel.h"
#include "burnish/inverse/loss.h"
#include "burnish/render/render.h"
#include "inverse/gradient_runs.h"
#include "inverse/small_scene.h"
#include "ledger_entries.h"

namespace burnish {
namespace {

using namespace test::ledger;
using test::accepted;
using test::Estimates;
using test::numbers_of;
using test::rejected;
using test::Runs;
using test::scaled;
using test::seed_of;

constexpr std::size_t kIterations = 3;

struct NamedFilter {
    const char* name;
    ReconstructionFilter filter;
};
const NamedFilter kFilters[] = {
    {"box", {FilterKind::kBox, 0.5f}},
    {"tent", {FilterKind::kTent, 1.0f}},
    {"gaussian", {FilterKind::kGaussian, 2.0f}},
    {"mitchell", {FilterKind::kMitchell, 2.0f}},
    {"catmullrom", {FilterKind::kCatmullRom, 2.0f}},
    {"lanczos", {FilterKind::kLanczos, 3.0f}},
};
struct NamedLoss {
    const char* name;
    Loss loss;
};
const NamedLoss kLosses[] = {{"relmse", Loss::kRelMse}, {"l2", Loss::kL2}, {"l1", Loss::kL1}};

struct NamedEstimator {
    Estimator estimator;
    Shift shift;
    MergeRule merge;
};
constexpr NamedEstimator kEstimatorsWithShift[] = {
    {Estimator::kRis, Shift::kIdentity, MergeRule::kBalance},
    {Estimator::kPris, Shift::kIdentity, MergeRule::kBalance},
    {Estimator::kGris, Shift::kReplay, MergeRule::kBalance},
    {Estimator::kGris, Shift::kIdentity, MergeRule::kDefensive},
    {Estimator::kPgris, Shift::kReplay, MergeRule::kDefensive},
    {Estimator::kPgris, Shift::kIdentity, MergeRule::kBalance},
};

/// What happens from outside, whatever the estimates are.
struct Script {
    Scene scene;
    std::vector<Theta> theta;
    std::vector<Image> adjoint;
};

Theta moved(const Theta& theta, test::RandomSource& random) {
    Theta result = theta;
    for (ThetaTexture& t : result.textures)
        for (float& v : t.values.values) v += random.next(-0.06f, 0.06f);
    return result;
}

Script make_script(const ReconstructionFilter& filter, Loss loss) {
    Script script;
    script.scene = test::make_small_scene();
    script.scene.film.filter = filter;
    const TracedScene traced = prepare(script.scene);
    test::RandomSource random{41};
    std::vector<float> above(16 * 16);
    for (float& a : above) a = random.next(-0.5f, 0.5f);
    for (std::uint32_t v = 0; v < kIterations; ++v) {
        script.theta.push_back(moved(test::theta_of(script.scene), random));
        const TextureTable textures = texture_table(script.scene, script.theta[v]);
        const TraceInput input{&traced, &textures,           {42, Stream::kImage},
                               16,      SurfaceChoice::kAll, {}};
        const Image image = render(input, v, 0, 16);
        Image target = image;
        for (std::size_t i = 0; i < target.values.size(); ++i)
            target.values[i] *= 1 + (v % 2 == 0 ? above[i / 3] : -above[i / 3]);
        script.adjoint.push_back(evaluate_loss(loss, image, target, {}).adjoint);
    }
    return script;
}

/// Tampers with the history before an iteration reads it.
using Tamper = void (*)(History& history, const Film& film);
void leave_alone(History&, const Film&) {}

/// Runs along the script, each with a seed of its own.
Estimates follow(const Script& script, const GradientOptions& options, std::size_t count,
                 std::uint32_t first_seed, Tamper tamper = leave_alone) {
    const TracedScene traced = prepare(script.scene);
    Runs runs(count);
    parallel_for(count, [&](std::size_t run) {
        GradientOptions own = options;
        own.seed = seed_of(kFiltersAndLosses, first_seed + static_cast<std::uint32_t>(run));
        History history;
        for (std::uint32_t v = 0; v < kIterations; ++v) {
            tamper(history, script.scene.film);
            GradientResult result = estimate_gradient(traced, script.theta[v], script.adjoint[v], v,
                                                      own, std::move(history));
            history = std::move(result.history);
            runs[run].push_back(numbers_of(script.theta[v], result.gradient));
        }
    });
    return test::sum_runs(runs);
}

Estimates baseline(const Script& script) {
    GradientOptions options;
    options.estimator = Estimator::kMc;
    options.samples_per_pixel = 48;
    return follow(script, options, scaled(kFiltersAndLosses, std::size_t{40}), 50000);
}

double p_value(const Script& script, const Estimates& expected, const NamedEstimator& which,
               Tamper tamper = leave_alone) {
    GradientOptions options;
    options.estimator = which.estimator;
    options.shift = which.shift;
    options.merge = which.merge;
    options.target = Target::kIntegrand;
    options.confidence_cap = 4;
    return test::agreement_p_value(
        follow(script, options, scaled(kFiltersAndLosses, std::size_t{400}), 0, tamper), expected);
}

TEST(FiltersAndLosses, EveryEstimatorAgreesWithTheBaseline) {
    for (std::size_t f = 0; f < std::size(kFilters); ++f)
        for (std::size_t l = 0; l < std::size(kLosses); ++l) {
            const Script script = make_script(kFilters[f].filter, kLosses[l].loss);
            const Estimates expected = baseline(script);
            std::vector<double> p;
            for (std::size_t e = 0; e < std::size(kEstimatorsWithShift); ++e)
                if (test::is_thorough() || (e + f + 2 * l) % 6 < 2)
                    p.push_back(p_value(script, expected, kEstimatorsWithShift[e]));
            EXPECT_TRUE(accepted(kFiltersAndLosses,
                                 fmt::format("{}, {}", kFilters[f].name, kLosses[l].name),
                                 test::holm_minimum(p)));
        }
}

/// The adjoint under which q_{v-1} is evaluated, as if the filter had not been normalised.
void forget_normalisation(History& history, const Film& film) {
    const FilmNormalization n = film_normalization(film);
    Image& adjoint = history.normalized_adjoint;
    for (int y = 0; y < adjoint.height; ++y)
        for (int x = 0; x < adjoint.width; ++x)
            for (int c = 0; c < 3; ++c)
                adjoint.at(x, y, c) /=
                    n.x[static_cast<std::size_t>(x)] * n.y[static_cast<std::size_t>(y)];
}

TEST(FiltersAndLosses, HistoryUnderAnotherNormalisationIsRejected) {
    const Script script = make_script({FilterKind::kGaussian, 2.0f}, Loss::kRelMse);
    EXPECT_TRUE(
        rejected(kFiltersAndLosses, "q of the history without the filter's normalisation",
                 p_value(script, baseline(script), kEstimatorsWithShift[5], forget_normalisation)));
}

}  // namespace
}  // namespace burnish
