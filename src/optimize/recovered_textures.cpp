#include "optimize/recovered_textures.h"

#include <algorithm>
#include <span>

#include "scene/parameter_names.h"
#include "texture/unvisited.h"

namespace burnish {

namespace {

/// Above 0: of what is not to be filled: texels that samples visited, and those that surfaces read
/// where known textures guided the start.
std::vector<std::uint32_t> known_texels(const UnknownTexture& unknown,
                                        const PyramidState& pyramid) {
    std::vector<std::uint32_t> known = pyramid.visits;
    if (unknown.is_guided)
        for (std::size_t i = 0; i < known.size(); ++i) known[i] += unknown.charts[i] > 0;
    return known;
}

/// What unvisited texels keep: their start, or what a later search has put in its place.
std::span<const float> searched_last(const UnknownTexture& unknown, const PyramidState& pyramid) {
    const std::vector<float>& initial = pyramid.levels.front().adam.initial;
    return initial.size() == unknown.start.values.size() ? initial : unknown.start.values;
}

}  // namespace

std::vector<RecoveredTexture> recovered_textures(const Setup& setup, const State::Values& state) {
    std::vector<RecoveredTexture> textures;
    const Scene& scene = scene_of(setup);
    const std::vector<Parameter>& parameters = scene.parameters;
    for (std::size_t i = 0; i < setup.unknowns.size(); ++i) {
        const UnknownTexture& u = setup.unknowns[i];
        const PyramidState& pyramid = state.pyramids[i];
        RecoveredTexture t;
        t.name = parameters[find_parameter(parameters, setup.problem.unknowns[i].name)].name;
        t.values = state.theta.textures[i].values;
        t.start = u.start;
        t.unvisited = count_unvisited(pyramid.visits, u.charts);
        const bool fills =
            setup.options.unvisited == Unvisited::kFill && u.start_kind != StartKind::kGiven;
        const bool is_seen = std::ranges::any_of(pyramid.visits, [](auto v) { return v > 0; });
        t.filled = fills && !u.is_guided && is_seen;
        if (!t.filled && pyramid.levels.size() > 1)  // else nothing has moved them
            keep_unvisited(pyramid.visits, searched_last(u, pyramid), t.values);
        const bool repeats = std::get<Bitmap>(scene[u.texture]).wrap == TextureWrap::kRepeat;
        if (fills) fill_unvisited(known_texels(u, pyramid), u.charts, repeats, t.values);
        t.coverage = make_image(t.values.width, t.values.height, 1);
        for (std::size_t k = 0; k < pyramid.visits.size(); ++k)
            t.coverage.values[k] = static_cast<float>(pyramid.visits[k]) /
                                   static_cast<float>(std::max(1u, state.iteration));
        t.confidence = confidence(u.maps, pyramid);
        textures.push_back(std::move(t));
    }
    return textures;
}

}  // namespace burnish
