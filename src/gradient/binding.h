// Scene and theta, resolved once per iteration: what every stage of an estimator reads.
#pragma once

#include <vector>

#include "gradient/theta.h"
#include "paths/trace.h"
#include "render/shade.h"

namespace burnish {

/// Views into scene and theta, which must outlive it.
struct Binding {
    const TracedScene& traced;
    const Theta& theta;
    TextureTable textures;            ///< of the scene, unknowns and replaced ones in their place
    std::vector<int> slots;           ///< index into theta.textures of each texture, -1 for others
    std::vector<char> unknown_bsdfs;  ///< as of TraceInput
    std::vector<RecordShader> shaders;  ///< of all BSDFs

    Binding(const TracedScene& traced, const Theta& theta);
    Binding(const Binding&) = delete;
    Binding& operator=(const Binding&) = delete;

    const Scene& scene() const { return *traced.scene; }
    const Film& film() const { return traced.film; }
    /// The unknown that a texture is: its index in theta.textures; -1: none.
    int slot_of(TextureId id) const { return id ? slots[static_cast<std::size_t>(id.value)] : -1; }
    const Bitmap& bitmap(TextureId id) const { return std::get<Bitmap>(scene()[id]); }
    const RecordShader& shader(BsdfId id) const {
        return shaders[static_cast<std::size_t>(id.value)];
    }
};

/// Camera samples of a stream on surfaces with unknowns, for an image.
TraceInput unknown_part(const Binding& binding, RandomKey key, std::uint32_t passes_per_iteration);
/// The same with the samples whose value is zero: their derivative may not be.
TraceInput unknown_derivatives(const Binding& binding, RandomKey key,
                               std::uint32_t passes_per_iteration);
/// Camera samples on all other surfaces.
TraceInput constant_part(const Binding& binding, RandomKey key);

/// Non-zero of the pixels of the crop window that light from an unknown can reach.
std::vector<char> reaching_pixels(const Binding& binding);

}  // namespace burnish
