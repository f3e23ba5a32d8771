// A scene made ready for rays.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "paths/accel.h"
#include "paths/lights.h"
#include "shading/camera.h"

namespace burnish {

/// The order in which a batch shades: points of one kind of BSDF together, and of one BSDF.
struct BsdfOrder {
    std::vector<std::int32_t> rank;  ///< of each BSDF; -1 where it is black whatever the light
    std::array<std::size_t, std::variant_size_v<Bsdf> + 1> kind_begin{};  ///< first rank of a kind
};

/// What no view changes of a scene. The scene must outlive it.
struct SceneGeometry {
    Accel accel;
    Accel emitting;  ///< the shapes that emit: what a BSDF sample can find
    /// What the camera sees where emitters are hidden: through them; empty where it sees all.
    std::optional<Accel> without_emitting;
    bool has_emitting = false;
    TriangleTable triangles;
    BsdfOrder bsdf_order;
    std::vector<BsdfId> plain_bsdf;  ///< that every ray sees of a shape; invalid: it depends
    std::vector<char> reads_uv;  ///< of each BSDF: it, or what turns its normals, reads a texture
};

/// The shapes that the camera sees.
inline const Accel& camera_accel(const SceneGeometry& geometry) {
    return geometry.without_emitting ? *geometry.without_emitting : geometry.accel;
}

/// A view of a scene, made ready for rays: a camera, its film, and the lights that are on. Views
/// of one scene share its geometry. A copy is cheap. The scene must outlive it.
struct TracedScene {
    const Scene* scene = nullptr;
    std::shared_ptr<const SceneGeometry> geometry;
    std::shared_ptr<const Lights> lights;
    Film film;
    CameraRays camera;
};

/// The view of the scene's own camera, under all of its lights.
TracedScene prepare(const Scene& scene, LightSelection selection = LightSelection::kUniform);

/// The same scene under the same lights through another camera.
TracedScene with_camera(const TracedScene& view, const CameraRays& camera, const Film& film);

/// The same camera under other lights, chosen in the same way.
TracedScene with_emitters(const TracedScene& view, std::vector<Emitter> emitters);

}  // namespace burnish
