// The goblet's lamps, camera and materials: the scene file.
#include <fmt/format.h>

#include <numbers>

#include "image/files.h"
#include "scenes/goblet.h"
#include "scenes/noise.h"
#include "scenes/scene_files.h"
#include "scenes/scene_xml.h"

namespace burnish::procedural {

namespace {

using Vec3d = Vec3<double>;
using std::numbers::pi;

constexpr Rgbf kWarm[] = {
    {1.0f, 0.32f, 0.07f}, {1.0f, 0.55f, 0.20f}, {1.0f, 0.20f, 0.10f}, {1.0f, 0.68f, 0.36f}};
constexpr Rgbf kCool[] = {
    {0.12f, 0.36f, 1.0f}, {0.12f, 0.72f, 0.85f}, {0.42f, 0.26f, 1.0f}, {0.95f, 0.20f, 0.60f}};

/// Warm on the camera's left, cool on its right, mixed in between.
Rgbf lamp_color(const Vec3d& position, float random) {
    const bool warm =
        position.x + 0.9 * (static_cast<double>(random * 4 - std::floor(random * 4)) - 0.5) < 0;
    return (warm ? kWarm : kCool)[static_cast<std::size_t>(random * 4)];
}

/// Glass marbles that glow, on the table in a ring around the foot.
std::string marbles(std::uint32_t seed) {
    std::string xml;
    for (std::uint32_t i = 0; i < 10; ++i) {
        const auto u = uniforms({seed, Stream::kScene}, i, 0, 700);
        const double size = 0.04 + 0.04 * static_cast<double>(u[0]);
        const Vec3d p = around_axis(0.85 + 0.85 * static_cast<double>(u[1]), size,
                                    2 * pi * (i + 0.7 * static_cast<double>(u[2])) / 10);
        xml += area_light(
            fmt::format(
                "<shape type=\"sphere\"><point name=\"center\" value=\"{:.4f}, {:.4f}, {:.4f}\"/>"
                "<float name=\"radius\" value=\"{:.4f}\"/>",
                p.x, p.y, p.z, size),
            lamp_color(p, u[3]) * 4.0f);
    }
    return xml;
}

/// Panels above and beside the picture, turned to the bowl.
std::string panels(std::uint32_t seed) {
    std::string xml;
    for (std::uint32_t i = 0; i < 14; ++i) {
        const auto u = uniforms({seed, Stream::kScene}, i, 0, 701),
                   v = uniforms({seed, Stream::kScene}, i, 1, 701);
        // Every third hangs above; the others stand aside of the picture, those on the camera's
        // side behind the camera.
        const bool above = i % 3 == 0;
        const double azimuth = pi / 180 * (-130 + 260 * (i + 0.8 * static_cast<double>(u[2])) / 14);
        const double aside = std::fabs(azimuth) < pi / 3 ? 4.3 : 2.7;
        const double height = above ? 3.4 : 0.7 + 1.7 * static_cast<double>(u[0]);
        const double radius = above ? 1.4 : aside + 0.6 * static_cast<double>(u[1]);
        const Vec3d p = around_axis(radius, height, azimuth);
        const double half_width = 0.16 + 0.26 * static_cast<double>(v[0]);
        const double half_height = 0.35 + 0.40 * static_cast<double>(v[1]);
        xml += panel_light(
            {p, {0, 0.9, 0}, half_width, half_height},
            lamp_color(p, u[3]) *
                (0.07f * static_cast<float>(radius * radius / (half_width * half_height))));
    }
    return xml;
}

/// Paper lanterns that hang around the table.
std::string lanterns(std::uint32_t seed) {
    std::string xml;
    for (std::uint32_t i = 0; i < 4; ++i) {
        const auto u = uniforms({seed, Stream::kScene}, i, 0, 702),
                   v = uniforms({seed, Stream::kScene}, i, 1, 702);
        const double size = 0.06 + 0.05 * static_cast<double>(u[0]);
        const double azimuth = 2 * pi * (i + 0.6 * static_cast<double>(u[2])) / 4;
        const Vec3d p = around_axis(2.0 + 0.9 * static_cast<double>(u[1]),
                                    0.35 + 1.3 * static_cast<double>(v[0]), azimuth);
        xml += lamp("lantern", p, size, lamp_color(p, u[3]) * 4.0f);
    }
    return xml;
}

constexpr const char* kGobletMaterials = R"(
    <bsdf type="twosided" id="mat-goblet">
        <bsdf type="principled">
            <texture type="bitmap" name="base_color">
                <string name="filename" value="textures/goblet_base_color.png"/>
            </texture>
            <texture type="bitmap" name="roughness">
                <string name="filename" value="textures/goblet_roughness.png"/>
                <string name="filter_type" value="nearest"/>
                <boolean name="raw" value="true"/>
            </texture>
            <float name="metallic" value="0.9"/>
        </bsdf>
    </bsdf>
    <bsdf type="twosided" id="mat-inside">
        <bsdf type="principled">
            <rgb name="base_color" value="0.95, 0.68, 0.30"/>
            <float name="roughness" value="0.35"/>
            <float name="metallic" value="1"/>
        </bsdf>
    </bsdf>
    <bsdf type="twosided" id="mat-table">
        <bsdf type="principled">
            <texture type="bitmap" name="base_color">
                <string name="filename" value="textures/table.png"/>
            </texture>
            <float name="roughness" value="0.32"/>
        </bsdf>
    </bsdf>

)";

constexpr const char* kSky = R"(
    <emitter type="envmap">
        <string name="filename" value="textures/sky.exr"/>
    </emitter>
)";

}  // namespace

void write_goblet(const std::filesystem::path& folder, const ProceduralOptions& options) {
    const GobletTextures textures = make_goblet_textures(options.texture_size, options.seed);
    write_image(folder / "textures/goblet_roughness.png", textures.roughness, false);
    write_image(folder / "textures/goblet_base_color.png", textures.base_color);
    write_image(folder / "textures/table.png", make_table_texture(512, options.seed));
    write_image(folder / "textures/sky.exr", make_evening_sky(256, options.seed));
    write_bytes(folder / "meshes/goblet.ply", ply_bytes(make_goblet_wall()));
    write_bytes(folder / "meshes/inside.ply", ply_bytes(make_goblet_inside()));
    write_bytes(folder / "meshes/table.ply", ply_bytes(make_table_top()));
    write_bytes(folder / "meshes/lantern.ply", ply_bytes(make_lantern()));
    const View view{{0.5, 1.75, 3.65}, {0, 0.83, 0}, 31};
    write_bytes(folder / "scene.xml",
                scene_head("goblet", "mat-goblet's roughness", view) + kGobletMaterials +
                    ply_shape("goblet", "mat-goblet") + ply_shape("inside", "mat-inside") +
                    ply_shape("table", "mat-table") + kSky + marbles(options.seed) +
                    panels(options.seed) + lanterns(options.seed) + "</scene>\n");
}

}  // namespace burnish::procedural
