// COLMAP's camera models: names, ids and the order of their parameters.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "burnish/view.h"

namespace burnish {

/// Its parameters: focal lengths, principal point (two numbers), coefficients of the lens.
struct CameraModel {
    const char* name;
    int id;  ///< in COLMAP's binary files
    LensKind lens;
    std::size_t focals;        ///< 1: of both axes; or 2: x, y
    std::size_t coefficients;  ///< the first ones of the lens; the others are 0
};

/// Those that can be read: "SIMPLE_PINHOLE, PINHOLE, ..."
std::string camera_model_names();

/// nullptr: none that can be read.
const CameraModel* find_camera_model(const std::string& name);
const CameraModel* find_camera_model(int id);
/// As COLMAP names it, also where it cannot be read; the number of one that is not known.
std::string camera_model_name(int id);

/// The model that has every focal length and coefficient of such a lens.
const CameraModel& general_model(LensKind lens);

std::size_t parameter_count(const CameraModel& model);
/// Throws InputError with the place of the parameters: a focal length that is not above 0, or a
/// number that is not finite.
void require_camera(const CameraModel& model, std::span<const double> parameters,
                    const std::string& place);
/// Where the camera is, is left open. parameters: parameter_count(model) numbers.
Camera make_camera(const CameraModel& model, int width, int height,
                   std::span<const double> parameters);
/// Of a camera with the lens of a general model: what make_camera makes it from.
std::vector<double> parameters_of(const CameraModel& model, const Camera& camera);

}  // namespace burnish
