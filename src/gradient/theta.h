// The textures that are recovered: theta. What the optimiser moves is kept apart from what the
// BSDFs read.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "image/image.h"
#include "scene/scene.h"
#include "shading/texture.h"

namespace burnish {

/// One texture: linear values as the BSDF sees them, [height, width, channels].
struct ThetaTexture {
    TextureId texture;
    Image values;

    friend bool operator==(const ThetaTexture&, const ThetaTexture&) = default;
};

struct Theta {
    std::vector<ThetaTexture> textures;       ///< the unknowns
    std::vector<ThetaTexture> replaced = {};  ///< known, but with other values than the scene's

    friend bool operator==(const Theta&, const Theta&) = default;
};

/// The scene's textures with the unknowns and replaced ones in their place. Views only: scene and
/// theta must outlive it.
TextureTable texture_table(const Scene& scene, const Theta& theta);

/// TraceInput::unknown_bsdfs: for each BSDF of the scene what of it is an unknown of theta. slots:
/// as of theta_slots.
std::vector<char> unknown_bsdfs(const Scene& scene, std::span<const int> slots);
std::vector<char> unknown_bsdfs(const Scene& scene, const Theta& theta);

/// Whether any BSDF of the scene reads colours of a texture, not numbers alone.
bool read_as_color(const Scene& scene, TextureId texture);
/// Whether any reads it as roughness.
bool read_as_roughness(const Scene& scene, TextureId texture);
/// Whether a BSDF reads a texture as the share that is metal.
bool read_as_metallic(const Scene& scene, TextureId texture);

/// The most of `recovered` that a BSDF reads which reads `texture`: how many of them change the
/// same light, `texture` itself included. 0 where none reads it.
std::size_t read_together(const Scene& scene, std::span<const TextureId> recovered,
                          TextureId texture);

/// Slot in theta.textures of each texture of the scene, -1 for the others.
std::vector<int> theta_slots(const Scene& scene, const Theta& theta);

/// Throws InputError where a BSDF that reads the texture has delta lobes: their samples are no
/// records, so light that they reflect would not follow the unknown `name`. Weights of blends may
/// be those of such BSDFs, but of at most kMaxShares, one inside another. Nor may the texture turn
/// normals or be an emitter's: records keep directions and light as they were.
void check_unknown(const Scene& scene, const std::string& name, TextureId texture);
/// Whether check_unknown has no objection.
bool can_be_recovered(const Scene& scene, TextureId texture);

/// Adds the texture, which is not in theta yet, with its values in the scene. Throws InputError as
/// check_unknown does.
void add_unknown(const Scene& scene, const std::string& name, TextureId texture, Theta& theta);

}  // namespace burnish
