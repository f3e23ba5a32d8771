#include "captures/camera_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "burnish/error.h"
#include "core/joined.h"

namespace burnish {

namespace {

/// Those that can be read. To add one: here, or where it needs another kind of lens, start at
/// LensKind in burnish/view.h.
constexpr CameraModel kModels[] = {
    {"SIMPLE_PINHOLE", 0, LensKind::kPinhole, 1, 0},
    {"PINHOLE", 1, LensKind::kPinhole, 2, 0},
    {"SIMPLE_RADIAL", 2, LensKind::kBrownConrady, 1, 1},
    {"RADIAL", 3, LensKind::kBrownConrady, 1, 2},
    {"OPENCV", 4, LensKind::kBrownConrady, 2, 4},
    {"FULL_OPENCV", 6, LensKind::kBrownConrady, 2, 8},
    {"OPENCV_FISHEYE", 5, LensKind::kFisheye, 2, 4},
    {"SIMPLE_RADIAL_FISHEYE", 8, LensKind::kFisheye, 1, 1},
    {"RADIAL_FISHEYE", 9, LensKind::kFisheye, 1, 2},
    {"SIMPLE_FISHEYE", 14, LensKind::kFisheye, 1, 0},
    {"FISHEYE", 15, LensKind::kFisheye, 2, 0},
};

/// Those of COLMAP that are not read.
constexpr std::pair<int, const char*> kOthers[] = {
    {7, "FOV"},
    {10, "THIN_PRISM_FISHEYE"},
    {11, "RAD_TAN_THIN_PRISM_FISHEYE"},
    {12, "SIMPLE_DIVISION"},
    {13, "DIVISION"},
    {16, "EUCM"},
    {17, "EQUIRECTANGULAR"},
};

template <class Predicate>
const CameraModel* find_model(const Predicate& is_wanted) {
    const auto found = std::find_if(std::begin(kModels), std::end(kModels), is_wanted);
    return found == std::end(kModels) ? nullptr : found;
}

}  // namespace

std::string camera_model_names() { return joined(kModels, &CameraModel::name); }

const CameraModel* find_camera_model(const std::string& name) {
    return find_model([&](const CameraModel& m) { return name == m.name; });
}

const CameraModel* find_camera_model(int id) {
    return find_model([&](const CameraModel& m) { return id == m.id; });
}

std::string camera_model_name(int id) {
    if (const CameraModel* model = find_camera_model(id)) return model->name;
    for (const auto& other : kOthers)
        if (other.first == id) return other.second;
    return std::to_string(id);
}

const CameraModel& general_model(LensKind lens) {
    const auto parameters = [&](const CameraModel& m) {
        return m.lens == lens ? parameter_count(m) : 0;
    };
    return *std::ranges::max_element(kModels, {}, parameters);
}

std::size_t parameter_count(const CameraModel& model) {
    return model.focals + 2 + model.coefficients;
}

void require_camera(const CameraModel& model, std::span<const double> parameters,
                    const std::string& place) {
    for (std::size_t i = 0; i < parameters.size(); ++i) {
        const double found = parameters[i];
        if (i < model.focals ? found > 0 && std::isfinite(found) : std::isfinite(found)) continue;
        throw InputError(fmt::format(
            "{}: found the parameter {:g} of {}, expected {}", place, found, model.name,
            i < model.focals ? "a focal length above 0, in pixels" : "a finite number"));
    }
}

Camera make_camera(const CameraModel& model, int width, int height,
                   std::span<const double> parameters) {
    Camera camera;
    camera.width = width, camera.height = height;
    camera.focal_x = parameters[0], camera.focal_y = parameters[model.focals - 1];
    camera.center_x = parameters[model.focals], camera.center_y = parameters[model.focals + 1];
    camera.lens.kind = model.lens;
    std::copy_n(parameters.begin() + static_cast<std::ptrdiff_t>(model.focals) + 2,
                model.coefficients, camera.lens.coefficients.begin());
    return camera;
}

std::vector<double> parameters_of(const CameraModel& model, const Camera& camera) {
    std::vector<double> parameters{camera.focal_x, camera.focal_y, camera.center_x,
                                   camera.center_y};
    const auto first = camera.lens.coefficients.begin();
    parameters.insert(parameters.end(), first,
                      first + static_cast<std::ptrdiff_t>(model.coefficients));
    return parameters;
}

}  // namespace burnish
