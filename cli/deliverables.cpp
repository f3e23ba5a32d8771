#include "cli/deliverables.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <set>

#include "burnish/error.h"
#include "cli/blender_script.h"
#include "cli/console.h"
#include "image/files.h"
#include "mitsuba/write.h"
#include "models/model_glb.h"
#include "scene/parameter_names.h"

namespace burnish {

namespace {

namespace fs = std::filesystem;

constexpr const char* kSceneFolder = "scene";
constexpr const char* kSceneFile = "scene.xml";  // within it
constexpr const char* kLicense = "LICENSE";      // of the scene, beside it
constexpr const char* kModel = "model.glb";
constexpr const char* kScript = "import_into_blender.py";

/// "roughness" of "mat.brdf_0.roughness.data"
std::string property_of(const std::string& parameter) {
    const std::size_t end = parameter.rfind('.');
    return parameter.substr(parameter.rfind('.', end - 1) + 1,
                            end - parameter.rfind('.', end - 1) - 1);
}

/// The element that had a constant where a texture is now: one BSDF or one blend.
int element_of(const LoadedScene& loaded, TextureId texture) {
    const Scene& scene = loaded.scene;
    for (const auto& [material, element] : loaded.source.blends)
        if (scene[MaterialId{material}].blend->weight.texture == texture) return element;
    const auto reader = std::find_if(scene.bsdfs.begin(), scene.bsdfs.end(),
                                     [&](const Bsdf& bsdf) { return reads(bsdf, texture); });
    return loaded.source.bsdfs[static_cast<std::size_t>(reader - scene.bsdfs.begin())];
}

/// Where the scene file has what was recovered. A constant is no parameter of the scene as it was
/// read.
ParameterSource source_of(const LoadedScene& loaded, const TargetTexture& texture) {
    const SceneSource& source = loaded.source;
    const std::size_t i = find_parameter(loaded.scene.parameters, texture.name);
    if (i < source.parameters.size()) return source.parameters[i];
    return {element_of(loaded, texture.texture), property_of(texture.name), -1};
}

/// The folder of the recovered textures: a file of the scene may have the name.
std::string free_folder(const std::set<std::string>& taken) {
    std::string name = "textures";
    while (taken.contains(name)) name += '_';
    return name;
}

/// A file name of its own for a texture.
std::string free_name(const std::string& folder, const TargetTexture& texture,
                      std::set<std::string>& taken) {
    std::string stem = folder + "/" + texture.file;
    while (!taken.insert(stem + ".exr").second) stem += '_';
    return stem + ".exr";
}

/// The textures are those that the results have: a large one takes seconds to compress.
void write_recovered_scene(const LoadedScene& loaded, const RunResult& run,
                           const fs::path& results) {
    const fs::path folder = results / kSceneFolder;
    const SceneSource& source = loaded.source;
    const std::vector<std::string> copied = files_of(source);
    std::set<std::string> taken(copied.begin(), copied.end());
    const std::string textures = free_folder(taken);
    std::vector<NewValue> values;
    for (std::size_t i = 0; i < run.textures.size(); ++i) {
        const TargetTexture& t = run.textures[i];
        const Image& texels = run.result.summary.textures[i].values;
        const ParameterSource at = source_of(loaded, t);
        if (at.texture < 0 && texels.values.size() == 1) {
            values.push_back({at, texels.values[0]});
        } else if (at.texture < 0 && is_one_value(texels)) {
            values.push_back({at, Rgbf{texels.values[0], texels.values[1], texels.values[2]}});
        } else {
            const std::string name = free_name(textures, t, taken);
            make_folder(folder / textures);
            write_bytes(folder / name, read_bytes(results / texture_file(t, ".exr")));
            values.push_back({at, BitmapFile{name, texels.channels == 1}});
        }
    }
    write_scene(source, values, folder);
    const fs::path license = source.folder / kLicense;
    std::error_code ignored;
    if (fs::is_regular_file(license, ignored)) write_bytes(folder / kLicense, read_bytes(license));
}

/// The files of write_recovered_scene at most, in the folder of the scene.
std::vector<std::string> scene_names(const LoadedScene& loaded, const RunResult& run) {
    std::vector<std::string> names = files_of(loaded.source);
    std::set<std::string> taken(names.begin(), names.end());
    const std::string textures = free_folder(taken);
    for (const TargetTexture& t : run.textures) names.push_back(free_name(textures, t, taken));
    names.insert(names.end(), {kSceneFile, kLicense});
    return names;
}

/// The recovered textures in the place of the scene's.
TextureTable recovered_table(const Scene& scene, const RunResult& run) {
    TextureTable table{scene.textures, std::vector<const float*>(scene.textures.size(), nullptr)};
    for (std::size_t i = 0; i < run.textures.size(); ++i)
        table.values[static_cast<std::size_t>(run.textures[i].texture.value)] =
            run.result.summary.textures[i].values.values.data();
    return table;
}

/// Writes a file, or a folder with one, and notes it; where what it is made of cannot be read any
/// more, leaves nothing of it. Returns whether it was written.
bool write_or_leave_out(const fs::path& folder, const char* name, const std::string& file,
                        const std::function<void()>& write, RunResult& run) {
    std::string reason;
    try {
        write();
        run.deliverables.emplace_back(name, file);
        return true;
    } catch (const InputError& e) {
        reason = e.what();
    }
    const fs::path top = *fs::path(file).begin();
    std::error_code ignored;
    fs::remove_all(folder / top, ignored);
    log_warning(fmt::format("{} is left out: {}", top.string(), reason));
    return false;
}

/// Of a file in the folder of the scene.
std::string in_scene(const std::string& name) { return std::string(kSceneFolder) + "/" + name; }

}  // namespace

std::vector<std::string> deliverable_names(const LoadedScene& loaded, const RunResult& run) {
    std::vector<std::string> names{kModel, kScript};
    try {
        for (const std::string& name : scene_names(loaded, run)) names.push_back(in_scene(name));
    } catch (const InputError&) {  // the scene will be left out
    }
    return names;
}

void write_deliverables(const LoadedScene& loaded, const fs::path& folder, RunResult& run) {
    const auto write_text = [&](const char* name, const std::string& text) {
        write_bytes(folder / name, text);
    };
    const bool has_scene = write_or_leave_out(
        folder, "scene", in_scene(kSceneFile), [&] { write_recovered_scene(loaded, run, folder); },
        run);
    write_or_leave_out(
        folder, "model", kModel,
        [&] { write_text(kModel, model_glb(loaded.scene, recovered_table(loaded.scene, run))); },
        run);
    write_or_leave_out(
        folder, "blender_script", kScript,
        [&] { write_text(kScript, blender_script(loaded, run, has_scene)); }, run);
}

}  // namespace burnish
