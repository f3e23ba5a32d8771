// The cameras and images of a COLMAP reconstruction, as its files hold them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "burnish/view.h"

namespace burnish {

struct ColmapCamera {
    std::uint32_t id = 0;
    Camera camera;  ///< without its place in the world
};

struct ColmapImage {
    std::string place;                        ///< for messages: "images.txt:5"
    std::array<double, 4> world_to_camera{};  ///< quaternion w x y z
    std::array<double, 3> translation{};      ///< of the same
    std::uint32_t camera = 0;                 ///< id
    std::string name;
};

/// Each throws InputError: file and line, or file and byte, what was found and what was expected.
std::vector<ColmapCamera> read_cameras_text(const std::string& file);
std::vector<ColmapImage> read_images_text(const std::string& file);
std::vector<ColmapCamera> read_cameras_binary(const std::string& file);
std::vector<ColmapImage> read_images_binary(const std::string& file);

/// A side of a picture. Throws InputError with the place and what was found there where it is none:
/// see is_side.
int colmap_side(const std::string& place, const std::string& found, double pixels);

}  // namespace burnish
