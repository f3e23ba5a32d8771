#include "texture/regions.h"

#include <algorithm>

namespace burnish {

namespace {

int blocks_across(const TextureRegions& r) { return (r.width + r.side - 1) / r.side; }
int blocks_down(const TextureRegions& r) { return (r.height + r.side - 1) / r.side; }

/// f(texel) for those of a block.
void for_block(const TextureRegions& r, int bx, int by, const auto& f) {
    for (int y = by * r.side; y < std::min((by + 1) * r.side, r.height); ++y)
        for (int x = bx * r.side; x < std::min((bx + 1) * r.side, r.width); ++x)
            f(static_cast<std::size_t>(y) * static_cast<std::size_t>(r.width) +
              static_cast<std::size_t>(x));
}

/// Numbers the charts of a block; their texels get the region's number. last: of each chart its
/// last region.
void add_block(const ChartMap& charts, int bx, int by, std::vector<std::uint32_t>& last,
               TextureRegions& r) {
    const auto begin = static_cast<std::uint32_t>(r.regions.size());
    r.first.push_back(begin);
    for_block(r, bx, by, [&](std::size_t texel) {
        const std::uint32_t chart = charts[texel];
        if (chart == 0) return;
        if (last[chart] == TextureRegions::kNone || last[chart] < begin) {
            last[chart] = static_cast<std::uint32_t>(r.regions.size());
            r.regions.push_back({bx, by, chart});
        }
        r.of_texel[texel] = last[chart];
    });
    if (r.regions.size() - begin <= TextureRegions::kMaxCharts) return;
    r.regions.resize(begin);
    r.regions.push_back({bx, by, Region::kJoined});
    for_block(r, bx, by, [&](std::size_t texel) {
        if (charts[texel] == 0) return;
        r.of_texel[texel] = begin;
        last[charts[texel]] = TextureRegions::kNone;
    });
}

struct Mean {
    double sum = 0, count = 0;

    void add(float v) { sum += double{v}, count += 1; }
    float value_or(float otherwise) const {
        return count > 0 ? static_cast<float>(sum / count) : otherwise;
    }
};

}  // namespace

TextureRegions make_regions(const ChartMap& charts, int width, int height, int side) {
    TextureRegions r;
    r.width = width, r.height = height, r.side = side;
    r.of_texel.assign(charts.size(), TextureRegions::kNone);
    const std::uint32_t max = charts.empty() ? 0 : std::ranges::max(charts);
    std::vector<std::uint32_t> last(std::size_t{max} + 1, TextureRegions::kNone);
    for (int y = 0; y < blocks_down(r); ++y)
        for (int x = 0; x < blocks_across(r); ++x) add_block(charts, x, y, last, r);
    r.first.push_back(static_cast<std::uint32_t>(r.regions.size()));
    return r;
}

std::vector<std::uint32_t> neighbours(const TextureRegions& r, std::uint32_t region) {
    const Region& centre = r.regions[region];
    const int across = blocks_across(r), down = blocks_down(r);
    std::vector<std::uint32_t> found;
    for (int y = std::max(0, centre.y - 1); y <= std::min(down - 1, centre.y + 1); ++y)
        for (int x = std::max(0, centre.x - 1); x <= std::min(across - 1, centre.x + 1); ++x) {
            const auto block = static_cast<std::size_t>(y) * static_cast<std::size_t>(across) +
                               static_cast<std::size_t>(x);
            for (std::uint32_t i = r.first[block]; i < r.first[block + 1]; ++i)
                if (i != region && r.regions[i].chart == centre.chart) found.push_back(i);
        }
    return found;
}

void fill_regions(const TextureRegions& r, std::vector<char> known, float otherwise,
                  std::vector<float>& values) {
    Mean all;
    std::vector<std::uint32_t> open;
    for (std::uint32_t i = 0; i < values.size(); ++i)
        known[i] ? all.add(values[i]) : open.push_back(i);
    while (!open.empty()) {
        std::vector<std::uint32_t> later;
        std::vector<std::pair<std::uint32_t, float>> ring;
        for (const std::uint32_t i : open) {
            Mean around;
            for (const std::uint32_t n : neighbours(r, i))
                if (known[n]) around.add(values[n]);
            if (around.count > 0)
                ring.emplace_back(i, around.value_or(0));
            else
                later.push_back(i);
        }
        if (ring.empty()) break;
        for (const auto& [i, value] : ring) values[i] = value, known[i] = 1;
        open = std::move(later);
    }
    for (const std::uint32_t i : open) values[i] = all.value_or(otherwise);
}

}  // namespace burnish
