// COLMAP's binary files: numbers of fixed sizes, little end first, behind their count.
#include <fmt/format.h>

#include <bit>
#include <string_view>

#include "burnish/error.h"
#include "captures/camera_model.h"
#include "captures/colmap_model.h"
#include "core/bytes.h"
#include "image/files.h"

namespace burnish {

namespace {

/// The bytes of a file, from the first to the last.
class Bytes {
  public:
    explicit Bytes(const std::string& file) : file_(file), bytes_(read_bytes(file)) {}

    std::string place() const { return fmt::format("{}, byte {}", file_, at_); }

    template <class T>
    T take(const char* what) {
        const std::uint64_t bits = number_at(take_bytes(sizeof(T), what), 0, sizeof(T));
        if constexpr (sizeof(T) == 8)
            return std::bit_cast<T>(bits);
        else
            return static_cast<T>(bits);
    }

    /// A number of entries, each of which takes so many bytes at least.
    std::uint64_t take_count(std::uint64_t entry, const char* what) {
        const std::string where = place();
        const auto count = take<std::uint64_t>(what);
        if (count > rest() / entry)
            throw InputError(
                fmt::format("{}: found the {} {}, expected at most {} in the {} bytes "
                            "that follow",
                            where, what, count, rest() / entry, rest()));
        return count;
    }

    /// Up to a zero.
    std::string take_text(const char* what) {
        const std::size_t end = bytes_.find('\0', at_);
        if (end == std::string::npos)
            throw InputError(fmt::format("{}: expected {} that ends with a zero", place(), what));
        std::string text = bytes_.substr(at_, end - at_);
        at_ = end + 1;
        return text;
    }

    void skip(std::uint64_t count) { at_ += count; }
    std::size_t rest() const { return bytes_.size() - at_; }

    void expect_end() const {
        if (rest() > 0)
            throw InputError(
                fmt::format("{}: found {} more bytes, expected the end", place(), rest()));
    }

  private:
    std::string_view take_bytes(std::size_t count, const char* what) {
        if (count > rest())
            throw InputError(
                fmt::format("{}: the file ends too early, expected {}", place(), what));
        at_ += count;
        return std::string_view(bytes_).substr(at_ - count, count);
    }

    std::string file_, bytes_;
    std::size_t at_ = 0;
};

ColmapCamera take_camera(Bytes& bytes) {
    const std::string place = bytes.place();
    ColmapCamera read;
    read.id = bytes.take<std::uint32_t>("the id of a camera");
    const auto id = bytes.take<std::int32_t>("a camera model");
    const CameraModel* model = find_camera_model(id);
    if (!model)
        throw InputError(fmt::format("{}: found the camera model {}, expected one of {}", place,
                                     camera_model_name(id), camera_model_names()));
    std::array<int, 2> size{};
    for (int& s : size) {
        const auto pixels = bytes.take<std::uint64_t>("a side");
        s = colmap_side(place, std::to_string(pixels), static_cast<double>(pixels));
    }
    std::vector<double> parameters;
    for (std::size_t i = 0; i < parameter_count(*model); ++i)
        parameters.push_back(bytes.take<double>("a parameter of a camera"));
    require_camera(*model, parameters, place);
    read.camera = make_camera(*model, size[0], size[1], parameters);
    return read;
}

ColmapImage take_image(Bytes& bytes) {
    constexpr std::uint64_t kPoint = 24;  // bytes: x, y, id
    ColmapImage image;
    image.place = bytes.place();
    bytes.take<std::uint32_t>("the id of an image");
    for (double& q : image.world_to_camera) q = bytes.take<double>("a quaternion");
    for (double& t : image.translation) t = bytes.take<double>("a translation");
    image.camera = bytes.take<std::uint32_t>("the id of a camera");
    image.name = bytes.take_text("the name of an image");
    bytes.skip(kPoint * bytes.take_count(kPoint, "number of points"));
    return image;
}

/// A count, then as many items of at least so many bytes each, then the end.
template <class T>
std::vector<T> read_all(const std::string& file, std::uint64_t min, const char* what,
                        T (*take)(Bytes&)) {
    Bytes bytes(file);
    const std::uint64_t count = bytes.take_count(min, what);
    std::vector<T> items;
    for (std::uint64_t i = 0; i < count; ++i) items.push_back(take(bytes));
    bytes.expect_end();
    return items;
}

}  // namespace

std::vector<ColmapCamera> read_cameras_binary(const std::string& file) {
    return read_all(file, 4 + 4 + 8 + 8 + 3 * 8, "number of cameras", take_camera);
}

std::vector<ColmapImage> read_images_binary(const std::string& file) {
    return read_all(file, 4 + 7 * 8 + 4 + 1 + 8, "number of images", take_image);
}

}  // namespace burnish
