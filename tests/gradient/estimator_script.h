// What happens to the estimators from outside, whatever their estimates are: textures, and an
// adjoint whose sign and size change, over six iterations. In a closed loop the samples would move
// the textures, and hide a bias.
#pragma once

#include "core/parallel.h"
#include "gradient/gradient_runs.h"
#include "gradient/small_scene.h"
#include "ledger_entries.h"

namespace burnish::test {

inline constexpr int kScriptIterations = 6;
inline constexpr std::array<float, kScriptIterations> kAdjointScale{1.0f,  -0.7f, 1.4f,
                                                                    -0.5f, -1.2f, 0.8f};

struct Script {
    Scene scene;
    std::vector<Theta> theta;    ///< one per iteration
    std::vector<Image> adjoint;  ///< one per iteration; the sign flips and the size changes
    Direction direction = {};
    LightSelection lights = LightSelection::kUniform;
};

inline ScriptSpans spans_of(const Script& script) { return {script.theta, script.adjoint}; }

/// `count` runs along the script; seeds: the first of theirs.
inline Runs runs_along(const Script& script, const Estimator& estimator, std::size_t count,
                       std::uint32_t seeds, const Tamper& tamper = {}) {
    const TracedScene traced = prepare(script.scene, script.lights);
    Runs runs(count);
    parallel_for(runs.size(), [&](std::size_t run) {
        runs[run] = run_along(traced, spans_of(script), estimator,
                              seeds + static_cast<std::uint32_t>(run), tamper);
    });
    return runs;
}

/// mixed: see make_adjoint.
inline Script make_script(const Scene& scene, bool mixed) {
    Script script;
    script.scene = scene;
    const Image base = make_adjoint(script.scene, 81, mixed);
    const Image drift = make_adjoint(script.scene, 82, mixed);
    RandomSource random{83};
    for (std::size_t v = 0; v < kScriptIterations; ++v) {
        Theta theta = theta_of(script.scene);
        for (ThetaTexture& t : theta.textures)
            for (std::size_t i = 0; i < t.values.values.size(); i += t.values.channels) {
                const float move = random.next(-0.06f, 0.06f);
                for (int c = 0; c < t.values.channels; ++c)
                    t.values.values[i + static_cast<std::size_t>(c)] += move;
            }
        script.theta.push_back(theta);
        Image adjoint = base;
        for (std::size_t i = 0; i < adjoint.values.size(); ++i)
            adjoint.values[i] = kAdjointScale[v] *
                                (base.values[i] + 0.1f * static_cast<float>(v) * drift.values[i]);
        script.adjoint.push_back(adjoint);
    }
    script.direction = direction_of(runs_along(script, mc(64), 4, 84000));
    return script;
}

inline Script make_script(bool gray) {
    SmallSceneOptions options;
    options.gray = gray;
    if (!gray) options.filter = FilterKind::kMitchell;
    return make_script(make_small_scene(options), !gray);
}

/// 800 runs along the script; of a defect, which needs fewer to be seen, 200.
inline Estimates follow(const LedgerEntry& entry, const Script& script, const Estimator& estimator,
                        const Tamper& tamper = {}) {
    const std::size_t runs = scaled(entry, std::size_t{tamper ? 200u : 800u});
    return sum_runs(runs_along(script, estimator, runs, seed_of(entry), tamper), script.direction);
}

/// The baseline with 16 samples per pixel in each of 320 runs: enough to know the skewness.
inline Estimates follow_baseline(const LedgerEntry& entry, const Script& script) {
    return sum_runs(
        runs_along(script, mc(16), scaled(entry, std::size_t{320}), seed_of(entry, 89000)),
        script.direction);
}

}  // namespace burnish::test
