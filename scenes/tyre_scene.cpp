// The tyre's lights, camera and materials: the scene file.
#include "image/files.h"
#include "scenes/scene_files.h"
#include "scenes/scene_xml.h"
#include "scenes/tyre.h"

namespace burnish::procedural {

namespace {

constexpr const char* kTyreMaterials = R"(
    <bsdf type="twosided" id="mat-tyre">
        <bsdf type="principled">
            <texture type="bitmap" name="base_color">
                <string name="filename" value="textures/tyre_base_color.png"/>
            </texture>
            <texture type="bitmap" name="roughness">
                <string name="filename" value="textures/tyre_roughness.png"/>
                <string name="filter_type" value="nearest"/>
                <boolean name="raw" value="true"/>
            </texture>
            <float name="specular" value="0.9"/>
        </bsdf>
    </bsdf>
    <bsdf type="twosided" id="mat-wheel">
        <bsdf type="principled">
            <rgb name="base_color" value="0.75, 0.76, 0.78"/>
            <float name="roughness" value="0.42"/>
            <float name="metallic" value="0.85"/>
        </bsdf>
    </bsdf>
    <bsdf type="twosided" id="mat-workshop">
        <bsdf type="diffuse">
            <texture type="bitmap" name="reflectance">
                <string name="filename" value="textures/workshop.png"/>
            </texture>
        </bsdf>
    </bsdf>

    <emitter type="envmap">
        <string name="filename" value="textures/sky.exr"/>
    </emitter>

)";

/// The tyre stands on its tread and turns its upper side to the camera.
constexpr const char* kStanding =
    "<rotate x=\"1\" angle=\"90\"/><rotate z=\"1\" angle=\"17\"/><rotate y=\"1\" angle=\"38\"/>"
    "<translate y=\"0.995\"/>";

constexpr Backdrop kWorkshop{4.5, 3.5, 2.6, 3.6, 0.4};

std::string soft_boxes() {
    return panel_light({{-2.9, 2.9, 2.2}, {0, 0.8, 0}, 0.75, 0.55}, {13.0f, 11.4f, 9.4f}) +
           panel_light({{3.0, 1.5, 1.6}, {0, 0.9, 0}, 0.22, 1.0}, {9.0f, 10.4f, 12.0f}) +
           panel_light({{0.4, 3.6, -1.2}, {0, 0.9, 0}, 1.1, 0.30}, {12.0f, 12.0f, 12.0f}) +
           panel_light({{-0.4, 0.55, 4.6}, {0, 0.8, 0}, 0.9, 0.16}, {7.0f, 6.2f, 5.4f});
}

}  // namespace

void write_tyre(const std::filesystem::path& folder, const ProceduralOptions& options) {
    const TyreTextures textures = make_tyre_textures(options.texture_size, options.seed);
    write_image(folder / "textures/tyre_roughness.png", textures.roughness, false);
    write_image(folder / "textures/tyre_base_color.png", textures.base_color);
    write_image(folder / "textures/workshop.png",
                make_workshop_texture(1024, backdrop_floor_end(kWorkshop), options.seed));
    write_image(folder / "textures/sky.exr", make_dim_sky(64, options.seed));
    write_bytes(folder / "meshes/tyre.ply", ply_bytes(make_tyre()));
    write_bytes(folder / "meshes/wheel.ply", ply_bytes(make_wheel()));
    write_bytes(folder / "meshes/workshop.ply", ply_bytes(make_backdrop(kWorkshop)));
    const View view{{0.1, 1.45, 4.6}, {0.0, 0.93, 0}, 30};
    write_bytes(folder / "scene.xml",
                scene_head("tyre", "mat-tyre's roughness", view) + kTyreMaterials +
                    ply_shape("tyre", "mat-tyre", kStanding) +
                    ply_shape("wheel", "mat-wheel", kStanding) +
                    ply_shape("workshop", "mat-workshop") + soft_boxes() + "</scene>\n");
}

}  // namespace burnish::procedural
