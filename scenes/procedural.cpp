#include "scenes/procedural.h"

#include <fmt/format.h>

#include "burnish/error.h"
#include "image/files.h"
#include "scene/parameter_names.h"
#include "scenes/scene_files.h"

namespace burnish {

namespace {

struct Entry {
    const char* name;
    void (*write)(const std::filesystem::path& folder, const ProceduralOptions& options);
};

constexpr Entry kEntries[] = {{"goblet", procedural::write_goblet},
                              {"tyre", procedural::write_tyre},
                              {"bowl", procedural::write_bowl},
                              {"tree", procedural::write_tree}};

constexpr const char* kLicence =
    "This scene (scene.xml, meshes and textures) was written by the program Burnish from formulas\n"
    "of its own. It is part of the Burnish project and under the same licence:\n\n"
    "SPDX-License-Identifier: Apache-2.0\n\n"
    "You may use, change and redistribute it under the terms of the Apache License, Version 2.0,\n"
    "http://www.apache.org/licenses/LICENSE-2.0\n";

}  // namespace

std::vector<std::string> procedural_scene_names() {
    std::vector<std::string> names;
    for (const Entry& entry : kEntries) names.emplace_back(entry.name);
    return names;
}

void write_procedural_scene(const std::string& name, const std::filesystem::path& folder,
                            const ProceduralOptions& options) {
    if (options.texture_size < 16 || options.texture_size > 8192) {
        throw InputError(
            fmt::format("the texture size of a built-in scene is {}, expected 16 to 8192",
                        options.texture_size));
    }
    for (const Entry& entry : kEntries) {
        if (name != entry.name) continue;
        for (const char* part : {"meshes", "textures"}) make_folder(folder / part);
        entry.write(folder, options);
        write_bytes(folder / "LICENSE", kLicence);
        return;
    }
    throw InputError(fmt::format("no built-in scene is called '{}', {}", name,
                                 expected_name(name, procedural_scene_names())));
}

}  // namespace burnish
