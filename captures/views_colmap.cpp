#include "captures/views_colmap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "burnish/error.h"
#include "captures/colmap_model.h"
#include "captures/json_value.h"
#include "core/transform.h"

namespace burnish {

namespace {

struct Reconstruction {
    std::vector<ColmapCamera> cameras;
    std::vector<ColmapImage> images;
};

bool is_there(const std::filesystem::path& file) {
    std::error_code ignored;  // reading it says why
    return std::filesystem::exists(file, ignored);
}

bool holds_binary(const std::filesystem::path& folder) {
    return is_there(folder / "cameras.bin") && is_there(folder / "images.bin");
}
bool holds_text(const std::filesystem::path& folder) {
    return is_there(folder / "cameras.txt") && is_there(folder / "images.txt");
}

Reconstruction read_reconstruction(const std::filesystem::path& folder) {
    const auto file = [&](const char* name) { return (folder / name).string(); };
    if (holds_binary(folder))
        return {read_cameras_binary(file("cameras.bin")), read_images_binary(file("images.bin"))};
    return {read_cameras_text(file("cameras.txt")), read_images_text(file("images.txt"))};
}

/// The inverse of x -> R x + t, R of the quaternion.
Matrix camera_to_world(const ColmapImage& image) {
    const auto& q = image.world_to_camera;
    const auto& t = image.translation;
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(std::abs(length - 1) < 1e-3))
        throw InputError(
            fmt::format("{}: found a quaternion of length {:g}, expected 1", image.place, length));
    if (!std::isfinite(t[0] + t[1] + t[2]))
        throw InputError(
            fmt::format("{}: found the translation ({:g}, {:g}, {:g}), expected finite "
                        "numbers",
                        image.place, t[0], t[1], t[2]));
    return inverse(translation({t[0], t[1], t[2]}) *
                   rotation(q[0] / length, q[1] / length, q[2] / length, q[3] / length))
        .m;
}

std::map<std::uint32_t, Camera> by_id(const std::vector<ColmapCamera>& cameras,
                                      const std::string& folder) {
    std::map<std::uint32_t, Camera> by_id;
    for (const ColmapCamera& c : cameras)
        if (!by_id.emplace(c.id, c.camera).second)
            throw InputError(fmt::format("{}: there are two cameras {}", folder, c.id));
    return by_id;
}

CapturedView view_of_image(const ColmapImage& image, const std::map<std::uint32_t, Camera>& cameras,
                           const std::string& folder) {
    const auto camera = cameras.find(image.camera);
    if (camera == cameras.end())
        throw InputError(
            fmt::format("{}: found the camera {}, expected one of the {} that there "
                        "are",
                        image.place, image.camera, cameras.size()));
    CapturedView captured;
    captured.view.name = image.name, captured.turning = Turning::kAsStored;
    captured.image = path_within(folder, image.name);
    if (captured.image.empty())
        throw InputError(
            fmt::format("{}: found the name \"{}\", expected a path within the folder "
                        "of the images",
                        image.place, image.name));
    Camera placed = camera->second;
    placed.camera_to_world = camera_to_world(image);
    captured.view.camera = placed;
    return captured;
}

}  // namespace

void require_reconstruction(const std::string& folder) {
    const std::filesystem::path path = folder;
    if (holds_binary(path) || holds_text(path)) return;
    for (const char* name : {"transforms.json", "transforms_train.json"})
        if (is_there(path / name))
            throw InputError(fmt::format("{}: found the folder of a {}, expected the file: {}",
                                         folder, name, (path / name).string()));
    for (const char* name : {"0", "sparse", "sparse/0"})
        if (holds_binary(path / name) || holds_text(path / name))
            throw InputError(fmt::format("{}: found a COLMAP reconstruction in {}, expected {}",
                                         folder, name, (path / name).string()));
    throw InputError(fmt::format(
        "{}: expected cameras.bin and images.bin, or cameras.txt and images.txt", folder));
}

std::vector<CapturedView> read_colmap(const std::string& folder, const std::string& images) {
    require_reconstruction(folder);
    Reconstruction read = read_reconstruction(folder);
    const std::map<std::uint32_t, Camera> cameras = by_id(read.cameras, folder);
    if (read.images.empty())
        throw InputError(fmt::format("{}: found no image, expected at least one", folder));
    std::stable_sort(read.images.begin(), read.images.end(),
                     [](const ColmapImage& a, const ColmapImage& b) { return a.name < b.name; });
    std::vector<CapturedView> views;
    for (const ColmapImage& image : read.images) {
        if (!views.empty() && views.back().view.name == image.name)
            throw InputError(
                fmt::format("{}: there is another image \"{}\"", image.place, image.name));
        views.push_back(view_of_image(image, cameras, images));
    }
    return views;
}

}  // namespace burnish
