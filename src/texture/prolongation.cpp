#include "texture/prolongation.h"

#include <algorithm>

#include "texture/level_taps.h"

namespace burnish {

namespace {

/// Calls body(y, x0, x1) for the parts of rows that texels [begin, end) of a level lie in.
template <class Body>
void for_rows(int level_width, std::size_t begin, std::size_t end, const Body& body) {
    const auto width = static_cast<std::size_t>(level_width);
    while (begin < end) {
        const std::size_t count = std::min(width - begin % width, end - begin);
        const int x0 = static_cast<int>(begin % width);
        body(static_cast<int>(begin / width), x0, x0 + static_cast<int>(count));
        begin += count;
    }
}

/// Texels [x0, x1) of row y of the coarse level, prolonged to the fine one. blend: work memory for
/// a coarse row. fine: from x0 on.
template <int kChannels>
void prolong_row(const Prolongation& prolongation, const Image& coarse, int y, int x0, int x1,
                 float* __restrict blend, float* __restrict fine) {
    const Taps rows = taps_of(y, coarse.height, prolongation.repeats);
    const float* __restrict near = row_of(coarse, rows.near);
    const float* __restrict far = row_of(coarse, rows.far);
    const auto blend_texels = [&](int from, int to) {
        for (int i = from * kChannels; i < to * kChannels; ++i)
            blend[i] = kNear * near[i] + kFar * far[i];
    };
    const auto [first, last] = columns_of(x0, x1, coarse.width);
    blend_texels(first, last);
    if (prolongation.repeats) blend_texels(0, 1), blend_texels(coarse.width - 1, coarse.width);
    const auto by_taps = [&](int x) {
        const Taps t = taps_of(x, coarse.width, prolongation.repeats);
        for (int c = 0; c < kChannels; ++c)
            fine[(x - x0) * kChannels + c] =
                kNear * blend[t.near * kChannels + c] + kFar * blend[t.far * kChannels + c];
    };
    // Pairs of fine texels whose coarse ones all exist; single ones before and behind.
    const int begin = std::min(x1, std::max(2, x0 + x0 % 2)),
              end = std::max(begin, std::min(x1, 2 * coarse.width - 2) / 2 * 2);
    for (int x = x0; x < begin; ++x) by_taps(x);
    for (int x = begin / 2; x < end / 2; ++x)
        for (int c = 0; c < kChannels; ++c) {
            const float* b = blend + x * kChannels + c;
            float* f = fine + (2 * x - x0) * kChannels + c;
            f[0] = kNear * b[0] + kFar * b[-kChannels];
            f[kChannels] = kNear * b[0] + kFar * b[kChannels];
        }
    for (int x = end; x < x1; ++x) by_taps(x);
}

/// Puts right the texels at borders among [x0, x1) of row y. fine: from x0 on.
void prolong_borders(const Prolongation& prolongation, const ChartBorders& borders,
                     const Image& coarse, int y, int x0, int x1, float* fine) {
    const auto row = row_of(borders, y);
    const Taps rows = taps_of(y, coarse.height, prolongation.repeats);
    auto t = std::lower_bound(row.begin(), row.end(), x0,
                              [](const ChartBorders::Texel& a, int x) { return a.x < x; });
    for (; t != row.end() && t->x < x1; ++t) {
        const Taps columns = taps_of(t->x, coarse.width, prolongation.repeats);
        for (int c = 0; c < coarse.channels; ++c)
            fine[(t->x - x0) * coarse.channels + c] =
                t->weight[0] * coarse.at(columns.near, rows.near, c) +
                t->weight[1] * coarse.at(columns.far, rows.near, c) +
                t->weight[2] * coarse.at(columns.near, rows.far, c) +
                t->weight[3] * coarse.at(columns.far, rows.far, c);
    }
}

std::size_t texel_of(int width, int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
}

}  // namespace

ChartMap halve(const ChartMap& charts, int width, int height) {
    ChartMap result;
    for (int y = 0; y < half(height); ++y)
        for (int x = 0; x < half(width); ++x) {
            std::array<std::uint32_t, 4> under{};
            for (std::size_t k = 0; k < 4; ++k) {
                const int fx = 2 * x + static_cast<int>(k % 2),
                          fy = 2 * y + static_cast<int>(k / 2);
                if (fx < width && fy < height) under[k] = charts[texel_of(width, fx, fy)];
            }
            std::uint32_t max = 0;
            std::ptrdiff_t votes = 0;
            for (const std::uint32_t chart : under)
                if (const auto n = std::count(under.begin(), under.end(), chart);
                    chart != 0 && n > votes)
                    max = chart, votes = n;
            result.push_back(max);
        }
    return result;
}

ChartBorders find_borders(const Prolongation& prolongation, const ChartMap& charts,
                          const ChartMap& coarse_charts, int width, int height) {
    ChartBorders borders;
    for (int y = 0; y < height; ++y) {
        borders.rows.push_back(borders.texels.size());
        const Taps rows = taps_of(y, half(height), prolongation.repeats);
        for (int x = 0; x < width; ++x) {
            const std::uint32_t chart = charts[texel_of(width, x, y)];
            const Taps columns = taps_of(x, half(width), prolongation.repeats);
            ChartBorders::Texel t{x, {kNear * kNear, kFar * kNear, kNear * kFar, kFar * kFar}};
            float sum = 0;
            for (std::size_t k = 0; k < 4; ++k) {
                const int cx = k % 2 == 0 ? columns.near : columns.far,
                          cy = k / 2 == 0 ? rows.near : rows.far;
                if (coarse_charts[texel_of(half(width), cx, cy)] != chart) t.weight[k] = 0;
                sum += t.weight[k];
            }
            if (chart == 0 || sum == 1) continue;
            if (sum > 0)
                for (float& weight : t.weight) weight /= sum;
            borders.texels.push_back(t);
        }
    }
    borders.rows.push_back(borders.texels.size());
    return borders;
}

void prolong(const Prolongation& prolongation, const ChartBorders& borders, const Image& coarse,
             int fine_width, std::size_t begin, std::size_t end, std::vector<float>& row,
             float* fine) {
    const auto channels = static_cast<std::size_t>(coarse.channels);
    row.resize(static_cast<std::size_t>(coarse.width) * channels);
    const auto row_by = coarse.channels == 1 ? prolong_row<1> : prolong_row<3>;
    for_rows(fine_width, begin / channels, end / channels, [&](int y, int x0, int x1) {
        row_by(prolongation, coarse, y, x0, x1, row.data(), fine);
        prolong_borders(prolongation, borders, coarse, y, x0, x1, fine);
        fine += static_cast<std::size_t>(x1 - x0) * channels;
    });
}

void mark_readers(const Prolongation& prolongation, const Image& coarse, std::size_t begin,
                  std::size_t end, const Image& fine, DirtyBlocks& flags) {
    const auto channels = static_cast<std::size_t>(coarse.channels);
    for_rows(coarse.width, begin / channels, end / channels, [&](int y, int x0, int x1) {
        for_readers(prolongation, y, fine.height, [&](int row) {
            const auto mark = [&](int from, int to) {
                mark_dirty(flags, fine.index(from, row), fine.index(to, row));
            };
            mark(std::max(0, 2 * x0 - 1), std::min(fine.width, 2 * x1 + 1));
            if (!prolongation.repeats) return;
            if (x0 == 0) mark(fine.width - 1, fine.width);
            if (x1 == coarse.width) mark(0, 1);
        });
    });
}

}  // namespace burnish
