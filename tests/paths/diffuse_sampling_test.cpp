// The directions that a diffuse surface draws against the density that it states (chi-square), as
// the renderer finds them: any surface seen from any side, one-sided or two-sided, grazing or not.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "ledger_entries.h"
#include "paths/one_light.h"
#include "paths/points.h"
#include "paths/primary_rays.h"
#include "shading/sphere_integral.h"

namespace burnish::test {
namespace {

using ledger::kRandomDiffuseSampling;

Direction in_double(const Vec3f& d) { return {double{d.x}, double{d.y}, double{d.z}}; }

/// A parallelogram anywhere, and the camera that looks at its middle.
struct View {
    Vec3f corner, u, v;
    Frame frame;  ///< the surface's: n is its front
    Vec3f camera;
    bool two_sided = false, other_back = false, behind = false;
};

/// Every third camera grazes.
View random_view(std::uint32_t i) {
    RandomSource random{seed_of(kRandomDiffuseSampling, 500000 + i)};
    const auto vector = [&] {
        return Vec3f{random.next(-1, 1), random.next(-1, 1), random.next(-1, 1)};
    };
    View view;
    view.two_sided = i % 2 == 1, view.other_back = i % 8 == 5, view.behind = i % 4 >= 2;
    view.corner = vector(), view.u = vector(), view.v = vector();
    view.frame = frame_from_tangent(normalize(cross(view.u, view.v)), view.u);
    const float theta = (i % 3 == 1 ? random.next(85, 89.5f) : random.next(0, 85)) *
                        std::numbers::pi_v<float> / 180,
                phi = 2 * std::numbers::pi_v<float> * random.next(),
                z = view.behind ? -std::cos(theta) : std::cos(theta);
    view.camera =
        view.corner + (view.u + view.v) * 0.5f +
        to_world(view.frame, {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), z});
    return view;
}

Scene scene_of(const View& view) {
    Scene scene;
    scene.camera.to_world = look_at(
        in_double(view.camera), in_double(view.corner + (view.u + view.v) * 0.5f), {0.1, 0.2, 1});
    scene.camera.fov_x = 0.001;
    scene.film = {1, 1, 0, 0, 1, 1, {}};
    scene.bsdfs = {Diffuse{}, Diffuse{}};
    const BsdfId back{view.two_sided ? (view.other_back ? 1 : 0) : -1};
    scene.materials = {{"surface", {0}, back}};
    scene.shapes = {{"surface", make_quad(view.corner, view.u, view.v), {0}, {}}};
    scene.emitters = {ConstantEmitter{}};
    return scene;
}

/// The surface that the camera sees, and its BSDF.
class SeenSurface {
  public:
    explicit SeenSurface(const View& view)
        : frame_(view.frame), scene_(scene_of(view)), traced_(prepare(scene_)) {
        const TextureTable textures{scene_.textures, {}};
        const BatchSample sample;
        Rgbf emitted;
        const TraceInput input{&traced_, &textures, {1, Stream::kTest}, 1, SurfaceChoice::kAll, {}};
        trace_primary_rays(input, {&sample, 1}, *film_, *primary_, {&emitted, 1});
        find_points(input, 1, *primary_, *points_);
        const IndexRange& range = points_->kinds[0];
        bsdf_.emplace(BsdfPoints{&scene_, &textures, points_->bsdf, &points_->u, &points_->v},
                      range, *lanes_);
    }

    bool can_be_lit() const { return points_->live.count == 1; }
    /// Directions in the frame of the surface.
    Direction sample(const std::array<double, 4>& u) const {
        const auto at = [&](std::size_t i) {
            return Packet(std::min(static_cast<float>(u[i]), 1 - 0x1p-24f));
        };
        const auto drawn = bsdf_->sample(0, load(points_->wi, 0), {at(0), at(1)}, at(2));
        const Vec3<Packet> d = direction_to_world(*points_, 0, drawn.wo_local);
        const Vec3f world{get(d.x, 0), get(d.y, 0), get(d.z, 0)};
        return normalize(in_double(to_local(frame_, world)));
    }
    double pdf(const Direction& local) const {
        const Vec3f world =
            to_world(frame_, Vec3f{static_cast<float>(local.x), static_cast<float>(local.y),
                                   static_cast<float>(local.z)});
        const Vec3<Packet> wo =
            direction_to_local(*points_, 0, {Packet(world.x), Packet(world.y), Packet(world.z)});
        return double{get(bsdf_->eval_pdf(0, load(points_->wi, 0), wo).pdf, 0)};
    }

  private:
    Frame frame_;
    Scene scene_;
    TracedScene traced_;
    std::unique_ptr<FilmLanes> film_ = std::make_unique<FilmLanes>();
    std::unique_ptr<RayLanes> primary_ = std::make_unique<RayLanes>();
    std::unique_ptr<PointLanes> points_ = std::make_unique<PointLanes>();
    std::unique_ptr<BsdfColumns> lanes_ = std::make_unique<BsdfColumns>();
    std::optional<BsdfPackets<Diffuse>> bsdf_;
};

TEST(DiffuseSampling, OfAnySurfaceFollowsItsDensity) {
    const LedgerEntry& entry = kRandomDiffuseSampling;
    const Direction z{0, 0, 1};
    std::uint32_t seed = 0;
    for (std::uint32_t i = 0; i < 16; ++i) {
        const View view = random_view(i);
        const std::string text = fmt::format("configuration {}", i);
        const SeenSurface surface(view);
        ASSERT_EQ(surface.can_be_lit(), view.two_sided || !view.behind) << text;
        if (!surface.can_be_lit()) continue;

        const Sampler sampler = [&](const std::array<double, 4>& u) {
            return std::optional(surface.sample(u));
        };
        const DrawnDirections drawn =
            draw_directions(sampler, {z, -z}, seed_of(entry, seed += 10), scaled(entry, 200000u));
        const FitResult result = fit_of(drawn, [&](const Direction& d) { return surface.pdf(d); });
        EXPECT_NEAR(result.total, 1, 1e-4) << text;
        EXPECT_TRUE(accepted(entry, text, result.p_value));
        const auto p_value = [&](const Density& density) { return fit_of(drawn, density).p_value; };
        EXPECT_TRUE(rejected(entry, "density of the other side", p_value([&](const Direction& d) {
                                 return surface.pdf({d.x, d.y, -d.z});
                             })))
            << text;
        EXPECT_TRUE(rejected(entry, "density without its cosine", p_value([&](const Direction& d) {
                                 return (d.z > 0) != view.behind ? 0.5 / std::numbers::pi : 0.0;
                             })))
            << text;
    }
}

}  // namespace
}  // namespace burnish::test
