#include "optimize/search_bounces.h"

#include <cmath>
#include <numeric>
#include <utility>

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

double loss_of(std::span<const SearchFrame> frames, const TextureTable& textures) {
    double loss = 0;
    for (const SearchFrame& f : frames) {
        const std::vector<SearchTile> tiles = make_search_tiles(f);
        std::vector<double> losses(tiles.size());
        parallel_for(tiles.size(),
                     [&](std::size_t i) { losses[i] = tile_loss(f, tiles[i], textures); });
        loss = std::accumulate(losses.begin(), losses.end(), loss);
    }
    return loss;
}

/// The unknowns that are not searched as they are, those that are as found, colours drawn so far
/// towards 0.5 that this share of the way is left.
Theta theta_at(const SearchPlan& plan, const std::vector<Image>& textures, float share) {
    Theta theta;
    if (plan.others)
        for (const ThetaTexture& t : plan.others->textures)
            theta.textures.push_back({t.texture, copy_of(t.values)});
    for (std::size_t i = 0; i < textures.size(); ++i) {
        Image values = copy_of(textures[i]);
        if (plan.colors[i])
            for (float& v : values.values) v = 0.5f + share * (v - 0.5f);
        theta.textures.push_back({plan.unknowns[i], std::move(values)});
    }
    return theta;
}

}  // namespace

void draw_back_colors(const SearchPlan& plan, std::span<const SearchView> views,
                      std::vector<Image>& textures) {
    constexpr std::uint32_t kPasses = 4;
    const Scene& scene = *views.front().scene.scene;
    std::vector<SearchFrame> frames = make_search_frames(plan, views);
    draw_passes(frames, seed_of_half(plan.seed, 3), kPasses);
    Theta best = theta_at(plan, textures, 1);
    double least = loss_of(frames, texture_table(scene, best));
    for (const float share : {0.75f, 0.5f, 0.25f, 0.0f}) {
        Theta theta = theta_at(plan, textures, share);
        const double loss = loss_of(frames, texture_table(scene, theta));
        if (!(loss < least)) break;
        least = loss, best = std::move(theta);
    }
    const std::size_t first = best.textures.size() - textures.size();
    for (std::size_t i = 0; i < textures.size(); ++i)
        textures[i] = std::move(best.textures[first + i].values);
}

}  // namespace burnish
