#include "texture/unvisited.h"

#include <algorithm>
#include <utility>

#include "core/parallel.h"
#include "texture/level_taps.h"
#include "texture/prolongation.h"

namespace burnish {

namespace {

/// A level of a pyramid: values of the texels that are known, which ones are, and their charts.
struct KnownTexels {
    Image values;
    std::vector<char> known;
    ChartMap charts;

    std::size_t texel(int x, int y) const {
        return values.index(x, y) / static_cast<std::size_t>(values.channels);
    }
};

/// Half the resolution: the mean of what is known, of its chart, among four.
KnownTexels push(const KnownTexels& fine) {
    const Image& f = fine.values;
    KnownTexels coarse{make_image(half(f.width), half(f.height), f.channels),
                       {},
                       halve(fine.charts, f.width, f.height)};
    Image& to = coarse.values;
    std::vector<float> counts(coarse.charts.size());
    for (int y = 0; y < f.height; ++y)
        for (int x = 0; x < f.width; ++x) {
            const std::size_t from = fine.texel(x, y), at = coarse.texel(x / 2, y / 2);
            if (!fine.known[from] || fine.charts[from] != coarse.charts[at]) continue;
            for (int c = 0; c < f.channels; ++c) to.at(x / 2, y / 2, c) += f.at(x, y, c);
            counts[at] += 1;
        }
    for (std::size_t i = 0; i < to.values.size(); ++i)
        to.values[i] /= std::max(1.0f, counts[i / static_cast<std::size_t>(to.channels)]);
    for (const float count : counts) coarse.known.push_back(count > 0);
    return coarse;
}

/// Fills in what is not known, bilinearly from what is known of the same chart in a coarser level.
void pull(const KnownTexels& coarse, bool repeats, KnownTexels& fine) {
    Image& values = fine.values;
    const Image& from = coarse.values;
    parallel_for(static_cast<std::size_t>(values.height), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        const Taps ty = taps_of(y, from.height, repeats);
        for (int x = 0; x < values.width; ++x) {
            const std::size_t at = fine.texel(x, y);
            if (fine.known[at]) continue;
            const Taps tx = taps_of(x, from.width, repeats);
            Rgbf sum;
            float weights = 0;
            for (int k = 0; k < 4; ++k) {
                const int cx = k % 2 == 0 ? tx.near : tx.far, cy = k / 2 == 0 ? ty.near : ty.far;
                const std::size_t texel = coarse.texel(cx, cy);
                if (!coarse.known[texel] || coarse.charts[texel] != fine.charts[at]) continue;
                const float weight = (k % 2 == 0 ? kNear : kFar) * (k / 2 == 0 ? kNear : kFar);
                for (int c = 0; c < from.channels; ++c) sum[c] += weight * from.at(cx, cy, c);
                weights += weight;
            }
            if (weights == 0) continue;
            for (int c = 0; c < from.channels; ++c) values.at(x, y, c) = sum[c] / weights;
            fine.known[at] = 1;
        }
    });
}

/// Fills what is in reach of something known of its chart.
void fill(KnownTexels& finest, bool repeats) {
    if (std::find(finest.known.begin(), finest.known.end(), 0) == finest.known.end()) return;
    std::vector<KnownTexels> levels{std::move(finest)};
    while (levels.back().known.size() > 1) levels.push_back(push(levels.back()));
    for (std::size_t i = levels.size() - 1; i-- > 0;) pull(levels[i + 1], repeats, levels[i]);
    finest = std::move(levels[0]);
}

/// Calls body(texel) for the eight around a texel; for fewer at borders of what does not repeat.
template <class Body>
void for_neighbours(const Image& image, std::size_t texel, bool repeats, const Body& body) {
    const auto width = static_cast<std::size_t>(image.width);
    const int x = static_cast<int>(texel % width), y = static_cast<int>(texel / width);
    const auto around = [&](int i, int size) {
        return !repeats ? i : i < 0 ? size - 1 : i == size ? 0 : i;
    };
    for (const int ny : {around(y - 1, image.height), y, around(y + 1, image.height)})
        for (const int nx : {around(x - 1, image.width), x, around(x + 1, image.width)})
            if (nx >= 0 && nx < image.width && ny >= 0 && ny < image.height && (nx != x || ny != y))
                body(static_cast<std::size_t>(ny) * width + static_cast<std::size_t>(nx));
}

/// Gives a texel the mean of those around it that are known of its chart; there is one. In double
/// precision, in which the mean of equal values is that value.
void take_mean(KnownTexels& level, std::size_t texel, bool repeats) {
    const auto channels = static_cast<std::size_t>(level.values.channels);
    std::vector<float>& values = level.values.values;
    Vec3<double> sum;
    double count = 0;
    for_neighbours(level.values, texel, repeats, [&](std::size_t k) {
        if (!level.known[k] || level.charts[k] != level.charts[texel]) return;
        for (std::size_t c = 0; c < channels; ++c)
            sum[static_cast<int>(c)] += double{values[channels * k + c]};
        count += 1;
    });
    for (std::size_t c = 0; c < channels; ++c)
        values[channels * texel + c] = static_cast<float>(sum[static_cast<int>(c)] / count);
}

/// Fills the texels of no chart, which become part of the nearest one, ring by ring around all of
/// them at once.
void pad_charts(KnownTexels& level, bool repeats) {
    const auto is_free = [&](std::size_t i) { return !level.known[i] && level.charts[i] == 0; };
    std::vector<std::size_t> ring, next;
    for (std::size_t i = 0; i < level.known.size(); ++i) {
        bool is_border = false;
        if (level.known[i] && level.charts[i] != 0)
            for_neighbours(level.values, i, repeats,
                           [&](std::size_t k) { is_border |= is_free(k); });
        if (is_border) ring.push_back(i);
    }
    while (!ring.empty()) {
        next.clear();
        for (const std::size_t i : ring)
            for_neighbours(level.values, i, repeats, [&](std::size_t k) {
                if (!is_free(k)) return;
                level.charts[k] = level.charts[i];
                next.push_back(k);
            });
        for (const std::size_t i : next) take_mean(level, i, repeats);
        for (const std::size_t i : next) level.known[i] = 1;
        std::swap(ring, next);
    }
}

}  // namespace

void fill_unvisited(const std::vector<std::uint32_t>& visits, const ChartMap& charts, bool repeats,
                    Image& texels) {
    KnownTexels finest{std::move(texels), {}, charts};
    for (const std::uint32_t count : visits) finest.known.push_back(count > 0);
    if (!charts.empty()) fill(finest, repeats), pad_charts(finest, repeats);
    // Charts of which nothing is known, and those that the coarse levels lost sight of.
    finest.charts.assign(visits.size(), 1);
    fill(finest, repeats);
    texels = std::move(finest.values);
}

std::size_t count_unvisited(const std::vector<std::uint32_t>& visits, const ChartMap& charts) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < visits.size(); ++i) count += visits[i] == 0 && charts[i] > 0;
    return count;
}

void keep_unvisited(const std::vector<std::uint32_t>& visits, std::span<const float> initial,
                    Image& texels) {
    const auto channels = static_cast<std::size_t>(texels.channels);
    for (std::size_t i = 0; i < texels.values.size(); ++i)
        if (visits[i / channels] == 0) texels.values[i] = initial[i];
}

}  // namespace burnish
