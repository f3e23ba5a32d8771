#include "cli/new_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "burnish/error.h"
#include "cli/mesh_check.h"
#include "cli/mesh_file.h"
#include "cli/output_folder.h"
#include "core/positive_float.h"
#include "image/files.h"
#include "image/image.h"
#include "mitsuba/load.h"
#include "render/view.h"
#include "scenes/scene_files.h"
#include "scenes/scene_xml.h"
#include "shading/lens.h"
#include "texture/charts.h"

namespace burnish {

namespace {

namespace fs = std::filesystem;

constexpr const char* kOneSide = R"(<bsdf type="principled" id="mat-{}">)";
constexpr const char* kTwoSides = R"(<bsdf type="twosided" id="mat-{}"><bsdf type="principled">)";

constexpr const char* kRest =
    R"(
    {material}
        <texture type="bitmap" name="base_color">
            <string name="filename" value="textures/{name}_base_color.exr"/>
        </texture>
        <texture type="bitmap" name="roughness">
            <string name="filename" value="textures/{name}_roughness.exr"/>
            <boolean name="raw" value="true"/>
        </texture>
        <float name="metallic" value="0"/>
    {material_end}

{sky}
    <shape type="ply" id="{name}">
        <string name="filename" value="meshes/{name}.ply"/>
        <ref id="mat-{name}"/>
    </shape>
</scene>
)";

constexpr const char* kSky =
    R"(    <default name="sky_turn" value="0"/>
    <emitter type="envmap" id="sky">
        <string name="filename" value="environment/{}"/>
        <transform name="to_world"><rotate y="1" angle="$sky_turn"/>{}</transform>
    </emitter>
)";

constexpr const char* kEvenSky = R"(    <emitter type="constant" id="sky">
        <rgb name="radiance" value="1, 1, 1"/>
    </emitter>
)";

/// Of a file, of letters that need no quoting; no id that the scene has.
std::string plain_name(const fs::path& file) {
    std::string name;
    for (const char c : file.stem().string())
        name += std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' ? c : '_';
    if (name == "sky") return "sky_mesh";
    constexpr std::size_t kMax = 200;  // of the 255 bytes of a file system: endings follow
    return name.empty() ? "model" : name.substr(0, kMax);
}

std::string numbers_text(const Vec3<double>& v) {
    return fmt::format("{:.9g}, {:.9g}, {:.9g}", v.x, v.y, v.z);
}

fs::path sky_file(const NewScene& scene) { return "sky" + scene.environment.extension().string(); }

std::string sky_text(const NewScene& scene) {
    if (scene.environment.empty()) return kEvenSky;
    const char* raise = scene.up == UpAxis::kZ ? "<rotate x=\"1\" angle=\"90\"/>" : "";
    return fmt::format(kSky, sky_file(scene).string(), raise);
}

using procedural::SensorText;

double radius_of(const MeshCheck& check) { return 0.5 * length(to_double(check.box.size())); }

/// From the middle of the mesh's box.
double distance_of(const Camera& camera, const MeshCheck& check) {
    const Matrix& m = camera.camera_to_world;
    return length(to_double(check.box.center()) - Vec3<double>{m[3], m[7], m[11]});
}

/// Widens the clipping planes for a camera at a distance, not below the mesh's radius: the mesh is
/// not cut.
void fit_planes(SensorText& text, double distance) {
    text.near = std::min(text.near, 0.01 * distance);
    text.far = std::max(text.far, 4 * distance);
}

/// The first camera, with planes for all of them.
SensorText sensor_text(const std::vector<Camera>& cameras, const MeshCheck& check) {
    const Camera& camera = cameras.front();
    SensorText text;
    text.width = camera.width, text.height = camera.height;
    for (const Camera& c : cameras)
        fit_planes(text, std::max(distance_of(c, check), radius_of(check)));
    text.fov = 360 / std::numbers::pi * std::atan(0.5 * camera.width / camera.focal_x);
    text.offset_x = 0.5 - camera.center_x / camera.width;
    text.offset_y = 0.5 - camera.center_y / camera.height;
    std::string matrix;
    for (std::size_t i = 0; i < 16; ++i) {
        // Mitsuba's x points left, its y up.
        const bool turned = i < 12 && i % 4 < 2;
        matrix += fmt::format("{}{:.9g}", i == 0 ? "" : " ",
                              (turned ? -1 : 1) * camera.camera_to_world[i] + 0.0);
    }
    text.to_world = fmt::format("<matrix value=\"{}\"/>", matrix);
    return text;
}

/// From the front, a little from above.
SensorText sensor_text(UpAxis up, const MeshCheck& check) {
    constexpr double kMargin = 1.1;
    SensorText text;
    const bool y_up = up == UpAxis::kY;
    const Vec3<double> target = to_double(check.box.center());
    const double distance =
        kMargin * radius_of(check) / std::sin(text.fov * std::numbers::pi / 360);
    fit_planes(text, distance);
    const Vec3<double> towards =
        normalize(y_up ? Vec3<double>{0.35, 0.35, 1} : Vec3<double>{0.35, -1, 0.35});
    text.to_world = fmt::format("<lookat origin=\"{}\" target=\"{}\" up=\"{}\"/>",
                                numbers_text(target + towards * distance), numbers_text(target),
                                y_up ? "0, 1, 0" : "0, 0, 1");
    return text;
}

std::string scene_text(const NewScene& scene, const std::string& name, const MeshCheck& check,
                       bool two_sided) {
    const SensorText sensor =
        scene.cameras.empty() ? sensor_text(scene.up, check) : sensor_text(scene.cameras, check);
    return "<!-- Made by `burnish new`: change what is known of the material, the camera and the "
           "light. -->\n" +
           procedural::scene_top(sensor) +
           fmt::format(fmt::runtime(kRest), fmt::arg("name", name),
                       fmt::arg("sky", sky_text(scene)),
                       fmt::arg("material",
                                fmt::format(fmt::runtime(two_sided ? kTwoSides : kOneSide), name)),
                       fmt::arg("material_end", two_sided ? "</bsdf></bsdf>" : "</bsdf>"));
}

/// Whether a direction of the camera's axes lies in the field of its lens.
bool is_in_field(const FieldLens& lens, const Vec3<double>& direction) {
    const double aside = std::hypot(direction.x, direction.y);
    if (!sees_by_plane(lens.lens.kind)) return std::atan2(aside, direction.z) < lens.radius;
    return direction.z > 0 && aside / direction.z < lens.radius;
}

/// Whether the middle of the mesh's box lies in the picture. lens: the camera's.
bool looks_at(const Camera& camera, const FieldLens& lens, const MeshCheck& check) {
    const Matrix& m = camera.camera_to_world;
    const Vec3<double> d = to_double(check.box.center()) - Vec3<double>{m[3], m[7], m[11]};
    const Vec3<double> p{m[0] * d.x + m[4] * d.y + m[8] * d.z, m[1] * d.x + m[5] * d.y + m[9] * d.z,
                         m[2] * d.x + m[6] * d.y + m[10] * d.z};
    if (!is_in_field(lens, p)) return false;
    const Vec2<double> u = distort(camera.lens, p);
    const double x = camera.focal_x * u.x + camera.center_x,
                 y = camera.focal_y * u.y + camera.center_y;
    return x >= 0 && x <= camera.width && y >= 0 && y <= camera.height;
}

std::ptrdiff_t count_looking_at(const MeshCheck& check, const std::vector<Camera>& cameras) {
    FieldLens lens = with_field({}, 1);  // cameras that follow each other mostly share theirs
    return std::count_if(cameras.begin(), cameras.end(), [&](const Camera& camera) {
        if (!(camera.lens == lens.lens)) lens = with_field(camera.lens, 1);
        return looks_at(camera, lens, check);
    });
}

/// Whether it lies in the mesh's box.
bool is_inside(const Camera& camera, const MeshCheck& check) {
    const Matrix& m = camera.camera_to_world;
    const auto within = [](double x, float low, float high) {
        return x > double{low} && x < double{high};
    };
    return within(m[3], check.box.low.x, check.box.high.x) &&
           within(m[7], check.box.low.y, check.box.high.y) &&
           within(m[11], check.box.low.z, check.box.high.z);
}

bool sees_it_tiny(const Camera& camera, const MeshCheck& check) {
    constexpr double kShare = 0.02;
    return 2 * radius_of(check) * camera.focal_x <
           kShare * distance_of(camera, check) * camera.width;
}

bool has_square_pixels(const Camera& camera) {
    constexpr double kTolerance = 1e-3;  // 0.5 pixels at the border of a picture of 1000
    return std::abs(camera.focal_y / camera.focal_x - 1) <= kTolerance;
}

std::vector<std::string> complaints_of_cameras(const NewScene& scene, const MeshCheck& check) {
    const auto all = static_cast<std::ptrdiff_t>(scene.cameras.size());
    const auto count = [&](bool (*is)(const Camera&, const MeshCheck&)) {
        return std::count_if(scene.cameras.begin(), scene.cameras.end(),
                             [&](const Camera& c) { return is(c, check); });
    };
    std::vector<std::string> complaints;
    if (!scene.cameras.empty() && !has_square_pixels(scene.cameras.front()))
        complaints.push_back(fmt::format(
            "the first picture's focal lengths are {:.6g} and {:.6g} pixels: the scene's camera, "
            "whose pixels are square, has the first; optimize --views has both",
            scene.cameras.front().focal_x, scene.cameras.front().focal_y));
    if (const auto n = count_looking_at(check, scene.cameras); 2 * n < all)
        complaints.push_back(fmt::format(
            "the middle of the mesh lies in {} of {} pictures: do cameras and mesh have "
            "the same units and axes?",
            n, all));
    constexpr const char* kDo = "scale it to the units of the cameras and export it again";
    if (const auto n = count(is_inside); 2 * n > all)
        complaints.push_back(fmt::format(
            "{} of {} cameras lie within the box of the mesh: unless it is a room, it is too large "
            "for them; {}",
            n, all, kDo));
    if (const auto n = count(sees_it_tiny); 2 * n > all)
        complaints.push_back(fmt::format(
            "{} of {} cameras see the mesh smaller than 2 % of the picture's width: it is too "
            "small for them; {}",
            n, all, kDo));
    return complaints;
}

void write_files(const NewScene& scene, const std::string& name, const FoundMesh& file,
                 const MeshCheck& check, const fs::path& folder) {
    const int size = scene.texture_size;
    for (const char* part : {"meshes", "textures"}) make_folder(folder / part);
    write_bytes(folder / "meshes" / (name + ".ply"), procedural::ply_bytes(file.mesh));
    write_image(folder / "textures" / (name + "_base_color.exr"), make_image(size, size, 3, 0.5f));
    write_image(folder / "textures" / (name + "_roughness.exr"), make_image(size, size, 1, 0.5f));
    if (!scene.environment.empty()) {
        make_folder(folder / "environment");
        write_bytes(folder / "environment" / sky_file(scene), read_bytes(scene.environment));
    }
    write_bytes(folder / "scene.xml",
                scene_text(scene, name, check, !check.is_closed || file.is_double_sided));
}

/// Reads it, so that an error names the file itself and not the scene's copy.
void check_environment(const fs::path& file) {
    if (file.empty()) return;
    const std::string extension = lower_extension(file);
    if (extension != ".hdr" && extension != ".exr" && extension != ".pfm")
        throw InputError(
            fmt::format("{}: expected the sky as HDR, EXR or PFM, which hold how bright the sun is",
                        file.string()));
    read_image(file);
}

/// A text with the name of the folder where its files will lie.
std::string in_place(std::string text, const OutputFolder& output) {
    const std::string unfinished = output.unfinished.string(),
                      folder = (output.folder / "scene.xml").parent_path().string();
    for (std::size_t at = 0; (at = text.find(unfinished, at)) != std::string::npos;
         at += folder.size())
        text.replace(at, unfinished.size(), folder);
    return text;
}

/// Returns body(), whose errors name the files where they would lie.
template <class Body>
auto naming_in_place(const OutputFolder& output, const Body& body) {
    try {
        return body();
    } catch (const InputError& e) {
        throw InputError(in_place(e.what(), output));
    } catch (const OutputError& e) {
        throw OutputError(in_place(e.what(), output));
    }
}

std::size_t count_charts(const Scene& scene) {
    return std::ranges::max(texture_charts(scene, scene.parameters.front().texture));
}

}  // namespace

void require_scene_camera(const Camera& camera) {
    check_camera(camera);
    constexpr double kMaxOffset = 1000;  // of a sensor's principal point, from the middle
    if (!(std::abs(camera.center_x / camera.width - 0.5) <= kMaxOffset &&
          std::abs(camera.center_y / camera.height - 0.5) <= kMaxOffset))
        throw InputError(fmt::format(
            "the principal point is at ({:g}, {:g}) pixels, expected it within {:g} widths and "
            "heights of the picture's middle",
            camera.center_x, camera.center_y, kMaxOffset));
}

NewSceneReport write_new_scene(const NewScene& scene, const fs::path& folder) {
    OutputFolder output = open_output_folder(folder, Found::kEmpty);
    check_environment(scene.environment);
    FoundMesh file = read_mesh(scene.mesh);
    if (file.mesh.uvs.empty())
        throw InputError(fmt::format(
            "{}: found no texture coordinates, expected some for every vertex: unwrap the mesh (in "
            "Blender: Edit Mode, A, U, Smart UV Project) and export it again",
            scene.mesh.string()));
    const MeshCheck check = check_mesh(file.mesh, std::min(scene.texture_size, 1024));
    if (!is_positive_float(0.01 * radius_of(check)))  // as near as a clipping plane may be
        throw InputError(fmt::format(
            "{}: all vertices are at one place, or almost, expected a mesh of some size",
            scene.mesh.string()));
    const std::string name = plain_name(scene.mesh);
    const LoadedScene loaded = naming_in_place(output, [&] {
        write_files(scene, name, file, check, output.unfinished);
        return load_scene(output.unfinished / "scene.xml");
    });

    NewSceneReport report{"mat-" + name, check.triangles, count_charts(loaded.scene),
                          check.used_share, std::move(file.notes)};
    for (std::string& text : complaints(check)) report.warnings.push_back(std::move(text));
    report.camera_warnings = complaints_of_cameras(scene, check);
    for (const std::string& text : loaded.warnings)
        report.warnings.push_back(in_place(text, output));
    for (const std::string& text : loaded.notes) report.notes.push_back(in_place(text, output));
    move_scene_into_place(output);
    return report;
}

}  // namespace burnish
