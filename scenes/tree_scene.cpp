// The tree's bulbs, camera and materials: the scene file.
#include "image/files.h"
#include "scenes/marks.h"
#include "scenes/scene_files.h"
#include "scenes/scene_xml.h"
#include "scenes/tree.h"
#include "scenes/turned.h"

namespace burnish::procedural {

namespace {

constexpr Rgbf kHues[] = {{1.0f, 0.48f, 0.14f},  {1.0f, 0.10f, 0.05f}, {0.10f, 0.75f, 0.16f},
                          {0.08f, 0.26f, 1.0f},  {1.0f, 0.66f, 0.30f}, {0.95f, 0.10f, 0.42f},
                          {0.10f, 0.66f, 0.80f}, {1.0f, 0.58f, 0.22f}};

Rgbf hue(float random) { return kHues[static_cast<std::size_t>(random * 8)]; }

/// On each tier one row near the edge and one half way, off the surface.
void hang_on_boughs(std::vector<Bulb>& bulbs, std::uint32_t seed) {
    for (int i = 0; i < kTiers; ++i) {
        for (const double t : {0.45, 0.86}) {
            const int count = t < 0.5 ? 5 + 3 * i : 7 + 4 * i;
            for (int j = 0; j < count; ++j) {
                const auto u = uniforms({seed, Stream::kScene}, static_cast<std::uint32_t>(j),
                                        static_cast<std::uint32_t>(2 * i + (t < 0.5)), 1100);
                const double turn = (j + 0.6 * static_cast<double>(u[0])) / count;
                const TreePlace place =
                    tree_place(i, turn, t + 0.1 * (static_cast<double>(u[1]) - 0.5));
                bulbs.push_back({place.position + place.normal * 0.045, 0.017, hue(u[2]) * 3.5f});
            }
        }
    }
}

/// A string of bulbs that sags between two points; `pale` mixes white into their hues.
struct Garland {
    Vec3<double> from, to;
    double sag = 0.3, radius = 0.05;
    int count = 20;
    float radiance = 1, pale = 0.5f;
};

void hang_garland(std::vector<Bulb>& bulbs, const Garland& g, std::uint32_t index,
                  std::uint32_t seed) {
    for (int j = 0; j < g.count; ++j) {
        const auto u = uniforms({seed, Stream::kScene}, static_cast<std::uint32_t>(j), index, 1101);
        const double t = (j + 0.3 + 0.4 * static_cast<double>(u[0])) / g.count;
        Vec3<double> p = g.from * (1 - t) + g.to * t;
        p.y -= g.sag * 4 * t * (1 - t);
        bulbs.push_back({p, g.radius, mix(hue(u[2]), {0.9f, 0.8f, 0.7f}, g.pale) * g.radiance});
    }
}

constexpr const char* kTreeMaterials = R"(
    <bsdf type="twosided" id="mat-tree">
        <bsdf type="principled">
            <texture type="bitmap" name="base_color">
                <string name="filename" value="textures/tree_base_color.png"/>
                <string name="filter_type" value="nearest"/>
            </texture>
            <float name="roughness" value="0.45"/>
            <float name="specular" value="0.4"/>
        </bsdf>
    </bsdf>
    <bsdf type="twosided" id="mat-trunk">
        <bsdf type="principled">
            <rgb name="base_color" value="0.34, 0.16, 0.09"/>
            <float name="roughness" value="0.5"/>
        </bsdf>
    </bsdf>
    <bsdf type="twosided" id="mat-parlour">
        <bsdf type="principled">
            <texture type="bitmap" name="base_color">
                <string name="filename" value="textures/parlour.png"/>
            </texture>
            <float name="roughness" value="0.55"/>
            <float name="specular" value="0.3"/>
        </bsdf>
    </bsdf>

    <emitter type="constant"><rgb name="radiance" value="0.17, 0.17, 0.21"/></emitter>

)";

constexpr Backdrop kParlour{3.4, 4.0, 1.7, 3.6, 0.15};

}  // namespace

std::vector<Bulb> make_bulbs(std::uint32_t seed) {
    std::vector<Bulb> bulbs;
    hang_on_boughs(bulbs, seed);
    // Two strings in the picture, on the wall; the others before, beside and above it.
    const Garland garlands[] = {{{-2.2, 2.55, -1.45}, {0.0, 2.75, -1.45}, 0.35, 0.030, 16, 2.5f, 0},
                                {{0.0, 2.75, -1.45}, {2.2, 2.55, -1.45}, 0.35, 0.030, 16, 2.5f, 0},
                                {{-2.4, 2.9, 2.6}, {2.4, 2.9, 2.6}, 0.5, 0.055, 40, 35},
                                {{-2.6, 2.6, 1.6}, {-2.6, 1.2, 0.0}, 0.2, 0.055, 28, 32},
                                {{2.6, 2.6, 1.6}, {2.6, 1.2, 0.0}, 0.2, 0.055, 28, 24},
                                {{-1.8, 3.3, 0.9}, {1.8, 3.3, 0.9}, 0.3, 0.055, 36, 26},
                                {{-2.2, 0.9, 3.4}, {-1.3, 0.5, 4.2}, 0.1, 0.045, 16, 12},
                                {{2.2, 0.9, 3.4}, {1.3, 0.5, 4.2}, 0.1, 0.045, 16, 12}};
    std::uint32_t index = 0;
    for (const Garland& garland : garlands) hang_garland(bulbs, garland, index++, seed);
    return bulbs;
}

void write_tree(const std::filesystem::path& folder, const ProceduralOptions& options) {
    write_image(folder / "textures/tree_base_color.png",
                make_tree_texture(options.texture_size, options.seed));
    write_image(folder / "textures/parlour.png",
                make_parlour_texture(1024, backdrop_floor_end(kParlour), options.seed));
    write_bytes(folder / "meshes/tree.ply", ply_bytes(make_tree(options.seed)));
    write_bytes(folder / "meshes/trunk.ply", ply_bytes(make_trunk()));
    write_bytes(folder / "meshes/parlour.ply", ply_bytes(make_backdrop(kParlour)));
    write_bytes(folder / "meshes/star.ply", ply_bytes(make_star()));
    write_bytes(folder / "meshes/bulb.ply", ply_bytes(make_bulb()));
    std::string lamps = lamp("star", {0, 2.13, 0.02}, 0.12, {6.0f, 4.2f, 1.8f});
    for (const Bulb& bulb : make_bulbs(options.seed))
        lamps += lamp("bulb", bulb.position, bulb.radius, bulb.radiance);
    const View view{{0.0, 1.55, 5.8}, {0, 1.02, 0}, 26};
    write_bytes(folder / "scene.xml",
                scene_head("tree", "mat-tree's base_color", view) + kTreeMaterials +
                    ply_shape("tree", "mat-tree") + ply_shape("trunk", "mat-trunk") +
                    ply_shape("parlour", "mat-parlour") + lamps + "</scene>\n");
}

}  // namespace burnish::procedural
