// What tracing reads: the scene, how its textures look, and which samples.
#pragma once

#include <span>

#include "paths/bsdf_columns.h"
#include "paths/path.h"
#include "paths/traced_scene.h"
#include "shading/texture.h"

namespace burnish {

/// Which surfaces go on to make samples of light; the others stop at the primary hit.
enum class SurfaceChoice {
    kAll,
    kUnknown,   ///< those whose BSDF, or its share of a blend, reads an optimised texture
    kConstant,  ///< the others
};

/// Values of TraceInput::unknown_bsdfs.
inline constexpr char kNoUnknown = 0, kUnknownInput = 1,
                      kUnknownShareAlone = 2;  ///< its own inputs are constant

struct TraceInput {
    const TracedScene* scene = nullptr;
    const TextureTable* textures = nullptr;  ///< what the BSDFs are sampled under
    RandomKey key = {};
    std::uint32_t passes_per_iteration = 1;  ///< not read in iteration 0
    SurfaceChoice choice = SurfaceChoice::kAll;
    /// Of Scene::bsdfs: what of each is an optimised texture.
    std::span<const char> unknown_bsdfs = {};
    /// Keep the samples on optimised textures whose value is zero: their derivative may not be.
    bool keep_black = false;
    /// Of the numbers of a pixel's samples from pass to pass, counted as film_pass does.
    Sequence sequence = Sequence::kIndependent;
    /// The mixture, in equal parts, whose density BSDF samples follow, at most kMaxComponents;
    /// empty: the density under `textures` alone. Records of a mixture can be shaded under any of
    /// its components, and between them, with little noise. The values of samples are those under
    /// the first component.
    std::span<const ConstantTextures> mixture = {};
    /// The unknown that each texture of the scene is, -1: none. Empty: no weight of a blend is one.
    std::span<const int> slots = {};
};
inline constexpr std::size_t kMaxComponents = 8;

/// A camera sample and the techniques to sample.
struct BatchSample {
    CameraSample camera;
    bool emitter = true, bsdf = true;
};

}  // namespace burnish
