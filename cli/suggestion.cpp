#include "cli/suggestion.h"

#include "scene/parameter_names.h"

namespace burnish {

std::string nearest_name(const std::string& written, const std::vector<std::string>& names) {
    std::string nearest;
    std::size_t least = written.size() / 3 + 1;
    for (const std::string& name : names)
        if (const std::size_t found = edit_distance(written, name); found < least)
            nearest = name, least = found;
    return nearest;
}

}  // namespace burnish
