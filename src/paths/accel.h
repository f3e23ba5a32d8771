// Rays against the scene: the only place that knows Embree. Rays travel in packets of sixteen, the
// width of the widest vector unit; narrower machines split them inside Embree.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "paths/hit.h"
#include "scene/scene.h"

namespace burnish {

inline constexpr int kPacketRays = 16;

/// Sixteen rays, one array per component. Lane i is live where valid[i] is -1 (0: ignored).
struct RayPacket {
    alignas(64) std::array<std::int32_t, kPacketRays> valid{};
    alignas(64) std::array<float, kPacketRays> origin_x, origin_y, origin_z;
    alignas(64) std::array<float, kPacketRays> direction_x, direction_y, direction_z;
    alignas(64) std::array<float, kPacketRays> max_distance;
};

/// Closest hits. shape[i] is -1 for a miss; u, v are Embree's barycentrics (weights of vertices 1
/// and 2) for a mesh and unused for other shapes.
struct HitPacket {
    alignas(64) std::array<std::int32_t, kPacketRays> shape, primitive;
    alignas(64) std::array<float, kPacketRays> distance, u, v;
};
inline Hit hit_of(const HitPacket& h, std::size_t lane) {
    return {h.shape[lane], h.primitive[lane], h.distance[lane], h.u[lane], h.v[lane]};
}

/// Packets whose lanes start together and point the same way are told apart from scattered ones.
enum class Coherence { kCoherent, kIncoherent };

class Accel;

/// A ray packet as it was traced, kept by a RayRecorder.
struct RecordedRays {
    const Accel* accel;
    RayPacket rays;
    Coherence coherence;
    bool occlusion;
};

/// Keeps every packet that is traced: benchmarks replay them to time the rays alone. One thread
/// only.
using RayRecorder = std::vector<RecordedRays>;

enum class Shapes { kAll, kEmitting, kNotEmitting };

/// The acceleration structure of a scene's shapes, or of those that emit or do not. Prototypes are
/// built once, however many instances show them. The scene must outlive it.
class Accel {
  public:
    explicit Accel(const Scene& scene, Shapes shapes = Shapes::kAll);
    ~Accel();
    Accel(Accel&&) noexcept;
    Accel& operator=(Accel&&) noexcept;

    /// Distances are measured in units of the (unit) direction.
    HitPacket intersect(const RayPacket& rays, Coherence coherence) const;
    /// occluded[i] is non-zero where anything lies before max_distance.
    std::array<std::int32_t, kPacketRays> occluded(const RayPacket& rays,
                                                   Coherence coherence) const;

    mutable RayRecorder* recorder = nullptr;  ///< where set, keeps a copy of every packet

  private:
    struct Handles;
    std::unique_ptr<Handles> handles_;
};

}  // namespace burnish
