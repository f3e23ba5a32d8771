// The bowl's light, camera and materials: the scene file.
#include "image/files.h"
#include "scenes/bowl.h"
#include "scenes/scene_files.h"
#include "scenes/scene_xml.h"

namespace burnish::procedural {

namespace {

constexpr const char* kBowlMaterials = R"(
    <bsdf type="twosided" id="mat-bowl">
        <bsdf type="principled">
            <texture type="bitmap" name="base_color">
                <string name="filename" value="textures/bowl_base_color.png"/>
            </texture>
            <texture type="bitmap" name="anisotropic">
                <string name="filename" value="textures/bowl_anisotropic.png"/>
                <string name="filter_type" value="nearest"/>
                <boolean name="raw" value="true"/>
            </texture>
            <float name="roughness" value="0.42"/>
            <float name="metallic" value="1"/>
        </bsdf>
    </bsdf>
    <bsdf type="twosided" id="mat-stone">
        <bsdf type="principled">
            <texture type="bitmap" name="base_color">
                <string name="filename" value="textures/stone.png"/>
            </texture>
            <float name="roughness" value="0.5"/>
        </bsdf>
    </bsdf>

    <emitter type="constant"><rgb name="radiance" value="0.16, 0.18, 0.22"/></emitter>

)";

constexpr Backdrop kTable{2.6, 2.2, 1.7, 2.6, 0.7};

}  // namespace

void write_bowl(const std::filesystem::path& folder, const ProceduralOptions& options) {
    const BowlTextures textures = make_bowl_textures(options.texture_size, options.seed);
    write_image(folder / "textures/bowl_anisotropic.png", textures.anisotropic, false);
    write_image(folder / "textures/bowl_base_color.png", textures.base_color);
    write_image(folder / "textures/stone.png", make_stone_texture(1024, options.seed));
    write_bytes(folder / "meshes/bowl.ply", ply_bytes(make_bowl()));
    write_bytes(folder / "meshes/ring.ply", ply_bytes(make_ring_light()));
    write_bytes(folder / "meshes/table.ply", ply_bytes(make_backdrop(kTable)));
    const View view{{0.25, 2.05, 2.25}, {0, 0.14, 0}, 36};
    write_bytes(folder / "scene.xml",
                scene_head("bowl", "mat-bowl's anisotropic", view) + kBowlMaterials +
                    ply_shape("bowl", "mat-bowl") + ply_shape("table", "mat-stone") +
                    lamp("ring", {-0.55, 1.75, -0.25}, 0.8, {29.0f, 26.0f, 22.0f}) + "</scene>\n");
}

}  // namespace burnish::procedural
