// File names of a scene -> files.
#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "image/files.h"
#include "mitsuba/xml.h"

namespace burnish::mitsuba {

namespace fs = std::filesystem;

namespace {

bool is_inside(const fs::path& path, const fs::path& folder) {
    const fs::path relative = path.lexically_relative(folder);
    return !relative.empty() && *relative.begin() != "..";
}

std::vector<fs::path> candidates_of(const Document& document, const fs::path& from,
                                    const std::string& name) {
    std::vector<fs::path> candidates;
    for (std::size_t i = document.search_folders.size(); i-- > 0;)
        candidates.push_back(document.search_folders[i].named / name);
    for (const fs::path& folder : {document.named_folder, document.top_folder, from})
        candidates.push_back(folder / name);
    return candidates;
}

/// The first that is there, behind links inside of the folder of the scene; empty: none.
fs::path first_inside(const Document& document, const std::vector<fs::path>& candidates) {
    for (const fs::path& candidate : candidates) {
        std::error_code error;
        if (!fs::exists(candidate, error)) continue;
        const fs::path real = fs::canonical(candidate, error);
        if (!error && is_inside(real, document.top_folder)) return candidate;
    }
    return {};
}

}  // namespace

fs::path find_file(const Document& document, const Place& place, const std::string& name) {
    if (name.empty() || name.find('\0') != std::string::npos) return {};
    const fs::path from = fs::path(place.file).parent_path();
    const std::pair key(from.string(), name);
    if (const auto known = document.files.find(key); known != document.files.end())
        return known->second;
    return document.files[key] = first_inside(document, candidates_of(document, from, name));
}

fs::path resolve_file(const Document& document, const Place& place, const std::string& name) {
    if (name.empty() || name.find('\0') != std::string::npos)
        fail(place, "the file name is empty, expected a file");
    const fs::path found = find_file(document, place, name);
    if (!found.empty()) return found;
    const std::vector<fs::path> candidates =
        candidates_of(document, fs::path(place.file).parent_path(), name);
    if (std::none_of(candidates.begin(), candidates.end(), [&](const fs::path& candidate) {
            return is_inside(real_path(candidate), document.top_folder);
        }))
        fail(place, fmt::format("the file \"{:.200}\" lies outside the folder of the scene, "
                                "expected one inside \"{}\"",
                                name, document.top_folder.string()));
    fail(place,
         fmt::format(
             "the file \"{:.200}\" does not exist, expected it beside \"{}\" or in a <path> folder",
             name, place.file));
}

}  // namespace burnish::mitsuba
