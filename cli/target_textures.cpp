#include "cli/target_textures.h"

#include <fmt/format.h>

#include <algorithm>

#include "burnish/error.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/rated_name.h"
#include "cli/texture_files.h"
#include "gradient/theta.h"
#include "optimize/option_value.h"
#include "optimize/setup.h"
#include "scene/constants.h"
#include "scene/parameter_names.h"

namespace burnish {

namespace {

template <class T>
const T& one_or_each(const std::vector<T>& values, std::size_t i) {
    return values.size() == 1 ? values[0] : values[i];
}

StartKind kind_of_start(const std::string& text) {
    if (text == "search") return StartKind::kSearched;
    return parse_number(text) ? StartKind::kConstant : StartKind::kGiven;
}

/// 0.5 stands for a start that is still to be searched.
Image initial_texels(const Bitmap& bitmap, const std::string& text, const std::string& name) {
    if (text == "search") return make_image(bitmap.width, bitmap.height, bitmap.channels, 0.5f);
    Image texels =
        text == "scene" ? linear_image(bitmap) : read_texels(bitmap, text, "the start of " + name);
    for (const float v : texels.values)
        if (!(v >= 0 && v <= 1))
            throw InputError(
                fmt::format("the start of {} holds {}, expected values from 0 to 1", name, v));
    return texels;
}

TargetTexture make_target_texture(const RunSettings& run, std::size_t i, bool rendered,
                                  Scene& scene) {
    const RatedName rated = split_rate(scene, run.parameters[i]);
    const Parameter p = scene.parameters[require_parameter(scene, rated.name)];
    check_unknown(scene, p.name, p.texture);
    auto& bitmap = std::get<Bitmap>(scene[p.texture]);
    TargetTexture t;
    t.is_color = read_as_color(scene, p.texture);
    if (!t.is_color) keep_luminance(bitmap);
    t.name = p.name;
    t.texture = p.texture;
    t.raw = bitmap.raw;
    t.own_rate = rated.learning_rate;
    if (t.own_rate > 0 && run.learning_rates.size() > 1)
        throw UsageError(fmt::format(
            "--learning-rate: one for each parameter, but {} has its own: expected one of the two",
            run.parameters[i]));
    if (t.own_rate == 0 && !run.learning_rates.empty())
        t.own_rate = one_or_each(run.learning_rates, i);
    const std::string& start = one_or_each(run.starts, i);
    t.start_kind = kind_of_start(start);
    t.initial = initial_texels(bitmap, start, p.name);
    if (rendered) t.truth = linear_image(bitmap);
    return t;
}

}  // namespace

std::vector<TargetTexture> make_target_textures(const Settings& settings, bool rendered,
                                                Scene& scene) {
    std::vector<TargetTexture> textures;
    std::vector<TextureId> ids;
    std::vector<std::string> files;
    for (std::size_t i = 0; i < settings.run.parameters.size(); ++i) {
        textures.push_back(make_target_texture(settings.run, i, rendered, scene));
        ids.push_back(textures.back().texture);
        files.push_back(file_name_of(textures.back().name));
    }
    require_distinct(settings.run.parameters, ids);
    files = unique_names(std::move(files));
    for (std::size_t i = 0; i < files.size(); ++i) textures[i].file = files[i];
    for (TargetTexture& t : textures)
        t.learning_rate =
            learning_rate_of(scene, ids, t.texture, t.start_kind, settings.options, t.own_rate);
    return textures;
}

void warn_of_truths(RunResult& run) {
    for (const TargetTexture& t : run.textures) {
        if (!t.truth) continue;
        const auto outside =
            std::ranges::count_if(t.truth->values, [](float v) { return !(v >= 0 && v <= 1); });
        if (outside == 0) continue;
        run.warnings.push_back(
            fmt::format("the truth of {} holds {} outside of [0, 1], which no unknown takes",
                        t.name, count_text(static_cast<std::size_t>(outside), "value")));
        log_warning(run.warnings.back());
    }
}

}  // namespace burnish
