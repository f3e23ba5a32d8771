#include "texture/prolongation.h"

#include <algorithm>
#include <span>

#include "core/parallel.h"

namespace burnish {

namespace {

/// The two coarse texels that a fine one reads on an axis.
struct Taps {
    int near = 0, far = 0;
};

Taps taps_of(int fine, int coarse_size, bool repeats) {
    const int near = fine / 2, far = fine % 2 == 0 ? near - 1 : near + 1;
    if (far < 0) return {near, repeats ? coarse_size - 1 : 0};
    if (far == coarse_size) return {near, repeats ? 0 : coarse_size - 1};
    return {near, far};
}

struct TapWeights {
    float near = 0, far = 0;
};

TapWeights weights_of(const Prolongation& prolongation) {
    return prolongation.kind == Upsampling::kBilinear ? TapWeights{0.75f, 0.25f}
                                                   : TapWeights{1.0f, 0.0f};
}

float weight_of(const TapWeights& weights, const Taps& taps, int coarse) {
    return (taps.near == coarse ? weights.near : 0.0f) + (taps.far == coarse ? weights.far : 0.0f);
}

/// Calls body(fine) for each texel of an axis, once, that may read a coarse one.
template <class Body>
void for_readers(const Prolongation& prolongation, int coarse, int fine_size, const Body& body) {
    const int begin = 2 * coarse - 1, end = 2 * coarse + 3;
    if (prolongation.repeats && fine_size > end - begin)
        for (int i = begin; i < end; ++i) body((i + fine_size) % fine_size);
    else if (prolongation.repeats)
        for (int i = 0; i < fine_size; ++i) body(i);
    else
        for (int i = std::max(0, begin); i < std::min(fine_size, end); ++i) body(i);
}

const float* row_of(const Image& image, int y) { return &image.values[image.index(0, y)]; }

std::span<const ChartBorders::Texel> row_of(const ChartBorders& borders, int y) {
    if (borders.rows.empty()) return {};
    const auto row = static_cast<std::size_t>(y);
    return std::span(borders.texels)
        .subspan(borders.rows[row], borders.rows[row + 1] - borders.rows[row]);
}

/// to[i] += weight * from[i]
void add_scaled(float weight, const float* __restrict from, std::size_t count,
                float* __restrict to) {
    for (std::size_t i = 0; i < count; ++i) to[i] += weight * from[i];
}

/// The coarse columns [first, last).
struct Columns {
    int first = 0, last = 0;
};

/// The coarse columns that fine ones [x0, x1) may read, but for those at the other end of a level
/// that repeats.
Columns columns_of(int x0, int x1, int coarse_width) {
    return {std::max(0, x0 / 2 - 1), std::min(coarse_width, (x1 + 1) / 2 + 1)};
}

/// One row of restrict_level: a sum of fine rows to some coarse texels. Between the ends a coarse texel
/// is read by four fine ones.
template <int kChannels>
void restrict_row(const Prolongation& prolongation, const float* __restrict fine, int fine_width,
                  int coarse_width, const Columns& columns, float* __restrict coarse) {
    const TapWeights w = weights_of(prolongation);
    const auto by_weights = [&](int x) {
        std::fill_n(coarse + x * kChannels, kChannels, 0.0f);
        for_readers(prolongation, x, fine_width, [&](int fx) {
            const float weight = weight_of(w, taps_of(fx, coarse_width, prolongation.repeats), x);
            for (int c = 0; c < kChannels; ++c)
                coarse[x * kChannels + c] += weight * fine[fx * kChannels + c];
        });
    };
    const int inner = std::max(1, coarse_width - 1);
    if (columns.first == 0) by_weights(0);
    for (int x = std::max(1, columns.first); x < std::min(inner, columns.last); ++x)
        for (int c = 0; c < kChannels; ++c) {
            const float* f = fine + (2 * x - 1) * kChannels + c;
            coarse[x * kChannels + c] = w.far * f[0] + w.near * f[kChannels] +
                                        w.near * f[2 * kChannels] + w.far * f[3 * kChannels];
        }
    for (int x = std::max(inner, columns.first); x < columns.last; ++x) by_weights(x);
}

/// A stretch of texels [x0, x1) of fine row y that may not be zero, and those at borders in it.
struct DirtyInterval {
    int y = 0, x0 = 0, x1 = 0;
    std::span<const ChartBorders::Texel> borders;
};

/// The intervals of the fine rows that coarse row y reads.
void find_dirty_intervals(const Prolongation& prolongation, const ChartBorders& borders,
                    const SplitGradient& fine, int y, std::vector<DirtyInterval>& intervals) {
    intervals.clear();
    const Image& image = fine.first;
    for_readers(prolongation, y, image.height, [&](int fy) {
        const std::size_t row = image.index(0, fy);
        auto left = row_of(borders, fy);
        const auto add = [&](std::size_t begin, std::size_t end) {
            const int x0 = static_cast<int>(begin - row) / image.channels,
                      x1 = static_cast<int>(end - row) / image.channels;
            while (!left.empty() && left.front().x < x0) left = left.subspan(1);
            std::size_t inside = 0;
            while (inside < left.size() && left[inside].x < x1) ++inside;
            intervals.push_back({fy, x0, x1, left.first(inside)});
        };
        for_dirty_intervals(fine.reached, row, row + image.index(0, 1), add);
    });
}

/// The coarse columns that the intervals may read, in runs from left to right. touched: work
/// memory.
template <int kChannels>
void find_columns(const Prolongation& prolongation, std::span<const DirtyInterval> intervals, int fine_width,
                  int coarse_width, DirtyBlocks& touched, std::vector<Columns>& runs) {
    const auto floats = static_cast<std::size_t>(coarse_width) * kChannels;
    touched.assign(dirty_blocks_in(floats), 0);
    const auto touch = [&](const Columns& c) {
        mark_dirty(touched, static_cast<std::size_t>(c.first) * kChannels,
                     static_cast<std::size_t>(c.last) * kChannels);
    };
    for (const DirtyInterval& s : intervals) {
        touch(columns_of(s.x0, s.x1, coarse_width));
        if (!prolongation.repeats) continue;
        if (s.x0 == 0) touch({coarse_width - 1, coarse_width});
        if (s.x1 == fine_width) touch({0, 1});
    }
    runs.clear();
    for_dirty_intervals(touched, 0, floats, [&](std::size_t begin, std::size_t end) {
        runs.push_back({static_cast<int>(begin) / kChannels, static_cast<int>(end) / kChannels});
    });
}

/// The sum of the intervals, each by the weight of its row in coarse row y, without texels at
/// borders; right where coarse columns of the runs read it. inside: work memory for a row, like
/// `sum`.
template <int kChannels>
void add_rows(const Prolongation& prolongation, std::span<const DirtyInterval> intervals,
              std::span<const Columns> runs, const Image& fine, int y, int coarse_height,
              std::vector<float>& inside, std::vector<float>& sum) {
    const TapWeights w = weights_of(prolongation);
    const auto clear = [&](int x0, int x1) {
        const int begin = std::max(0, x0), end = std::min(fine.width, x1);
        std::fill(sum.begin() + begin * kChannels, sum.begin() + end * kChannels, 0.0f);
    };
    for (const Columns& c : runs) clear(2 * c.first - 1, 2 * c.last + 1);
    clear(0, 4), clear(fine.width - 4, fine.width);  // what the other end reads, if it repeats
    for (const DirtyInterval& s : intervals) {
        const int begin = s.x0 * kChannels;
        const auto count = static_cast<std::size_t>((s.x1 - s.x0) * kChannels);
        const float* from = row_of(fine, s.y) + begin;
        if (!s.borders.empty()) {
            std::copy_n(from, count, inside.data());
            for (const ChartBorders::Texel& t : s.borders)
                std::fill_n(&inside[static_cast<std::size_t>((t.x - s.x0) * kChannels)], kChannels,
                            0.0f);
            from = inside.data();
        }
        const float weight = weight_of(w, taps_of(s.y, coarse_height, prolongation.repeats), y);
        add_scaled(weight, from, count, sum.data() + begin);
    }
}

/// Adds to row y of a coarse level of `size` what the texels at borders give to it.
template <int kChannels>
void add_borders(const Prolongation& prolongation, std::span<const DirtyInterval> intervals, const Image& fine,
                 int y, Vec2<int> size, float* coarse) {
    for (const DirtyInterval& s : intervals) {
        const Taps rows = taps_of(s.y, size.y, prolongation.repeats);
        for (const ChartBorders::Texel& t : s.borders) {
            const Taps columns = taps_of(t.x, size.x, prolongation.repeats);
            const float* from = row_of(fine, s.y) + t.x * kChannels;
            const auto give = [&](int x, float weight) {
                for (int c = 0; c < kChannels; ++c) coarse[x * kChannels + c] += weight * from[c];
            };
            if (rows.near == y) give(columns.near, t.weight[0]), give(columns.far, t.weight[1]);
            if (rows.far == y) give(columns.near, t.weight[2]), give(columns.far, t.weight[3]);
        }
    }
}

/// Writes the segments of a part of a row that are not zero to an image that is, from float `at`
/// on, and marks them.
void write_reached(std::span<const float> row, std::size_t at, Image& image,
                   DirtyBlocks& reached) {
    for (std::size_t i = 0; i < row.size();) {
        const std::size_t end = std::min(row.size(), ((at + i) / kDirtyBlock + 1) * kDirtyBlock - at);
        if (any_nonzero(&row[i], end - i)) {
            std::copy_n(&row[i], end - i, &image.values[at + i]);
            mark_dirty(reached, at + i, at + end);
        }
        i = end;
    }
}

template <int kChannels>
void restrict_channels(const Prolongation& prolongation, const ChartBorders& borders,
                       const SplitGradient& fine, SplitGradient& coarse) {
    const Vec2<int> size{coarse.first.width, coarse.first.height};
    parallel_chunks(static_cast<std::size_t>(size.y), 8, [&](std::size_t begin, std::size_t end) {
        std::vector<DirtyInterval> intervals;
        DirtyBlocks touched;
        std::vector<Columns> runs;
        std::vector<float> sum(static_cast<std::size_t>(fine.first.width) * kChannels),
            inside(sum.size()), down(static_cast<std::size_t>(size.x) * kChannels);
        for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
            find_dirty_intervals(prolongation, borders, fine, y, intervals);
            const auto half_down = [&](const Image& from, Image& to) {
                add_rows<kChannels>(prolongation, intervals, runs, from, y, size.y, inside, sum);
                for (const Columns& c : runs)
                    restrict_row<kChannels>(prolongation, sum.data(), from.width, size.x, c,
                                            down.data());
                add_borders<kChannels>(prolongation, intervals, from, y, size, down.data());
                for (const Columns& c : runs)
                    write_reached(std::span(down).subspan(
                                      static_cast<std::size_t>(c.first) * kChannels,
                                      static_cast<std::size_t>(c.last - c.first) * kChannels),
                                  to.index(c.first, y), to, coarse.reached);
            };
            if (intervals.empty()) continue;
            find_columns<kChannels>(prolongation, intervals, fine.first.width, size.x, touched, runs);
            half_down(fine.first, coarse.first);
            if (fine.second.width > 0) half_down(fine.second, coarse.second);
        }
    });
}

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

/// Texels [x0, x1) of row y of the coarse level, upsampled to the fine one. blend: work memory for
/// a coarse row. fine: from x0 on.
template <int kChannels>
void prolong_row(const Prolongation& prolongation, const Image& coarse, int y, int x0, int x1,
                  float* __restrict blend, float* __restrict fine) {
    const TapWeights w = weights_of(prolongation);
    const Taps rows = taps_of(y, coarse.height, prolongation.repeats);
    const float* __restrict near = row_of(coarse, rows.near);
    const float* __restrict far = row_of(coarse, rows.far);
    const auto blend_texels = [&](int from, int to) {
        for (int i = from * kChannels; i < to * kChannels; ++i)
            blend[i] = w.near * near[i] + w.far * far[i];
    };
    const auto [first, last] = columns_of(x0, x1, coarse.width);
    blend_texels(first, last);
    if (prolongation.repeats) blend_texels(0, 1), blend_texels(coarse.width - 1, coarse.width);
    const auto by_taps = [&](int x) {
        const Taps t = taps_of(x, coarse.width, prolongation.repeats);
        for (int c = 0; c < kChannels; ++c)
            fine[(x - x0) * kChannels + c] =
                w.near * blend[t.near * kChannels + c] + w.far * blend[t.far * kChannels + c];
    };
    // Pairs of fine texels whose coarse ones all exist; single ones before and behind.
    const int begin = std::min(x1, std::max(2, x0 + x0 % 2)),
              end = std::max(begin, std::min(x1, 2 * coarse.width - 2) / 2 * 2);
    for (int x = x0; x < begin; ++x) by_taps(x);
    for (int x = begin / 2; x < end / 2; ++x)
        for (int c = 0; c < kChannels; ++c) {
            const float* b = blend + x * kChannels + c;
            float* f = fine + (2 * x - x0) * kChannels + c;
            f[0] = w.near * b[0] + w.far * b[-kChannels];
            f[kChannels] = w.near * b[0] + w.far * b[kChannels];
        }
    for (int x = end; x < x1; ++x) by_taps(x);
}

/// Puts right the texels at borders among [x0, x1) of row y. fine: from x0 on.
void upsample_borders(const Prolongation& prolongation, const ChartBorders& borders, const Image& coarse,
                      int y, int x0, int x1, float* fine) {
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
            std::uint32_t most = 0;
            std::ptrdiff_t votes = 0;
            for (const std::uint32_t chart : under)
                if (const auto n = std::count(under.begin(), under.end(), chart);
                    chart != 0 && n > votes)
                    most = chart, votes = n;
            result.push_back(most);
        }
    return result;
}

ChartBorders find_borders(const Prolongation& prolongation, const ChartMap& charts,
                          const ChartMap& coarse_charts, int width, int height) {
    const TapWeights w = weights_of(prolongation);
    ChartBorders borders;
    for (int y = 0; y < height; ++y) {
        borders.rows.push_back(borders.texels.size());
        const Taps rows = taps_of(y, half(height), prolongation.repeats);
        for (int x = 0; x < width; ++x) {
            const std::uint32_t chart = charts[texel_of(width, x, y)];
            const Taps columns = taps_of(x, half(width), prolongation.repeats);
            ChartBorders::Texel t{x,
                                  {w.near * w.near, w.far * w.near, w.near * w.far, w.far * w.far}};
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
        upsample_borders(prolongation, borders, coarse, y, x0, x1, fine);
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

void restrict_level(const Prolongation& prolongation, const ChartBorders& borders, const SplitGradient& fine,
              SplitGradient& coarse) {
    const Image& first = fine.first;
    clear(coarse, half(first.width), half(first.height), first.channels, fine.second.width > 0);
    (first.channels == 1 ? restrict_channels<1> : restrict_channels<3>)(prolongation, borders, fine,
                                                                        coarse);
}

}  // namespace burnish
