#include "paths/accel.h"

#if BURNISH_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "burnish/error.h"
#include "paths/analytic.h"

namespace burnish {

namespace {

void analytic_bounds(const RTCBoundsFunctionArguments* args) {
    const Geometry& geometry = static_cast<const Shape*>(args->geometryUserPtr)->geometry;
    const auto [low, high] = box_of(geometry);
    // Padding: a flat box and the rounding of its corners must not lose the surface.
    const float pad =
        1e-5f * (1.0f + std::max(max_component(high), -std::min({low.x, low.y, low.z})));
    *args->bounds_o = {low.x - pad,  low.y - pad,  low.z - pad,  0,
                       high.x + pad, high.y + pad, high.z + pad, 0};
}

/// Rays of a query, one array per component.
struct RaysOfQuery {
    const float *x, *y, *z, *direction_x, *direction_y, *direction_z, *near, *far;

    RaysOfQuery(RTCRayN* ray, unsigned n)
        : x(&RTCRayN_org_x(ray, n, 0)),
          y(&RTCRayN_org_y(ray, n, 0)),
          z(&RTCRayN_org_z(ray, n, 0)),
          direction_x(&RTCRayN_dir_x(ray, n, 0)),
          direction_y(&RTCRayN_dir_y(ray, n, 0)),
          direction_z(&RTCRayN_dir_z(ray, n, 0)),
          near(&RTCRayN_tnear(ray, n, 0)),
          far(&RTCRayN_tfar(ray, n, 0)) {}
    Vec3f origin(unsigned i) const { return {x[i], y[i], z[i]}; }
    Vec3f direction(unsigned i) const { return {direction_x[i], direction_y[i], direction_z[i]}; }
};

using Distances = std::array<float, kPacketRays>;

/// Where each valid ray of a query meets a shape first; NaN: nowhere.
Distances first_hits(const Shape& shape, const int* valid, RTCRayN* ray, unsigned n) {
    const RaysOfQuery rays(ray, n);
    Distances t;
    const auto* sphere = std::get_if<Sphere>(&shape.geometry);
    const auto asked = std::count(valid, valid + n, -1);
    if (sphere && asked > 2) {  // all at once: vector code
        for (unsigned i = 0; i < n; ++i)
            t[i] = first_within(sphere_hits(*sphere, rays.origin(i), rays.direction(i)),
                                rays.near[i], rays.far[i]);
    } else {
        for (unsigned i = 0; i < n; ++i)
            if (valid[i] == -1)
                t[i] =
                    first_within(analytic_hits(shape.geometry, rays.origin(i), rays.direction(i)),
                                 rays.near[i], rays.far[i]);
    }
    return t;
}

void analytic_intersect(const RTCIntersectFunctionNArguments* args) {
    const unsigned n = args->N;
    RTCRayN* ray = RTCRayHitN_RayN(args->rayhit, n);
    RTCHitN* hit = RTCRayHitN_HitN(args->rayhit, n);
    const Distances t =
        first_hits(*static_cast<const Shape*>(args->geometryUserPtr), args->valid, ray, n);
    for (unsigned i = 0; i < n; ++i) {
        if (args->valid[i] != -1 || std::isnan(t[i])) continue;
        RTCRayN_tfar(ray, n, i) = t[i];
        RTCHitN_u(hit, n, i) = 0;
        RTCHitN_v(hit, n, i) = 0;
        RTCHitN_primID(hit, n, i) = args->primID;
        RTCHitN_geomID(hit, n, i) = args->geomID;
        RTCHitN_instID(hit, n, i, 0) = args->context->instID[0];
    }
}

void analytic_occluded(const RTCOccludedFunctionNArguments* args) {
    const unsigned n = args->N;
    const Distances t =
        first_hits(*static_cast<const Shape*>(args->geometryUserPtr), args->valid, args->ray, n);
    for (unsigned i = 0; i < n; ++i)
        if (args->valid[i] == -1 && !std::isnan(t[i]))
            RTCRayN_tfar(args->ray, n, i) = -std::numeric_limits<float>::infinity();
}

/// Throws what the calls since the last check have met. device: null where there is none.
void check_embree(RTCDevice device) {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    if (error == RTC_ERROR_UNKNOWN)  // so it says where its own containers find no memory, too
        throw ResourceError("Embree failed: there may not be enough memory for the scene");
    if (error != RTC_ERROR_NONE)
        throw std::runtime_error("Embree failed, error " + std::to_string(error));
}

struct ReleaseGeometry {
    void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using GeometryHandle = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, ReleaseGeometry>;

GeometryHandle new_geometry(RTCDevice device, RTCGeometryType type) {
    GeometryHandle geometry(rtcNewGeometry(device, type));
    check_embree(device);
    return geometry;
}

/// A copy of the values, not a view: Embree reads 16 bytes at each vertex, so its buffer is padded.
template <class T>
void copy_buffer(RTCDevice device, RTCGeometry geometry, RTCBufferType type, RTCFormat format,
                 const std::vector<T>& values) {
    void* const buffer =
        rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(T), values.size());
    check_embree(device);
    std::memcpy(buffer, values.data(), values.size() * sizeof(T));
}

GeometryHandle make_mesh(RTCDevice device, const Mesh& mesh) {
    GeometryHandle geometry = new_geometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    copy_buffer(device, geometry.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, mesh.positions);
    copy_buffer(device, geometry.get(), RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, mesh.triangles);
    return geometry;
}

/// Of a scene that shows one prototype.
GeometryHandle make_instance(RTCDevice device, RTCScene prototype, const Transform& to_world) {
    GeometryHandle geometry = new_geometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry.get(), prototype);
    std::array<float, 12> rows;
    for (int i = 0; i < 12; ++i)
        rows[static_cast<std::size_t>(i)] = static_cast<float>(to_world(i / 4, i % 4));
    rtcSetGeometryTransform(geometry.get(), 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, rows.data());
    return geometry;
}

GeometryHandle make_analytic(RTCDevice device, const Shape& shape) {
    GeometryHandle geometry = new_geometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry.get(), 1);
    rtcSetGeometryUserData(geometry.get(), const_cast<Shape*>(&shape));
    rtcSetGeometryBoundsFunction(geometry.get(), analytic_bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry.get(), analytic_intersect);
    rtcSetGeometryOccludedFunction(geometry.get(), analytic_occluded);
    return geometry;
}

void fill_ray(RTCRay16& out, const RayPacket& in) {
    std::memcpy(out.org_x, in.origin_x.data(), sizeof(out.org_x));
    std::memcpy(out.org_y, in.origin_y.data(), sizeof(out.org_y));
    std::memcpy(out.org_z, in.origin_z.data(), sizeof(out.org_z));
    std::memcpy(out.dir_x, in.direction_x.data(), sizeof(out.dir_x));
    std::memcpy(out.dir_y, in.direction_y.data(), sizeof(out.dir_y));
    std::memcpy(out.dir_z, in.direction_z.data(), sizeof(out.dir_z));
    std::memcpy(out.tfar, in.max_distance.data(), sizeof(out.tfar));
    for (int i = 0; i < kPacketRays; ++i)
        out.tnear[i] = 0, out.time[i] = 0, out.mask[i] = ~0u, out.flags[i] = 0;
}

// The two versions of Embree differ in how a query is described, and in nothing else here.
#if BURNISH_EMBREE_MAJOR >= 4
RTCRayQueryFlags query_flags(Coherence coherence) {
    return coherence == Coherence::kCoherent ? RTC_RAY_QUERY_FLAG_COHERENT
                                             : RTC_RAY_QUERY_FLAG_INCOHERENT;
}

void intersect_packet(RTCScene scene, const RayPacket& rays, Coherence coherence,
                      RTCRayHit16& query) {
    RTCIntersectArguments args;
    rtcInitIntersectArguments(&args);
    args.flags = query_flags(coherence);
    rtcIntersect16(rays.valid.data(), scene, &query, &args);
}

void occlude_packet(RTCScene scene, const RayPacket& rays, Coherence coherence, RTCRay16& query) {
    RTCOccludedArguments args;
    rtcInitOccludedArguments(&args);
    args.flags = query_flags(coherence);
    rtcOccluded16(rays.valid.data(), scene, &query, &args);
}
#else
RTCIntersectContext query_context(Coherence coherence) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = coherence == Coherence::kCoherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                                      : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return context;
}

void intersect_packet(RTCScene scene, const RayPacket& rays, Coherence coherence,
                      RTCRayHit16& query) {
    RTCIntersectContext context = query_context(coherence);
    rtcIntersect16(rays.valid.data(), scene, &context, &query);
}

void occlude_packet(RTCScene scene, const RayPacket& rays, Coherence coherence, RTCRay16& query) {
    RTCIntersectContext context = query_context(coherence);
    rtcOccluded16(rays.valid.data(), scene, &context, &query);
}
#endif

}  // namespace

struct Accel::Handles {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    std::vector<RTCScene> prototypes;  ///< null: no instance shows it
    bool is_small = false;             ///< a packet visits nearly all of it, whatever its rays
    ~Handles() {
        if (scene) rtcReleaseScene(scene);
        for (RTCScene prototype : prototypes)
            if (prototype) rtcReleaseScene(prototype);
        if (device) rtcReleaseDevice(device);
    }
};

namespace {

RTCScene new_scene(RTCDevice device) {
    RTCScene scene = rtcNewScene(device);
    check_embree(device);
    rtcSetSceneBuildQuality(
        scene,
        RTC_BUILD_QUALITY_MEDIUM);  // HIGH splits in parallel: not deterministic
    // Where surfaces coincide, rounding decides which one a ray meets. Published scenes have such
    // floors; compact triangles round as Mitsuba's do.
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_COMPACT);
    return scene;
}

/// A shape by itself; not an instance.
GeometryHandle make_geometry(RTCDevice device, const Shape& shape) {
    const Mesh* const mesh = mesh_of(shape.geometry);
    return mesh ? make_mesh(device, *mesh) : make_analytic(device, shape);
}

void attach(RTCScene scene, RTCGeometry geometry, std::size_t id) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, static_cast<unsigned>(id));
}

/// In a structure of so few primitives, packets that stay together are faster even where their rays
/// are scattered (decision 049).
constexpr std::size_t kSmall = 48;

/// Triangles, or one; of an instance so many that no structure with it is small.
std::size_t primitives_of(const Shape& shape) {
    if (std::holds_alternative<Instance>(shape.geometry)) return kSmall + 1;
    const Mesh* const mesh = mesh_of(shape.geometry);
    return mesh ? mesh->triangles.size() : 1;
}

bool belongs(const Shape& shape, Shapes shapes) {
    return shapes == Shapes::kAll || bool(shape.emitter) == (shapes == Shapes::kEmitting);
}

// 512-bit units are left off by default for the sake of code that mixes; here rays dominate.
#ifdef BURNISH_PLAIN_THREADS  // Embree's threads are TBB's, too
constexpr const char* kDeviceConfig = "frequency_level=simd512,threads=1";
#else
constexpr const char* kDeviceConfig = "frequency_level=simd512";
#endif

}  // namespace

Accel::Accel(const Scene& scene, Shapes shapes) : handles_(std::make_unique<Handles>()) {
    RTCDevice device = handles_->device = rtcNewDevice(kDeviceConfig);
    check_embree(device);
    handles_->scene = new_scene(device);
    handles_->prototypes.resize(scene.prototypes.size());
    const auto prototype_scene = [&](std::uint32_t i) {
        RTCScene& prototype = handles_->prototypes[i];
        if (prototype) return prototype;
        prototype = new_scene(device);
        attach(prototype, make_geometry(device, scene.prototypes[i]).get(), 0);
        rtcCommitScene(prototype);
        check_embree(device);
        return prototype;
    };
    std::size_t primitives = 0;
    for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
        const Shape& shape = scene.shapes[i];
        if (!belongs(shape, shapes)) continue;
        primitives += primitives_of(shape);
        const auto* instance = std::get_if<Instance>(&shape.geometry);
        const GeometryHandle geometry =
            instance
                ? make_instance(device, prototype_scene(instance->prototype), instance->to_world)
                : make_geometry(device, shape);
        attach(handles_->scene, geometry.get(), i);
    }
    handles_->is_small = primitives <= kSmall;
    rtcCommitScene(handles_->scene);
    check_embree(device);
}

Accel::~Accel() = default;
Accel::Accel(Accel&&) noexcept = default;
Accel& Accel::operator=(Accel&&) noexcept = default;

HitPacket Accel::intersect(const RayPacket& rays, Coherence coherence) const {
    if (recorder) recorder->push_back({this, rays, coherence, false});
    if (handles_->is_small) coherence = Coherence::kCoherent;
    RTCRayHit16 query;
    fill_ray(query.ray, rays);
    for (int i = 0; i < kPacketRays; ++i)
        query.hit.geomID[i] = query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    intersect_packet(handles_->scene, rays, coherence, query);
    HitPacket hits;
    std::memcpy(hits.shape.data(), query.hit.geomID,
                sizeof(query.hit.geomID));  // invalid = ~0u = -1
    // Within its instance a prototype has the number 0.
    if (!handles_->prototypes.empty())
        for (std::size_t i = 0; i < kPacketRays; ++i)
            if (hits.shape[i] >= 0 && query.hit.instID[0][i] != RTC_INVALID_GEOMETRY_ID)
                hits.shape[i] = static_cast<std::int32_t>(query.hit.instID[0][i]);
    std::memcpy(hits.primitive.data(), query.hit.primID, sizeof(query.hit.primID));
    std::memcpy(hits.distance.data(), query.ray.tfar, sizeof(query.ray.tfar));
    std::memcpy(hits.u.data(), query.hit.u, sizeof(query.hit.u));
    std::memcpy(hits.v.data(), query.hit.v, sizeof(query.hit.v));
    return hits;
}

std::array<std::int32_t, kPacketRays> Accel::occluded(const RayPacket& rays,
                                                      Coherence coherence) const {
    if (recorder) recorder->push_back({this, rays, coherence, true});
    if (handles_->is_small) coherence = Coherence::kCoherent;
    RTCRay16 query;
    fill_ray(query, rays);
    occlude_packet(handles_->scene, rays, coherence, query);
    std::array<std::int32_t, kPacketRays> result;
    for (int i = 0; i < kPacketRays; ++i) result[i] = query.tfar[i] < 0 ? -1 : 0;
    return result;
}

}  // namespace burnish
