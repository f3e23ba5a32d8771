#include "optimize/search_bounces.h"

#include <cmath>
#include <numeric>

#include "core/constants.h"
#include "core/parallel.h"
#include "image/image.h"
#include "optimize/search_samples.h"

namespace burnish {

namespace {

/// What a tile loses: the product of both halves' residuals, whose noise averages out.
double tile_loss(const SearchFrame& f, const SearchTile& t, const TextureTable& textures) {
    const auto [a, b] = render_tile(f, t, textures);
    double loss = 0;
    for (const int square : t.squares)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t own = 3 * static_cast<std::size_t>(square) + c;
            const std::size_t at = 3 * frame_index(f, t.tile, square) + c;
            const double target = double{f.target[at]};
            const double product = (double{a[own]} - target) * (double{b[own]} - target);
            if (std::isfinite(product)) loss += double{f.weight[at]} * product;
        }
    return loss;
}

double loss_of(std::span<const ViewTile> tiles, const TextureTable& textures) {
    std::vector<double> losses(tiles.size());
    parallel_for(tiles.size(), [&](std::size_t i) {
        losses[i] = tile_loss(*tiles[i].frame, tiles[i].tile, textures);
    });
    return std::accumulate(losses.begin(), losses.end(), 0.0);
}

/// So far towards 0.5 that this share of the way is left.
void draw_back(float share, const Image& found, Image& color) {
    for (std::size_t i = 0; i < found.values.size(); ++i)
        color.values[i] = 0.5f + share * (found.values[i] - 0.5f);
}

}  // namespace

void draw_back_colors(std::span<SearchFrame> frames, std::vector<Image>& textures) {
    constexpr std::uint32_t kPasses = 4;
    const SearchPlan& plan = frames.front().plan;
    draw_passes(frames, seed_of_half(plan.seed, 3), kPasses);
    const std::vector<ViewTile> tiles = make_view_tiles(frames);
    Theta theta;
    for (std::size_t i = 0; i < textures.size(); ++i)
        theta.textures.push_back({plan.unknowns[i], copy_of(textures[i])});
    if (plan.others)
        for (const ThetaTexture& t : plan.others->textures)
            theta.textures.push_back({t.texture, copy_of(t.values)});
    const TextureTable table = texture_table(*frames.front().view.scene.scene, theta);
    const auto draw = [&](float share, std::size_t i, Image& color) {
        if (plan.colors[i]) draw_back(share, textures[i], color);
    };
    float best = 1;
    double min = kInfinity;
    for (const float share : {1.0f, 0.75f, 0.5f, 0.25f, 0.0f}) {
        for (std::size_t i = 0; i < textures.size(); ++i) draw(share, i, theta.textures[i].values);
        const double loss = loss_of(tiles, table);
        if (!(loss < min)) break;
        min = loss, best = share;
    }
    for (std::size_t i = 0; i < textures.size(); ++i) draw(best, i, textures[i]);
}

}  // namespace burnish
