#include "captures/json_value.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "burnish/error.h"
#include "core/transform.h"
#include "image/files.h"
#include "image/image.h"

namespace burnish {

using nlohmann::json;

json parse_json(const std::string& file, const std::string& what) {
    require_short_text(file, what);
    return parse_json(read_bytes(file), file, 0, what);
}

json parse_json(std::string_view text, const std::string& file, std::size_t first,
                const std::string& what) {
    constexpr int kMaxDepth = 64;             // values are written, and freed, by recursion
    std::vector<std::set<std::string>> keys;  // of the objects around a value
    const auto check = [&](int depth, json::parse_event_t event, json& value) {
        if (depth > kMaxDepth)
            throw InputError(
                fmt::format("{}: found values {} deep, expected {}", file, depth, what));
        if (event == json::parse_event_t::object_start) keys.emplace_back();
        if (event == json::parse_event_t::object_end) keys.pop_back();
        if (event == json::parse_event_t::key &&
            !keys.back().insert(value.get<std::string>()).second)
            throw InputError(
                fmt::format("{}: the key {} stands twice in one object, expected it once", file,
                            value.dump(-1, ' ', false, json::error_handler_t::replace)));
        return true;
    };
    try {
        return json::parse(text, check);
    } catch (const json::parse_error& e) {
        throw InputError(
            fmt::format("{}, byte {}: found no JSON, expected {}", file, first + e.byte, what));
    } catch (const json::out_of_range&) {
        throw InputError(fmt::format(
            "{}: found a number that is too large to be stored, expected {}", file, what));
    }
}

std::string place_of(const Value& v) { return v.key.empty() ? v.file : v.file + ": " + v.key; }

void fail(const Value& v, const std::string& expected) {
    constexpr std::size_t kMaxShown = 60;
    std::string found = v.value.dump(-1, ' ', false, json::error_handler_t::replace);
    if (found.size() > kMaxShown) found = found.substr(0, kMaxShown) + " ...";
    throw InputError(fmt::format("{}: found {}, expected {}", place_of(v), found, expected));
}

Value member(const Value& object, const std::string& name) {
    return {object.value.at(name), object.file,
            object.key.empty() ? name : object.key + "." + name};
}

Value element(const Value& array, std::size_t i) {
    return {array.value.at(i), array.file, fmt::format("{}[{}]", array.key, i)};
}

void check_object(const Value& v, const std::vector<std::string>& known) {
    if (!v.value.is_object()) fail(v, "an object");
    for (const auto& [name, value] : v.value.items())
        if (std::find(known.begin(), known.end(), name) == known.end())
            throw InputError(fmt::format("{}: {}: unknown key, expected one of {}", v.file,
                                         v.key.empty() ? name : v.key + "." + name,
                                         fmt::join(known, ", ")));
}

void require_member(const Value& object, const char* name) {
    if (!has(object, name))
        throw InputError(fmt::format("{}: expected the key \"{}\"", place_of(object), name));
}

std::string text(const Value& v) {
    if (!v.value.is_string()) fail(v, "a text");
    return v.value.get<std::string>();
}

double number(const Value& v) {
    if (!v.value.is_number()) fail(v, "a number");
    return v.value.get<double>();
}

std::vector<double> numbers(const Value& v, std::size_t count) {
    if (!v.value.is_array() || v.value.size() != count)
        fail(v, fmt::format("an array of {} numbers", count));
    std::vector<double> all;
    for (std::size_t i = 0; i < count; ++i) all.push_back(number(element(v, i)));
    return all;
}

Matrix matrix(const Value& v) {
    if (!v.value.is_array() || v.value.size() != 4) fail(v, "four rows of four numbers");
    Matrix m{};
    for (std::size_t row = 0; row < 4; ++row) {
        const std::vector<double> r = numbers(element(v, row), 4);
        std::copy(r.begin(), r.end(), m.begin() + static_cast<std::ptrdiff_t>(4 * row));
    }
    return m;
}

Matrix camera_to_world(const Value& v, const std::array<double, 3>& axes) {
    constexpr double kTolerance = 1e-3;
    Matrix m = matrix(v);
    for (std::size_t c = 0; c < 4; ++c) {
        double& last = m[12 + c];
        const double expected = c == 3;
        if (std::abs(last - expected) > kTolerance)
            fail(element(v, 3), "0 0 0 1 as the last row (is the matrix transposed?)");
        last = expected;
    }
    if (!is_rigid(Transform{m}, kTolerance))
        fail(v, "a rotation and a translation that do not scale, shear or mirror");
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t c = 0; c < 3; ++c) m[4 * row + c] *= axes[c];
    return m;
}

int side(const Value& v) {
    const double value = number(v);
    if (!is_side(value)) fail(v, fmt::format("pixels, 1 to {}", kMaxImageSide));
    return static_cast<int>(value);
}

std::string path_within(const std::string& folder, const std::string& named) {
    const std::filesystem::path path = named, plain = path.lexically_normal();
    if (path.empty() || path.is_absolute() || *plain.begin() == "..") return {};
    return (std::filesystem::path(folder) / plain).string();
}

std::string file_of(const Value& v) {
    const auto folder = std::filesystem::path(v.file).parent_path();
    const std::string path = path_within(folder.string(), text(v));
    if (path.empty()) fail(v, "a path within the folder of the capture");
    return path;
}

}  // namespace burnish
