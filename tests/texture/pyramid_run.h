// Pyramids, charts and images that the tests of pyramids work on.
#pragma once

#include <vector>

#include "images.h"
#include "random_source.h"
#include "texture/pyramid_step.h"

namespace burnish::test {

/// Two charts, left and right, with a column of no chart between them.
inline ChartMap two_charts(int width, int height) {
    ChartMap charts;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            charts.push_back(x < width / 2 ? 1u : x == width / 2 ? 0u : 2u);
    return charts;
}

/// Many small charts that touch, holes, and islands of a single texel.
inline ChartMap random_charts(int width, int height, std::uint32_t seed) {
    RandomSource random{seed};
    std::vector<std::uint32_t> blocks;
    for (int i = 0; i < width * height; ++i)
        blocks.push_back(static_cast<std::uint32_t>(random.next(0.0f, 4.0f)));
    ChartMap charts;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            charts.push_back((y * width + x) % 97 == 5
                                 ? 4
                                 : blocks[static_cast<std::size_t>((y / 3) * width + x / 5)]);
    return charts;
}

/// A pyramid with all that a step of it reads and writes.
struct PyramidRun {
    AdamOptions adam;
    PyramidMaps maps;
    PyramidState state;
    PyramidWorkspace workspace = {};
};

/// The decay of Options::pyramid and a damping.
inline AdamOptions default_adam() {
    AdamOptions adam;
    adam.weight_decay = 0.5f, adam.damping = 0.03f;
    return adam;
}

inline PyramidRun make_run(int levels, const Image& initial, const ChartMap& charts = {},
                           bool repeats = false, const AdamOptions& adam = default_adam()) {
    PyramidRun run{adam, make_maps(levels, initial.width, initial.height, charts, repeats), {}};
    run.state = encode(run.maps, initial, adam.weight_decay > 0);
    return run;
}

inline Image decode(const PyramidRun& run) { return decode(run.maps, run.state); }

inline void descend(const SplitGradient& gradient, PyramidRun& run, Image& texture) {
    const PyramidPart all = part_of(run.maps, texture.channels);
    descend({run.adam, run.maps, all, {}}, gradient, run.state, run.workspace, texture);
}

}  // namespace burnish::test
