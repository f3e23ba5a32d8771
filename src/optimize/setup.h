// A problem and its options, checked and resolved against the scene: what is constant for a run.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "burnish/solve.h"
#include "gradient/theta.h"
#include "render/renderer.h"
#include "texture/charts.h"
#include "texture/pyramid.h"

namespace burnish {

enum class StartKind {
    kSearched,  ///< UnknownTexture::start is 0.5 until the search, or a state, has set it
    kConstant,
    kGiven,  ///< an image
};

/// An unknown and how it moves.
struct UnknownTexture {
    TextureId texture;
    StartKind start_kind = StartKind::kConstant;
    bool is_guided = false;  ///< known textures guide the search
    Image start;             ///< [height, width, channels] of the bitmap
    ChartMap charts;         ///< of its texels
    AdamOptions adam;        ///< of all levels
    PyramidMaps maps;
};

struct Setup {
    Problem problem;
    Options options = {};
    std::vector<Renderer> views = {};      ///< parallel to Problem::views
    std::vector<std::size_t> fitted = {};  ///< indices of the views that are fitted
    /// The rank that each view is rendered by; of those that share its bands the first.
    std::vector<int> owners = {};
    std::vector<UnknownTexture> unknowns = {};
    float max_mask = 1;  ///< of what is searched: see SearchView
};

inline const Scene& scene_of(const Setup& setup) { return setup.problem.renderer.data().scene(); }

/// As a view sees it.
inline const TracedScene& scene_of(const Setup& setup, std::size_t view) {
    return setup.views[view].data().traced;
}

/// Whether the processes, being more than the fitted views, render each picture of an evaluation
/// together.
inline bool renders_together(const Setup& setup) {
    return static_cast<std::size_t>(setup.problem.ranks.count) > setup.fitted.size();
}

/// Whether the view is evaluated by this process.
inline bool is_mine(const Setup& setup, std::size_t view) {
    return renders_together(setup) || setup.owners[view] == setup.problem.ranks.rank;
}

/// The place of a view in Setup::fitted; none: it is not fitted.
std::optional<std::size_t> which_fitted(const Setup& setup, std::size_t view);

/// Throws InputError where options are out of range or sizes do not fit; the message says what to
/// change.
Setup make_setup(Problem problem, Options options);

/// Whether steps of textures are multiplied with the signal-to-noise gate: see Adam::gate. Where
/// that is not set, those of a single texel are not.
bool uses_gate(const Options& options);

/// Options::stop, with 200 iterations where it has no rule.
Stop effective_stop(const Options& options);

/// The unknowns at their start.
Theta initial_theta(const Setup& setup);

/// The learning rate of an unknown: its own, or, where that is 0, that of the options, shared out
/// among the unknowns that one BSDF reads. Together they move the picture about as far as one of
/// them alone.
float learning_rate_of(const Scene& scene, std::span<const TextureId> unknowns, TextureId texture,
                       StartKind start, const Options& options, double own);

}  // namespace burnish
