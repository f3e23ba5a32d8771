#include "cli/options_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "burnish/error.h"
#include "captures/json_value.h"
#include "cli/folder_content.h"
#include "core/at_place.h"
#include "core/utf8.h"
#include "image/files.h"

namespace burnish {

namespace {

using Json = nlohmann::ordered_json;

std::string text_of(const Json& value, const std::string& where) {
    if (value.is_string()) return value.get<std::string>();
    if (value.is_number() || value.is_boolean()) return value.dump();
    throw InputError(where + ": expected a number, a text, true or false, found " + value.dump());
}

std::vector<std::string> texts_of(const Json& value, const std::string& where) {
    if (!value.is_array()) return {text_of(value, where)};
    std::vector<std::string> texts;
    for (const Json& element : value) texts.push_back(text_of(element, where));
    if (texts.empty()) throw InputError(where + ": expected at least one value, found none");
    return texts;
}

/// An array is a list, or a pair; of other options it would lose all but its last value.
void check_count(const Setting& setting, std::size_t count) {
    const std::size_t expected = setting.is_pair ? 2 : 1;
    if (!setting.is_list && count != expected)
        throw InputError(fmt::format("{}: expected {}, found {}", setting.info.name,
                                     setting.is_pair ? "two values" : "one value", count));
}

void check_values(const Given& g, const std::string& file) {
    at_place(file, [&] {
        check_count(find_setting(g.names.front()), g.values.size());
        for (const std::string& value : g.values)
            if (const std::string wrong = complaint(g.names.front(), value); !wrong.empty())
                throw InputError(g.names.front() + ": " + wrong);
    });
}

void read_object(const Json& object, const std::string& prefix, const std::string& file,
                 std::vector<Given>& given) {
    for (const auto& [key, value] : object.items()) {
        const std::string name = prefix + key;
        if (value.is_object()) {
            read_object(value, name + ".", file, given);
            continue;
        }
        Given g{file + ": " + name, {name}, texts_of(value, file + ": " + name)};
        check_values(g, file);
        given.push_back(std::move(g));
    }
}

/// Numbers, true and false are so in JSON, too; the rest, and the word for no value, is text.
Json json_of(const OptionInfo& info, const std::string& text) {
    const bool number = info.range.high > info.range.low && parse_number(text);
    return number || text == "true" || text == "false" ? Json::parse(text) : Json(text);
}

/// Bytes that are not ASCII as \xNN.
std::string ascii(const std::string& text) {
    std::string result;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        result += byte < 0x80 ? std::string(1, c) : fmt::format("\\x{:02x}", byte);
    }
    return result;
}

/// Of a file, which may be a summary.json, or a pipe, which may have no end.
std::string text_of_file(const std::string& file) {
    std::ifstream stream(file);
    std::string text, part(std::size_t{1} << 16, '\0');
    while (stream && text.size() <= kMaxSummarySize) {
        stream.read(part.data(), static_cast<std::streamsize>(part.size()));
        text.append(part, 0, static_cast<std::size_t>(stream.gcount()));
    }
    if (!stream && !stream.eof())
        throw InputError(
            fmt::format("{}: the file cannot be read: {}", file, std::strerror(errno)));
    require_short_text(file, text.size(), kMaxSummarySize, "names of options");
    return text;
}

}  // namespace

std::vector<Given> read_options_file(const std::string& file) {
    if (std::filesystem::is_directory(status_of(file)))
        throw InputError(file + ": found a folder, expected a file with names of options");
    return read_options_text(text_of_file(file), file);
}

std::vector<Given> read_options_text(const std::string& text, const std::string& name) {
    Json options(parse_json(text, name, 0, "names of options"));
    if (options.is_object() && options.contains("burnish") && options.contains("settings"))
        options = Json(options["settings"]);
    if (!options.is_object())
        throw InputError(name + ": expected a JSON object with names of options");
    std::vector<Given> given;
    read_object(options, "", name, given);
    return given;
}

Json settings_json(const Settings& settings) {
    Json all = Json::object();
    for (const SettingText& s : recorded_settings(settings)) {
        std::string path = "/";
        path += s.info->name;
        for (char& c : path)
            if (c == '.') c = '/';
        Json& place = all[Json::json_pointer(path)];
        if (!s.is_list)
            place = json_of(*s.info, s.values.front());
        else
            for (const std::string& value : s.values) place.push_back(json_of(*s.info, value));
    }
    return all;
}

void require_recordable(const Settings& settings) {
    for (const SettingText& s : recorded_settings(settings))
        for (const std::string& value : s.values)
            if (utf8_prefix(value) < value.size())
                throw InputError(fmt::format(
                    "{}: found \"{}\", expected a text in UTF-8, which the record of the run can "
                    "hold: another name, or a relative one where a folder has this name",
                    s.info->name, ascii(value)));
}

}  // namespace burnish
