#include "captures/capture.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>

#include "burnish/error.h"
#include "captures/camera_model.h"
#include "captures/json_value.h"
#include "core/at_place.h"
#include "core/positive_float.h"
#include "core/transform.h"
#include "image/files.h"
#include "image/image.h"
#include "image/texels.h"
#include "image/whole.h"

namespace burnish {

namespace {

using nlohmann::json;

/// The axes of a convention's camera in those of x right, y down, z forward: their signs.
std::array<double, 3> axes(const Value& camera) {
    if (!has(camera, "convention")) return {1, 1, 1};
    const Value v = member(camera, "convention");
    const std::string name = text(v);
    if (name == "opencv") return {1, 1, 1};
    if (name == "opengl") return {1, -1, -1};
    if (name == "mitsuba") return {-1, -1, 1};
    fail(v, "\"opencv\", \"opengl\" or \"mitsuba\"");
}

Camera camera_with_model(const Value& v) {
    check_object(v, {"model", "width", "height", "params", "camera_to_world", "convention"});
    for (const char* name : {"model", "width", "height", "params", "camera_to_world"})
        require_member(v, name);
    const CameraModel* model = find_camera_model(text(member(v, "model")));
    if (!model) fail(member(v, "model"), "one of " + camera_model_names());
    const Value params = member(v, "params");
    Camera camera = make_camera(*model, side(member(v, "width")), side(member(v, "height")),
                                numbers(params, parameter_count(*model)));
    for (std::size_t i = 0; i < model->focals; ++i)
        if (number(element(params, i)) <= 0)
            fail(element(params, i), "a focal length above 0, in pixels");
    camera.camera_to_world = camera_to_world(member(v, "camera_to_world"), axes(v));
    return camera;
}

ViewCamera camera_of(const Value& v) {
    if (v.value.is_object() && has(v, "sensor")) {
        check_object(v, {"sensor"});
        const Value sensor = member(v, "sensor");
        if (sensor.value.is_number_unsigned()) return Sensor{sensor.value.dump()};
        if (!sensor.value.is_string()) fail(sensor, "the id of a sensor, or its number from 0");
        return Sensor{text(sensor)};
    }
    return camera_with_model(v);
}

/// A sky as an `envmap` of the scene has it, but what is not finite is refused, and nothing is said
/// of texels that become black.
SharedImage read_sky(const std::string& file) {
    Image sky = read_image(file);
    require_finite(sky, file);
    sky = with_channels(padded_to(std::move(sky), 2, 2), 3);
    drop_negative(sky);
    return share(std::move(sky));
}

using Skies = std::map<std::string, SharedImage>;  ///< by file

/// The sky of a file. Files with equal ones, as copies of one, share it.
SharedImage sky_of(const std::string& file, Skies& skies) {
    if (const auto read = skies.find(file); read != skies.end()) return read->second;
    SharedImage sky = read_sky(file);
    for (const auto& [other, known] : skies)
        if (*known == *sky) return skies[file] = known;
    return skies[file] = sky;
}

double scale_of(const Value& v) {
    const double scale = number(v);
    if (!(scale >= 0 && scale <= std::numeric_limits<float>::max()))
        fail(v, "a number from 0 to 3.4e38");
    return scale;
}

/// Its translation counts nothing: skies are infinitely far away.
Matrix rotation(const Value& v) {
    const Matrix m = matrix(v);
    if (!is_rigid(Transform{m})) fail(v, "a rotation that does not scale, shear or mirror");
    return m;
}

Environment environment_of(const Value& v, Skies& skies) {
    check_object(v, {"file", "scale", "to_world"});
    Environment environment;
    if (has(v, "file")) {
        const Value named = member(v, "file");
        const std::string file = file_of(named);
        environment.image = at_place(place_of(named), [&] { return sky_of(file, skies); });
    }
    if (has(v, "scale")) environment.scale = scale_of(member(v, "scale"));
    if (has(v, "to_world")) environment.to_world = rotation(member(v, "to_world"));
    return environment;
}

std::vector<std::string> texts(const Value& v) {
    if (!v.value.is_array()) fail(v, "an array of texts");
    std::vector<std::string> all;
    for (std::size_t i = 0; i < v.value.size(); ++i) all.push_back(text(element(v, i)));
    return all;
}

float factor_of(const Value& v) {
    const auto factor = static_cast<float>(number(v));
    if (!is_positive_float(double{factor})) fail(v, kPositiveFloat);
    return factor;
}

Exposure exposure_of(const Value& v) {
    if (v.value == "fit") return FitExposure{};
    if (v.value == "fit_rgb") return FitExposure{true};
    if (v.value.is_number()) {
        const float e = factor_of(v);
        return ExposureFactors{e, e, e};
    }
    if (!v.value.is_array()) fail(v, "a number, three numbers, \"fit\" or \"fit_rgb\"");
    (void)numbers(v, 3);
    return ExposureFactors{factor_of(element(v, 0)), factor_of(element(v, 1)),
                           factor_of(element(v, 2))};
}

bool is_held_out(const Value& v) {
    if (v.value == "train" || v.value == "test") return v.value == "test";
    fail(v, "\"train\" or \"test\"");
}

Encoding encoding_of(const Value& v) {
    if (v.value == "linear") return LinearEncoding{};
    if (v.value == "srgb") return SrgbEncoding{};
    if (!v.value.is_object()) fail(v, "\"linear\", \"srgb\" or {\"gamma\": 2.2}");
    check_object(v, {"gamma"});
    require_member(v, "gamma");
    const double gamma = number(member(v, "gamma"));
    if (!(gamma > 0 && gamma <= 10)) fail(member(v, "gamma"), "a number above 0, at most 10");
    return GammaEncoding{gamma};
}

Turning turning_of(const Value& v) {
    if (v.value == "exif") return Turning::kUpright;
    if (v.value == "stored") return Turning::kAsStored;
    fail(v, "\"exif\" or \"stored\"");
}

ViewPlaces places_of(const Value& v) {
    const std::string view = place_of(v);
    return {view, view + ".image", view + ".mask", view + ".camera", view + ".emitters"};
}

CapturedView view_of(const Value& v, std::size_t number, Skies& skies) {
    check_object(v, {"name", "image", "encoding", "orientation", "mask", "exposure", "emitters",
                     "environment", "camera", "split"});
    require_member(v, "camera");
    CapturedView captured;
    captured.places = places_of(v);
    View& view = captured.view;
    view.name = has(v, "name") ? text(member(v, "name")) : fmt::format("view_{:03}", number);
    if (has(v, "image")) captured.image = file_of(member(v, "image"));
    if (has(v, "encoding")) captured.encoding = encoding_of(member(v, "encoding"));
    if (has(v, "encoding") && captured.image.empty())
        fail(member(v, "encoding"), "an image that it is the encoding of");
    if (has(v, "orientation")) captured.turning = turning_of(member(v, "orientation"));
    if (has(v, "mask")) captured.mask = file_of(member(v, "mask"));
    if (has(v, "orientation") && captured.image.empty() && captured.mask.empty())
        fail(member(v, "orientation"), "an image or a mask that it is the orientation of");
    if (has(v, "exposure")) view.exposure = exposure_of(member(v, "exposure"));
    if (has(v, "emitters")) view.lighting.emitters = texts(member(v, "emitters"));
    if (has(v, "environment"))
        view.lighting.environment = environment_of(member(v, "environment"), skies);
    view.camera = camera_of(member(v, "camera"));
    if (has(v, "split")) view.held_out = is_held_out(member(v, "split"));
    return captured;
}

/// As a text of the scene file.
std::string definition_of(const Value& v) {
    if (v.value.is_null() || v.value.is_structured()) fail(v, "a text, a number, true or false");
    if (v.value.is_number_float()) {  // some programs write all numbers so, and 3.0 is no integer
        const double number = v.value.get<double>();
        constexpr double kExact = 0x1p53;
        if (number == std::floor(number) && std::abs(number) < kExact)
            return fmt::format("{}", static_cast<std::int64_t>(number));
    }
    return v.value.is_string() ? text(v) : v.value.dump();
}

}  // namespace

bool is_capture(const std::filesystem::path& file) { return lower_extension(file) == ".json"; }

Capture read_capture(const std::string& file) {
    const json document = parse_json(file, "a capture");
    const Value root{document, file, ""};
    if (document.is_object() && document.contains("frames") && !document.contains("scene"))
        throw InputError(fmt::format(
            "{0}: found a transforms.json, which names no scene: expected SCENE.xml --views {0}",
            file));
    check_object(root, {"version", "scene", "defines", "views"});
    for (const char* name : {"version", "scene", "views"}) require_member(root, name);
    if (document["version"] != 1) fail(member(root, "version"), "1");
    Capture capture;
    capture.scene = file_of(member(root, "scene"));
    if (has(root, "defines")) {
        const Value defines = member(root, "defines");
        if (!defines.value.is_object()) fail(defines, "an object of texts");
        for (const auto& [name, value] : defines.value.items())
            capture.definitions[name] = definition_of(member(defines, name));
    }
    const Value views = member(root, "views");
    if (!views.value.is_array() || views.value.empty())
        fail(views, "an array of at least one view");
    std::set<std::string> names;
    Skies skies;
    for (std::size_t i = 0; i < views.value.size(); ++i) {
        capture.views.push_back(view_of(element(views, i), i, skies));
        if (!names.insert(capture.views.back().view.name).second)
            throw InputError(fmt::format("{}: views[{}].name: there is another view \"{}\"", file,
                                         i, capture.views.back().view.name));
    }
    return capture;
}

std::optional<Capture> capture_at(const std::string& file) {
    if (!is_capture(file)) return {};
    return read_capture(file);
}

}  // namespace burnish
