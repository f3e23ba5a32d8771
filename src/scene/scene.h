// What the world is, as plain aggregates. Nothing here knows XML, rays or random numbers.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "scene/camera.h"
#include "scene/emitter.h"
#include "scene/ids.h"
#include "scene/material.h"
#include "scene/shape.h"
#include "scene/texture.h"

namespace burnish {

/// A texture that can be optimised, under Mitsuba's name.
struct Parameter {
    std::string name;   ///< e.g. "mat-tire.brdf_0.roughness.data"
    TextureId texture;  ///< always a Bitmap; several parameters may share one
};

/// A number or a colour that a BSDF or a blend has in the place of a texture, under Mitsuba's name.
struct ConstantParameter {
    std::string name;       ///< e.g. "mat-tire.brdf_0.metallic.value"
    BsdfId bsdf;            ///< that reads it
    int input = 0;          ///< its place in the BSDF's row (scene/material.h)
    bool is_given = false;  ///< by the scene file; otherwise a default
    MaterialId blend = {};  ///< whose weight it is, in the place of a BSDF's input
    /// The BSDF's or the blend's in the scene file. One element may be built several times: a blend
    /// for each material that shows it, a BSDF for each shape whose mesh attributes it reads. Their
    /// numbers are one.
    int element = -1;
};

struct Scene {
    PerspectiveCamera camera;          ///< the first sensor's
    Film film;                         ///< the first sensor's
    std::vector<SceneSensor> sensors;  ///< all of the scene file; may be empty without one
    bool hide_emitters = false;        ///< the camera sees through emitters
    int max_depth = 2;                 ///< segments of a path at most: 2 is direct light
    /// Alpha is that of Mitsuba's `direct`, to which masks and panes are surfaces, and an
    /// environment is none.
    bool direct_alpha = true;
    int rr_depth = 5;       ///< segments from which on Russian roulette ends paths
    int sample_count = 16;  ///< the scene file's samples per pixel

    std::vector<Texture> textures;
    std::vector<Bsdf> bsdfs;
    /// Of each BSDF those of the blends that it is in whose weights may be unknowns, from the
    /// outermost on; empty, or parallel to bsdfs.
    std::vector<std::vector<BlendShare>> shares;
    std::vector<Material> materials;
    std::vector<Emitter> emitters;
    std::vector<std::string> emitter_ids;  ///< parallel to emitters, or empty without a scene file
    std::vector<Shape> shapes;
    std::vector<Shape> prototypes;  ///< what instances show: by themselves in no place
    /// Every bitmap that a BSDF parameter reads, in order of the file.
    std::vector<Parameter> parameters;
    /// What could be a texture in the place of a constant. Empty without a scene file.
    std::vector<ConstantParameter> constants;
    /// Names of inputs that read a mesh attribute, which cannot be recovered.
    std::vector<std::string> attribute_inputs;
    /// Names of textures that turn normals, and of weights that are no bitmaps, which cannot be
    /// recovered.
    std::vector<std::string> layer_inputs;
    /// Names of numbers of BSDFs that say an index of refraction, which cannot be recovered.
    std::vector<std::string> index_inputs;
    /// Names of numbers of BSDFs that let light pass through where the file gives them other than
    /// as 0; here it does not, and they cannot be recovered.
    std::vector<std::string> absent_lobes;

    const Texture& operator[](TextureId i) const {
        return textures[static_cast<std::size_t>(i.value)];
    }
    Texture& operator[](TextureId i) { return textures[static_cast<std::size_t>(i.value)]; }
    const Bsdf& operator[](BsdfId i) const { return bsdfs[static_cast<std::size_t>(i.value)]; }
    const Material& operator[](MaterialId i) const {
        return materials[static_cast<std::size_t>(i.value)];
    }
    const Emitter& operator[](EmitterId i) const {
        return emitters[static_cast<std::size_t>(i.value)];
    }
    const Shape& operator[](ShapeId i) const { return shapes[static_cast<std::size_t>(i.value)]; }
};

/// Scene::max_depth of paths of any length.
inline constexpr int kUnboundedDepth = std::numeric_limits<int>::max();
/// Whether light may be scattered more than once, or never.
inline bool has_bounces(const Scene& scene) { return scene.max_depth != 2; }

/// Contract of a scene: every id is valid where it must be, and within its array.
void check_references(const Scene& scene);

/// Which lobes of a BSDF are delta lobes.
DeltaLobes delta_lobes(const Scene& scene, BsdfId bsdf);

/// The emitter of the scene that is an environment map, of which there is at most one; null: none.
const EnvironmentEmitter* environment_map(const Scene& scene);

/// The mesh that a shape shows, of an instance that of its prototype; null where it has none.
const Mesh* shown_mesh(const Scene& scene, const Shape& shape);

/// The box around a shape in the world; of an instance around its prototype's box.
Box box_of(const Scene& scene, const Shape& shape);

/// Whether a material is another one, or part of what it blends.
bool is_in(const Scene& scene, MaterialId inner, MaterialId material);
/// The BSDFs that a material may show on either side, those of blends included.
std::vector<BsdfId> bsdfs_of(const Scene& scene, MaterialId material);
/// Whether points show another material or other normals than their shape says.
bool has_layers(const Scene& scene);

/// The blends that a BSDF is in.
inline std::span<const BlendShare> shares_of(const Scene& scene, BsdfId bsdf) {
    const auto i = static_cast<std::size_t>(bsdf.value);
    return i < scene.shares.size() ? std::span(scene.shares[i]) : std::span<const BlendShare>();
}
/// The textures whose derivatives reach a BSDF's value: those that it reads, and the weights of its
/// shares.
std::vector<TextureId> textures_of(const Scene& scene, BsdfId bsdf);
/// Whether a texture is one of those.
bool reads(const Scene& scene, BsdfId bsdf, TextureId texture);

/// Whether a texture turns the normals of a material.
bool turns_normals(const Scene& scene, TextureId texture);
/// Whether a texture is the weight of a blend or the opacity of a mask: parts are drawn by it.
bool weighs_parts(const Scene& scene, TextureId texture);
/// Whether an emitter reads a texture.
bool is_of_emitter(const Scene& scene, TextureId texture);
/// The mean_magnitude of a texture, or 1 without one: by it a textured emitter is as bright on
/// average as one of a single colour.
Rgbf mean_texture(const Scene& scene, TextureId texture);
/// The radiance of an area light, on average over its texture.
Rgbf mean_radiance(const Scene& scene, const AreaEmitter& area);

/// Whether paths of direct light, or the light that they carry, depend on the values of a texture:
/// by them directions are sampled, parts of blends are drawn, normals turn or emitters shine. Where
/// not, its values count in f alone.
bool draws_paths(const Scene& scene, TextureId texture);

/// The textures that a material reads on either side, each once; none for an invalid id.
std::vector<TextureId> textures_of(const Scene& scene, MaterialId material);

}  // namespace burnish
