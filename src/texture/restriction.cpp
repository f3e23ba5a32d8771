#include "texture/restriction.h"

#include <vector>

#include "core/parallel.h"
#include "texture/level_taps.h"

namespace burnish {

namespace {

/// to[i] += weight * from[i]
void add_scaled(float weight, const float* __restrict from, std::size_t count,
                float* __restrict to) {
    for (std::size_t i = 0; i < count; ++i) to[i] += weight * from[i];
}

/// One row of the restriction: a sum of fine rows to some coarse texels. Between the ends a coarse
/// texel is read by four fine ones.
template <int kChannels>
void restrict_row(const Prolongation& prolongation, const float* __restrict fine, int fine_width,
                  int coarse_width, const Columns& columns, float* __restrict coarse) {
    const auto by_weights = [&](int x) {
        std::fill_n(coarse + x * kChannels, kChannels, 0.0f);
        for_readers(prolongation, x, fine_width, [&](int fx) {
            const float weight = weight_of(taps_of(fx, coarse_width, prolongation.repeats), x);
            for (int c = 0; c < kChannels; ++c)
                coarse[x * kChannels + c] += weight * fine[fx * kChannels + c];
        });
    };
    const int inner = std::max(1, coarse_width - 1);
    if (columns.first == 0) by_weights(0);
    for (int x = std::max(1, columns.first); x < std::min(inner, columns.last); ++x)
        for (int c = 0; c < kChannels; ++c) {
            const float* f = fine + (2 * x - 1) * kChannels + c;
            coarse[x * kChannels + c] = kFar * f[0] + kNear * f[kChannels] +
                                        kNear * f[2 * kChannels] + kFar * f[3 * kChannels];
        }
    for (int x = std::max(inner, columns.first); x < columns.last; ++x) by_weights(x);
}

/// An interval of texels [x0, x1) of fine row y that may not be zero, and those at borders in it.
struct DirtyInterval {
    int y = 0, x0 = 0, x1 = 0;
    std::span<const ChartBorders::Texel> borders;
};

/// One half of a fine level's gradient, by rows.
struct FineRows {
    const KeptLevel& level;
    const Image& half;

    int width() const { return level.size.x; }
    std::size_t place_of(int y) const {
        return level.kept.place_of(static_cast<std::size_t>(y) *
                                   static_cast<std::size_t>(width() * level.channels));
    }
    const float* row(int y) const { return &half.values[place_of(y)]; }
};

/// The intervals of the fine rows that coarse row y reads.
void find_dirty_intervals(const Prolongation& prolongation, const ChartBorders& borders,
                          const FineRows& fine, const DirtyBlocks& flags, int y,
                          std::vector<DirtyInterval>& intervals) {
    intervals.clear();
    const int channels = fine.level.channels;
    for_readers(prolongation, y, fine.level.size.y, [&](int fy) {
        const std::size_t row = fine.place_of(fy);
        auto left = row_of(borders, fy);
        const auto add = [&](std::size_t begin, std::size_t end) {
            const int x0 = static_cast<int>(begin - row) / channels,
                      x1 = static_cast<int>(end - row) / channels;
            while (!left.empty() && left.front().x < x0) left = left.subspan(1);
            std::size_t inside = 0;
            while (inside < left.size() && left[inside].x < x1) ++inside;
            intervals.push_back({fy, x0, x1, left.first(inside)});
        };
        for_dirty_intervals(flags, row, row + static_cast<std::size_t>(fine.width() * channels),
                            add);
    });
}

/// The coarse columns that the intervals may read, in runs from left to right. dirty: work
/// memory.
template <int kChannels>
void find_columns(const Prolongation& prolongation, std::span<const DirtyInterval> intervals,
                  int fine_width, int coarse_width, DirtyBlocks& dirty,
                  std::vector<Columns>& runs) {
    const auto floats = static_cast<std::size_t>(coarse_width) * kChannels;
    dirty.assign(dirty_blocks_in(floats), 0);
    const auto touch = [&](const Columns& c) {
        mark_dirty(dirty, static_cast<std::size_t>(c.first) * kChannels,
                   static_cast<std::size_t>(c.last) * kChannels);
    };
    for (const DirtyInterval& s : intervals) {
        touch(columns_of(s.x0, s.x1, coarse_width));
        if (!prolongation.repeats) continue;
        if (s.x0 == 0) touch({coarse_width - 1, coarse_width});
        if (s.x1 == fine_width) touch({0, 1});
    }
    runs.clear();
    for_dirty_intervals(dirty, 0, floats, [&](std::size_t begin, std::size_t end) {
        runs.push_back({static_cast<int>(begin) / kChannels, static_cast<int>(end) / kChannels});
    });
}

/// The sum of the intervals, each by the weight of its row in coarse row y, without texels at
/// borders; right where coarse columns of the runs read it. inside: work memory for a row, like
/// `sum`.
template <int kChannels>
void add_rows(const Prolongation& prolongation, std::span<const DirtyInterval> intervals,
              std::span<const Columns> runs, const FineRows& fine, int y, int coarse_height,
              std::vector<float>& inside, std::vector<float>& sum) {
    const auto clear = [&](int x0, int x1) {
        const int begin = std::max(0, x0), end = std::min(fine.width(), x1);
        std::fill(sum.begin() + begin * kChannels, sum.begin() + end * kChannels, 0.0f);
    };
    for (const Columns& c : runs) clear(2 * c.first - 1, 2 * c.last + 1);
    clear(0, 4), clear(fine.width() - 4, fine.width());  // what the other end reads, if it repeats
    for (const DirtyInterval& s : intervals) {
        const int begin = s.x0 * kChannels;
        const auto count = static_cast<std::size_t>((s.x1 - s.x0) * kChannels);
        const float* from = fine.row(s.y) + begin;
        if (!s.borders.empty()) {
            std::copy_n(from, count, inside.data());
            for (const ChartBorders::Texel& t : s.borders)
                std::fill_n(&inside[static_cast<std::size_t>((t.x - s.x0) * kChannels)], kChannels,
                            0.0f);
            from = inside.data();
        }
        const float weight = weight_of(taps_of(s.y, coarse_height, prolongation.repeats), y);
        add_scaled(weight, from, count, sum.data() + begin);
    }
}

/// Adds to row y of a coarse level of `size` what the texels at borders give to it.
template <int kChannels>
void add_borders(const Prolongation& prolongation, std::span<const DirtyInterval> intervals,
                 const FineRows& fine, int y, Vec2<int> size, float* coarse) {
    for (const DirtyInterval& s : intervals) {
        const Taps rows = taps_of(s.y, size.y, prolongation.repeats);
        for (const ChartBorders::Texel& t : s.borders) {
            const Taps columns = taps_of(t.x, size.x, prolongation.repeats);
            const float* from = fine.row(s.y) + t.x * kChannels;
            const auto give = [&](int x, float weight) {
                for (int c = 0; c < kChannels; ++c) coarse[x * kChannels + c] += weight * from[c];
            };
            if (rows.near == y) give(columns.near, t.weight[0]), give(columns.far, t.weight[1]);
            if (rows.far == y) give(columns.near, t.weight[2]), give(columns.far, t.weight[3]);
        }
    }
}

/// Writes the blocks of a part of a row that are not zero to an image that is, from float `at`
/// on, and marks them.
void write_dirty(std::span<const float> row, std::size_t at, Image& image, DirtyBlocks& dirty) {
    for (std::size_t i = 0; i < row.size();) {
        const std::size_t end =
            std::min(row.size(), ((at + i) / kDirtyBlock + 1) * kDirtyBlock - at);
        if (any_nonzero(&row[i], end - i)) {
            std::copy_n(&row[i], end - i, &image.values[at + i]);
            mark_dirty(dirty, at + i, at + end);
        }
        i = end;
    }
}

/// The same for those of its floats that are kept. at: in the level.
void write_kept(std::span<const float> row, std::size_t at, const KeptBlocks& kept, Image& image,
                DirtyBlocks& dirty) {
    for (const IndexRange& range : kept.ranges) {
        const IndexRange part = overlap(range, {at, at + row.size()});
        if (part.size() > 0)
            write_dirty(row.subspan(part.begin - at, part.size()), kept.place_of(part.begin), image,
                        dirty);
    }
}

/// Whether any float of a row is kept.
bool keeps_row(const KeptLevel& level, int y) {
    const std::size_t floats = static_cast<std::size_t>(level.size.x * level.channels);
    const std::size_t begin = static_cast<std::size_t>(y) * floats;
    return std::any_of(level.kept.ranges.begin(), level.kept.ranges.end(), [&](const auto& r) {
        return overlap(r, {begin, begin + floats}).size() > 0;
    });
}

template <int kChannels>
void restrict_channels(const Prolongation& prolongation, const ChartBorders& borders,
                       const KeptLevel& fine_level, const SplitGradient& fine,
                       const KeptLevel& coarse_level, SplitGradient& coarse) {
    const Vec2<int> size = coarse_level.size;
    const FineRows first{fine_level, fine.first}, second{fine_level, fine.second};
    parallel_chunks(static_cast<std::size_t>(size.y), 8, [&](std::size_t begin, std::size_t end) {
        std::vector<DirtyInterval> intervals;
        DirtyBlocks dirty;
        std::vector<Columns> runs;
        std::vector<float> sum(static_cast<std::size_t>(first.width()) * kChannels),
            inside(sum.size()), down(static_cast<std::size_t>(size.x) * kChannels);
        for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
            const auto half_down = [&](const FineRows& from, Image& to) {
                add_rows<kChannels>(prolongation, intervals, runs, from, y, size.y, inside, sum);
                for (const Columns& c : runs)
                    restrict_row<kChannels>(prolongation, sum.data(), from.width(), size.x, c,
                                            down.data());
                add_borders<kChannels>(prolongation, intervals, from, y, size, down.data());
                for (const Columns& c : runs) {
                    const auto x0 = static_cast<std::size_t>(c.first * kChannels),
                               count = static_cast<std::size_t>((c.last - c.first) * kChannels);
                    write_kept(std::span(down).subspan(x0, count),
                               static_cast<std::size_t>(y) * down.size() + x0, coarse_level.kept,
                               to, coarse.dirty);
                }
            };
            if (!keeps_row(coarse_level, y)) continue;
            find_dirty_intervals(prolongation, borders, first, fine.dirty, y, intervals);
            if (intervals.empty()) continue;
            find_columns<kChannels>(prolongation, intervals, first.width(), size.x, dirty, runs);
            half_down(first, coarse.first);
            if (fine.second.width > 0) half_down(second, coarse.second);
        }
    });
}

}  // namespace

void restrict_gradient(const Prolongation& prolongation, const ChartBorders& borders,
                       const KeptLevel& fine_level, const SplitGradient& fine,
                       const KeptLevel& coarse_level, SplitGradient& coarse) {
    clear(coarse, static_cast<int>(coarse_level.kept.size()), 1, 1, fine.second.width > 0);
    (fine_level.channels == 1 ? restrict_channels<1> : restrict_channels<3>)(prolongation, borders,
                                                                             fine_level, fine,
                                                                             coarse_level, coarse);
}

}  // namespace burnish
