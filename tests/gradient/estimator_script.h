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
};

inline Script make_script(bool gray) {
    Script script;
    SmallSceneOptions options;
    options.gray = gray;
    if (!gray) options.filter = FilterKind::kMitchell;
    script.scene = make_small_scene(options);
    const Image base = make_adjoint(script.scene, 81, !gray);
    const Image drift = make_adjoint(script.scene, 82, !gray);
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
    return script;
}

inline ScriptSpans spans_of(const Script& script) { return {script.theta, script.adjoint}; }

/// 800 runs along the script.
inline Estimates follow(const LedgerEntry& entry, const Script& script, const Estimator& estimator,
                        const Tamper& tamper = leave_alone) {
    const TracedScene traced = prepare(script.scene);
    Runs runs(scaled(entry, std::size_t{800}));
    parallel_for(runs.size(), [&](std::size_t run) {
        runs[run] = run_along(traced, spans_of(script), estimator,
                              seed_of(entry, static_cast<std::uint32_t>(run)), tamper);
    });
    return sum_runs(runs);
}

/// The baseline with 64 samples per pixel in each of 80 runs.
inline Estimates follow_baseline(const LedgerEntry& entry, const Script& script) {
    const TracedScene traced = prepare(script.scene);
    Runs runs(scaled(entry, std::size_t{80}));
    parallel_for(runs.size(), [&](std::size_t run) {
        runs[run] = run_along(traced, spans_of(script), mc(64),
                              seed_of(entry, 89000 + static_cast<std::uint32_t>(run)));
    });
    return sum_runs(runs);
}

}  // namespace burnish::test
