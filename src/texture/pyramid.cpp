#include "texture/pyramid.h"

#include <algorithm>
#include <utility>

#include "core/parallel.h"

namespace burnish {

namespace {

/// Where the finest level starts, as AdamState::initial.
std::vector<float> initial_of(const Image& initial) {
    const std::vector<float>& v = initial.values;
    std::vector<float> block(
        v.begin(), v.begin() + static_cast<std::ptrdiff_t>(std::min(v.size(), kDirtyBlock)));
    const bool repeats =
        std::equal(v.begin() + static_cast<std::ptrdiff_t>(block.size()), v.end(), v.begin());
    return repeats ? block : v;
}

/// The least gate of a texel's channels.
float texel_gate(const LevelState& level, int x, int y) {
    float gate = 1;
    for (int c = 0; c < level.values.channels; ++c) {
        const std::size_t i = level.values.index(x, y) + static_cast<std::size_t>(c);
        gate = std::min(gate, snr_gate(level.adam.square[i], level.adam.noise[i]));
    }
    return gate;
}

Image gates_of(const LevelState& level) {
    Image gates = make_image(level.values.width, level.values.height, 1);
    for (int y = 0; y < gates.height; ++y)
        for (int x = 0; x < gates.width; ++x) gates.at(x, y, 0) = texel_gate(level, x, y);
    return gates;
}

/// Raises each gate to that of the coarser texel that it reads with the largest weight. Where
/// several weigh alike the first counts.
void take_larger(const Prolongation& prolongation, const ChartBorders& borders, const Image& coarse,
                 Image& gates) {
    for (int y = 0; y < gates.height; ++y) {
        const Taps rows = taps_of(y, coarse.height, prolongation.repeats);
        const auto row = row_of(borders, y);
        auto border = row.begin();
        for (int x = 0; x < gates.width; ++x) {
            const Taps columns = taps_of(x, coarse.width, prolongation.repeats);
            int coarse_x = columns.near, coarse_y = rows.near;
            if (border != row.end() && border->x == x) {
                const auto& weight = (border++)->weight;
                const auto heaviest = std::max_element(weight.begin(), weight.end());
                if (*heaviest == 0) continue;
                const auto k = heaviest - weight.begin();
                if (k % 2 == 1) coarse_x = columns.far;
                if (k / 2 == 1) coarse_y = rows.far;
            }
            float& gate = gates.at(x, y, 0);
            gate = std::max(gate, coarse.at(coarse_x, coarse_y, 0));
        }
    }
}

/// values, of a level's size, plus the sum of all coarser ones.
Image prolonged_onto(const PyramidMaps& maps, std::size_t level, const Image& coarser,
                     Image values) {
    parallel_chunks(values.values.size(), kParallelFloats, [&](std::size_t begin, std::size_t end) {
        for_prolonged(maps.prolongation, maps.borders[level], values.width, &coarser, {}, begin,
                      end, [&](std::size_t from, std::size_t to, const float* coarse) {
                          for (std::size_t k = from; k < to; ++k)
                              values.values[k] += coarse[k - from];
                      });
    });
    return values;
}

/// The coarsest level alone, of the texture's size: weight decay leaves it where it is.
Image prolong_coarsest(const PyramidMaps& maps, const PyramidState& state) {
    Image sum = state.levels.back().values;
    for (std::size_t i = state.levels.size() - 1; i-- > 0;)
        sum = prolonged_onto(maps, i, sum,
                             make_image(maps.sizes[i].x, maps.sizes[i].y, sum.channels));
    return sum;
}

}  // namespace

PyramidMaps make_maps(int levels, int width, int height, const ChartMap& charts, bool repeats) {
    PyramidMaps maps;
    maps.prolongation.repeats = repeats;
    maps.sizes.push_back({width, height});
    ChartMap finer_charts = charts;
    while (static_cast<int>(maps.sizes.size()) < levels && std::max(width, height) > 1) {
        ChartBorders borders;
        if (!charts.empty()) {
            ChartMap coarse_charts = halve(finer_charts, width, height);
            borders = find_borders(maps.prolongation, finer_charts, coarse_charts, width, height);
            finer_charts = std::move(coarse_charts);
        }
        maps.borders.push_back(std::move(borders));
        width = half(width), height = half(height);
        maps.sizes.push_back({width, height});
    }
    return maps;
}

PyramidState encode(const PyramidMaps& maps, const Image& initial, bool keeps_initial) {
    PyramidState state;
    for (const auto& size : maps.sizes)
        state.levels.push_back(
            {state.levels.empty() ? copy_of(initial) : make_image(size.x, size.y, initial.channels),
             {}});
    const std::size_t texels = initial.values.size() / static_cast<std::size_t>(initial.channels);
    reserve_pages(texels, state.visits);
    state.visits.resize(texels);
    if (keeps_initial && maps.sizes.size() > 1)
        state.levels.front().adam.initial = initial_of(initial);
    return state;
}

Image decode(const PyramidMaps& maps, const PyramidState& state) {
    Image texture = state.levels.back().values;
    for (std::size_t i = state.levels.size() - 1; i-- > 0;)
        texture = prolonged_onto(maps, i, texture, copy_of(state.levels[i].values));
    for (float& v : texture.values) v = std::clamp(v, 0.0f, 1.0f);
    return texture;
}

std::size_t restart(const PyramidMaps& maps, const Image& from, const Image& to,
                    PyramidState& state, Image& texture, std::size_t begin) {
    if (from == to) return 0;
    LevelState& finest = state.levels.front();
    std::vector<float>& values = finest.values.values;
    std::vector<float>& initial = finest.adam.initial;
    const std::size_t period = initial.size();
    const Image coarsest = period > 0 ? prolong_coarsest(maps, state) : Image{};
    if (period > 0 && period < values.size()) {
        initial.resize(values.size());
        for (std::size_t k = period; k < initial.size(); ++k) initial[k] = initial[k % period];
    }
    std::size_t texels = 0;
    const auto channels = static_cast<std::size_t>(to.channels);
    for (std::size_t k = 0, last = to.values.size(); k < to.values.size(); ++k) {
        if (from.values[k] == to.values[k]) continue;
        texels += k / channels != last, last = k / channels;
        if (const std::size_t own = k - begin; k >= begin && own < values.size()) {
            values[own] += to.values[k] - texture.values[k];
            if (period > 0)
                initial[own] =
                    to.values[k] - (state.visits[own / channels] > 0 ? coarsest.values[k] : 0.0f);
            for (auto* of : {&finest.adam.mean, &finest.adam.square, &finest.adam.noise})
                if (!of->empty()) (*of)[own] = 0;
        }
        texture.values[k] = to.values[k];
    }
    return texels;
}

Image confidence(const PyramidMaps& maps, const PyramidState& state) {
    if (state.levels.front().adam.noise.empty()) return {};
    Image result = gates_of(state.levels.back());
    for (std::size_t i = state.levels.size() - 1; i-- > 0;) {
        Image gates = gates_of(state.levels[i]);
        take_larger(maps.prolongation, maps.borders[i], result, gates);
        result = std::move(gates);
    }
    for (std::size_t k = 0; k < result.values.size(); ++k)
        if (state.visits[k] == 0) result.values[k] = 0;  // a coarser level knows its neighbours
    return result;
}

}  // namespace burnish
