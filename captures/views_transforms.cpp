// A value of a frame counts before that of the whole file. Keys that are not known are left alone:
// every program adds some.
#include "captures/views_transforms.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "burnish/error.h"
#include "captures/camera_model.h"
#include "captures/json_value.h"
#include "image/image.h"

namespace burnish {

namespace {

struct Frame {
    const Value& frame;
    const Value& file;

    std::optional<Value> find(const char* name) const {
        if (has(frame, name)) return member(frame, name);
        if (has(file, name)) return member(file, name);
        return {};
    }
    std::optional<double> find_number(const char* name) const {
        const auto found = find(name);
        if (!found) return {};
        return number(*found);
    }
};

/// A file that the frame names, within the folder of pictures.
std::string picture_at(const Value& path, const std::string& folder) {
    const std::string file = path_within(folder, text(path));
    if (file.empty()) fail(path, "a path within the folder of the pictures");
    return file;
}

/// Of the formats that are read.
constexpr const char* kExtensions[] = {".png", ".PNG", ".jpg", ".JPG", ".jpeg", ".JPEG",
                                       ".exr", ".EXR", ".hdr", ".HDR", ".pfm",  ".PFM",
                                       ".bmp", ".BMP", ".tga", ".TGA"};

bool names_format(const std::string& file) {
    const std::string extension = std::filesystem::path(file).extension().string();
    return std::find(std::begin(kExtensions), std::end(kExtensions), extension) !=
           std::end(kExtensions);
}

/// With its extension, where the path has none.
std::string with_extension(const Value& path, const std::string& file) {
    std::error_code ignored;  // reading the file says why
    const std::filesystem::file_type type = std::filesystem::status(file, ignored).type();
    if (type == std::filesystem::file_type::regular) return file;
    std::vector<std::string> found;
    for (const char* extension : kExtensions) {
        const std::string name = file + extension;
        if (!std::filesystem::is_regular_file(name, ignored)) continue;
        // a.png and a.PNG are one file where a file system ignores case.
        if (std::none_of(found.begin(), found.end(), [&](const std::string& other) {
                return std::filesystem::equivalent(name, other, ignored);
            }))
            found.push_back(name);
    }
    if (found.size() > 1)
        fail(path, fmt::format("one picture; there are {} and {}", found[0], found[1]));
    if (found.empty() && type == std::filesystem::file_type::not_found && !names_format(file))
        fail(path, fmt::format("a picture; there is no {}, nor one with .png, .jpg or another "
                               "extension that is read",
                               file));
    return found.empty() ? file : found.front();
}

double focal_of_length(const Value& length, int) {
    const double focal = number(length);
    if (focal <= 0) fail(length, "a focal length above 0, in pixels");
    return focal;
}

/// Of an angle of view over so many pixels.
double focal_of_angle(const Value& angle, int pixels) {
    const double radians = number(angle);
    if (!(radians > 0 && radians < std::numbers::pi)) fail(angle, "radians, above 0 and below pi");
    return 0.5 * pixels / std::tan(0.5 * radians);
}

/// A way to say focal lengths; one key counts for both axes.
struct FocalKeys {
    const char *x, *y;
    double (*focal)(const Value& value, int pixels);
};

/// What the frame says counts before what the file says, and lengths before angles beside them.
void set_focal_lengths(const Frame& frame, Camera& camera) {
    constexpr FocalKeys kWays[] = {{"fl_x", "fl_y", focal_of_length},
                                   {"camera_angle_x", "camera_angle_y", focal_of_angle}};
    for (const Value* keys : {&frame.frame, &frame.file})
        for (const FocalKeys& way : kWays) {
            if (!has(*keys, way.x) && !has(*keys, way.y)) continue;
            const auto x = frame.find(way.x), y = frame.find(way.y);
            camera.focal_x = x ? way.focal(*x, camera.width) : way.focal(*y, camera.height);
            camera.focal_y = y ? way.focal(*y, camera.height) : camera.focal_x;
            return;
        }
    throw InputError(
        fmt::format("{}: {}: expected the key \"fl_x\" or \"camera_angle_x\", of "
                    "the frame or of the file",
                    frame.frame.file, frame.frame.key));
}

bool is_fisheye(const Frame& frame) {
    if (const auto flag = frame.find("is_fisheye")) {
        if (!flag->value.is_boolean()) fail(*flag, "true or false");
        if (flag->value == true) return true;
    }
    const auto model = frame.find("camera_model");
    if (!model) return false;
    const std::string name = text(*model);
    const std::string kKnown[] = {"PINHOLE", "SIMPLE_PINHOLE", "SIMPLE_RADIAL",
                                  "RADIAL",  "OPENCV",         "OPENCV_FISHEYE"};
    if (std::find(std::begin(kKnown), std::end(kKnown), name) == std::end(kKnown))
        fail(*model, "PINHOLE, SIMPLE_PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV or OPENCV_FISHEYE");
    return name == "OPENCV_FISHEYE";
}

/// Refuses what means a camera that is not read, or cuts a part out of the picture.
void refuse_other_cameras(const Frame& frame) {
    constexpr const char* kAround =
        "pictures of pinhole or fisheye cameras: a panorama around the camera is not read";
    constexpr std::pair<const char*, const char*> kRefused[] = {
        {"latlong", kAround},
        {"equirectangular", kAround},
        {"orthographic", "pictures of pinhole or fisheye cameras: parallel rays are not read"},
        {"ftheta_p0", "k1 to k4 of OPENCV_FISHEYE in the place of ftheta_p0 to ftheta_p4"},
        {"fisheye_crop_radius",
         "a mask_path in the place of this key, black outside of its circle"}};
    for (const auto& [key, expected] : kRefused) {
        const auto found = frame.find(key);
        if (found && !found->value.is_null() && found->value != false) fail(*found, expected);
    }
}

/// A coefficient of the lens, which may stand in an array of nerfstudio's.
std::optional<Value> find_coefficient(const Frame& frame, const char* name) {
    const std::string_view kOrder[] = {"k1", "k2", "k3", "k4", "p1", "p2"};
    const auto at =
        static_cast<std::size_t>(std::find(std::begin(kOrder), std::end(kOrder), name) - kOrder);
    for (const Value* keys : {&frame.frame, &frame.file}) {
        if (at < std::size(kOrder) && has(*keys, "distortion_params")) {
            const Value all = member(*keys, "distortion_params");
            if (!all.value.is_array() || all.value.size() != std::size(kOrder))
                fail(all, fmt::format("an array of {}", fmt::join(kOrder, ", ")));
            return element(all, at);
        }
        if (has(*keys, name)) return member(*keys, name);
    }
    return {};
}

/// k1 k2 k3 k4 of a fisheye, k1 k2 p1 p2 k3 of other lenses; 0 where the file gives none.
Lens lens_of(const Frame& frame) {
    const auto value = [&](const char* name) {
        const auto found = find_coefficient(frame, name);
        return found ? number(*found) : 0;
    };
    const auto require_zero = [&](std::initializer_list<const char*> names, const char* of) {
        for (const char* name : names)
            if (value(name) != 0) fail(*find_coefficient(frame, name), fmt::format("0 of {}", of));
    };
    require_zero({"k5", "k6"}, "any lens");
    Lens lens;
    if (is_fisheye(frame)) {
        require_zero({"p1", "p2"}, "OPENCV_FISHEYE");
        lens.kind = LensKind::kFisheye;
        lens.coefficients = {value("k1"), value("k2"), value("k3"), value("k4")};
        return lens;
    }
    require_zero({"k4"}, "a lens that is not OPENCV_FISHEYE");
    lens.coefficients = {value("k1"), value("k2"), value("p1"), value("p2"), value("k3")};
    if (lens != Lens{}) lens.kind = LensKind::kBrownConrady;
    return lens;
}

/// Of a frame's picture.
struct Size {
    int width = 0, height = 0;
    std::string of;  ///< the picture that has it; empty: the file says it
};

/// As the file has it; else as that of the first picture that was looked at, since those of one
/// camera are equally large: as it is stored, before it is turned, as programs that find cameras
/// see it.
Size size_of(const Frame& frame, const std::string& picture, Size& known) {
    const auto width = frame.find("w"), height = frame.find("h");
    if (width && height) return {side(*width), side(*height), {}};
    if (width || height)
        throw InputError(fmt::format("{}: {}: expected both \"w\" and \"h\", or none of them",
                                     frame.frame.file, frame.frame.key));
    if (known.width == 0) {
        const Image image = read_image_header(picture).image;
        known = {image.width, image.height, picture};
    }
    return known;
}

/// "train/r_0" of "./train/r_0".
std::string name_of_path(const std::string& path) {
    return std::filesystem::path(path).lexically_normal().generic_string();
}

/// Each frame's name, once. Not empty.
std::vector<std::string> names_of(const Value& frames) {
    std::vector<std::string> names;
    std::set<std::string> known;
    for (std::size_t i = 0; i < frames.value.size(); ++i) {
        const Value frame = element(frames, i);
        if (!frame.value.is_object()) fail(frame, "an object");
        require_member(frame, "file_path");
        names.push_back(name_of_path(text(member(frame, "file_path"))));
        if (!known.insert(names.back()).second)
            throw InputError(fmt::format("{}: {}: there is another frame \"{}\"", frame.file,
                                         frame.key, names.back()));
    }
    return names;
}

enum class Use { kFitted, kHeldOut, kLeftOut };

/// Calls body(entry, use) for each path of a list of the file, which must be that of a frame. use:
/// of that frame. first: the first frame's name.
template <class Body>
void for_listed(const Value& file, const char* name, const std::string& first,
                std::map<std::string, Use>& uses, const Body& body) {
    if (!has(file, name)) return;
    const Value list = member(file, name);
    if (!list.value.is_array()) fail(list, "an array of paths");
    for (std::size_t i = 0; i < list.value.size(); ++i) {
        const Value entry = element(list, i);
        const auto frame = uses.find(name_of_path(text(entry)));
        if (frame == uses.end())
            fail(entry, fmt::format("the file_path of a frame, as \"{}\"", first));
        body(entry, frame->second);
    }
}

/// What the lists of the file make of its frames, as in nerfstudio: where there are frames for
/// training, those in no list are left out.
std::map<std::string, Use> uses_of(const Value& file, const std::vector<std::string>& frames) {
    const char* const kFitted = "train_filenames";
    const Use others = has(file, kFitted) ? Use::kLeftOut : Use::kFitted;
    std::map<std::string, Use> uses;
    for (const std::string& name : frames) uses[name] = others;
    for_listed(file, kFitted, frames[0], uses, [](const Value&, Use& use) { use = Use::kFitted; });
    for (const char* held_out : {"test_filenames", "val_filenames"})
        for_listed(file, held_out, frames[0], uses, [&](const Value& entry, Use& use) {
            if (has(file, kFitted) && use == Use::kFitted)
                fail(entry, fmt::format("a frame that is not in {}", kFitted));
            use = Use::kHeldOut;
        });
    if (std::all_of(uses.begin(), uses.end(),
                    [](const auto& use) { return use.second == Use::kLeftOut; }))
        fail(member(file, kFitted), "a path or more");
    return uses;
}

CapturedView view_of(const Frame& frame, const std::string& folder, Size& known) {
    const Value path = member(frame.frame, "file_path");
    refuse_other_cameras(frame);
    CapturedView captured;
    captured.turning = Turning::kAsStored;
    captured.image = with_extension(path, picture_at(path, folder));
    const std::string place = place_of(frame.frame);
    captured.places = {place, place_of(path), "", place, ""};
    if (const auto mask = frame.find("mask_path")) {
        captured.mask = picture_at(*mask, folder);
        captured.places.mask = place_of(*mask);
    }
    captured.view.name = name_of_path(text(path));
    Camera camera;
    const Size size = size_of(frame, captured.image, known);
    captured.size_of = size.of;
    camera.width = size.width, camera.height = size.height;
    set_focal_lengths(frame, camera);
    camera.center_x = frame.find_number("cx").value_or(0.5 * camera.width);
    camera.center_y = frame.find_number("cy").value_or(0.5 * camera.height);
    camera.lens = lens_of(frame);
    require_member(frame.frame, "transform_matrix");
    camera.camera_to_world = camera_to_world(member(frame.frame, "transform_matrix"), {1, -1, -1});
    captured.view.camera = camera;
    return captured;
}

}  // namespace

std::vector<CapturedView> read_transforms(const std::string& file, const std::string& images) {
    const nlohmann::json document = parse_json(file, "a transforms.json");
    const Value root{document, file, ""};
    if (!document.is_object()) fail(root, "an object");
    require_member(root, "frames");
    const Value frames = member(root, "frames");
    if (!frames.value.is_array() || frames.value.empty()) fail(frames, "an array of frames");
    const std::string folder =
        images.empty() ? std::filesystem::path(file).parent_path().string() : images;
    const std::vector<std::string> names = names_of(frames);
    const std::map<std::string, Use> uses = uses_of(root, names);
    std::vector<CapturedView> views;
    Size known;
    for (std::size_t i = 0; i < frames.value.size(); ++i) {
        const Use use = uses.at(names[i]);
        if (use == Use::kLeftOut) continue;
        views.push_back(view_of({element(frames, i), root}, folder, known));
        views.back().view.held_out = use == Use::kHeldOut;
    }
    return views;
}

}  // namespace burnish
