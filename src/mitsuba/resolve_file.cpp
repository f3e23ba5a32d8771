// File names of a scene -> files.
#include <fmt/format.h>

#include "image/files.h"
#include "mitsuba/xml.h"

namespace burnish::mitsuba {

namespace fs = std::filesystem;

namespace {

bool is_inside(const fs::path& path, const fs::path& folder) {
    const fs::path relative = path.lexically_relative(folder);
    return !relative.empty() && *relative.begin() != "..";
}

}  // namespace

fs::path resolve_file(const Document& document, const Place& place, const std::string& name) {
    if (name.empty() || name.find('\0') != std::string::npos)
        fail(place, "the file name is empty, expected a file");
    std::vector<fs::path> folders(document.search_folders.rbegin(), document.search_folders.rend());
    folders.insert(folders.end(), {document.named_folder, document.top_folder,
                                   fs::path(place.file).parent_path()});
    bool any_inside = false;
    for (const fs::path& folder : folders) {
        const fs::path candidate = folder / name;
        if (!is_inside(real_path(candidate), document.top_folder)) continue;
        any_inside = true;
        std::error_code error;
        const fs::path real = fs::canonical(candidate, error);  // none of a loop of links
        if (!error && is_inside(real, document.top_folder)) return candidate;
    }
    if (!any_inside)
        fail(place, fmt::format("the file \"{:.200}\" lies outside the folder of the scene, "
                                "expected one inside \"{}\"",
                                name, document.top_folder.string()));
    fail(place,
         fmt::format(
             "the file \"{:.200}\" does not exist, expected it beside \"{}\" or in a <path> folder",
             name, place.file));
}

}  // namespace burnish::mitsuba
