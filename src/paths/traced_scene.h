// A scene made ready for rays.
#pragma once

#include <memory>
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

/// A scene made ready for rays. The scene must outlive it.
struct TracedScene {
    const Scene* scene = nullptr;
    Accel accel;
    Accel emitting;  ///< the shapes that emit: what a BSDF sample can find
    bool has_emitting = false;
    std::unique_ptr<const TriangleTable> triangles;  ///< on the heap: lights refers to it
    Lights lights;
    CameraRays camera;
    BsdfOrder bsdf_order;
};

TracedScene prepare(const Scene& scene, LightSelection selection = kDefaultLightSelection);

}  // namespace burnish
