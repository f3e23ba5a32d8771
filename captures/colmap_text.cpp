// COLMAP's text files. A line that begins with # is a comment. An image takes two lines: the second
// one holds its points and may be empty.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include "burnish/error.h"
#include "captures/camera_model.h"
#include "captures/colmap_model.h"
#include "core/parsed.h"
#include "image/files.h"
#include "image/image.h"

namespace burnish {

namespace {

struct Line {
    std::string place;  ///< "FILE:NUMBER"
    std::string_view text;
};

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kSpace = " \t\r";
    const std::size_t first = text.find_first_not_of(kSpace);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

/// Lines without comments, trimmed.
std::vector<Line> lines_without_comments(const std::string& file, std::string_view bytes) {
    std::vector<Line> lines;
    for (std::size_t number = 1; !bytes.empty(); ++number) {
        const std::size_t end = std::min(bytes.find('\n'), bytes.size());
        const std::string_view text = trimmed(bytes.substr(0, end));
        if (!text.starts_with('#')) lines.push_back({fmt::format("{}:{}", file, number), text});
        bytes.remove_prefix(std::min(end + 1, bytes.size()));
    }
    return lines;
}

[[noreturn]] void refuse_line(const Line& line, std::string_view found,
                              const std::string& expected) {
    constexpr std::size_t kMaxShown = 60;
    throw InputError(fmt::format("{}: found \"{}{}\", expected {}", line.place,
                                 found.substr(0, kMaxShown), found.size() > kMaxShown ? "..." : "",
                                 expected));
}

/// The words of a line, one after the other.
class Words {
  public:
    explicit Words(const Line& line) : line_(line), rest_(line.text) {}
    std::string_view word(const std::string& expected) {
        const std::size_t end = std::min(rest_.find_first_of(" \t"), rest_.size());
        const std::string_view found = rest_.substr(0, end);
        rest_ = trimmed(rest_.substr(end));
        if (found.empty()) refuse_line(line_, line_.text, expected);
        return found;
    }
    template <class T>
    T number(const std::string& expected) {
        const std::string_view found = word(expected);
        const std::optional<T> value = parsed<T>(found);
        if (!value) refuse_line(line_, found, expected);
        return *value;
    }
    std::string_view rest() const { return rest_; }

  private:
    const Line& line_;
    std::string_view rest_;
};

bool holds_points(std::string_view text) {
    std::size_t count = 0;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find_first_of(" \t"), text.size());
        double value = 0;
        const auto read = std::from_chars(text.data(), text.data() + end, value);
        if (read.ptr != text.data() + end) return false;
        text = trimmed(text.substr(end));
        ++count;
    }
    return count % 3 == 0;
}

ColmapCamera camera_of_line(const Line& line) {
    Words words(line);
    ColmapCamera read;
    read.id = words.number<std::uint32_t>("the id of a camera");
    const std::string name(words.word("a camera model"));
    const CameraModel* model = find_camera_model(name);
    if (!model) refuse_line(line, name, "one of " + camera_model_names());
    std::array<int, 2> size{};
    for (int& s : size) {
        const auto pixels =
            words.number<double>(fmt::format("a side in pixels, 1 to {}", kMaxImageSide));
        s = colmap_side(line.place, fmt::format("{:g}", pixels), pixels);
    }
    std::vector<double> parameters;
    for (std::size_t i = 0; i < parameter_count(*model); ++i)
        parameters.push_back(words.number<double>(
            fmt::format("{} parameters of {}", parameter_count(*model), name)));
    if (!words.rest().empty())
        refuse_line(line, words.rest(),
                    fmt::format("no more than the {} parameters of {}", parameters.size(), name));
    require_camera(*model, parameters, line.place);
    read.camera = make_camera(*model, size[0], size[1], parameters);
    return read;
}

ColmapImage image_of_line(const Line& line) {
    Words words(line);
    ColmapImage image;
    image.place = line.place;
    words.number<std::uint32_t>("the id of an image");
    for (double& q : image.world_to_camera) q = words.number<double>("a quaternion");
    for (double& t : image.translation) t = words.number<double>("a translation");
    image.camera = words.number<std::uint32_t>("the id of a camera");
    image.name = std::string(words.rest());
    if (image.name.empty()) refuse_line(line, line.text, "the name of an image at its end");
    return image;
}

}  // namespace

std::vector<ColmapCamera> read_cameras_text(const std::string& file) {
    const std::string bytes = read_text_bytes(file);
    std::vector<ColmapCamera> cameras;
    for (const Line& line : lines_without_comments(file, bytes))
        if (!line.text.empty()) cameras.push_back(camera_of_line(line));
    return cameras;
}

std::vector<ColmapImage> read_images_text(const std::string& file) {
    const std::string bytes = read_text_bytes(file);
    const std::vector<Line> lines = lines_without_comments(file, bytes);
    std::vector<ColmapImage> images;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (lines[i].text.empty()) continue;
        images.push_back(image_of_line(lines[i]));
        if (++i < lines.size() && !holds_points(lines[i].text))
            refuse_line(lines[i], lines[i].text,
                        "the points of the image before, x y id of each; the line may be empty");
    }
    return images;
}

}  // namespace burnish
