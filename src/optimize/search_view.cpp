#include "optimize/search_view.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>

#include "core/parallel.h"
#include "gradient/theta.h"
#include "image/quality.h"
#include "optimize/exposure.h"
#include "optimize/loss.h"
#include "render/film.h"
#include "render/visible_pixels.h"
#include "shading/filter.h"

namespace burnish {

namespace {

/// The group that reads a texture, -1: none.
int group_of(const SearchFrame& f, TextureId texture) {
    const int slot = f.slots[static_cast<std::size_t>(texture.value)];
    for (std::size_t g = 0; slot >= 0 && g < f.plan.groups.size(); ++g) {
        const auto& members = f.plan.groups[g].members;
        if (std::find(members.begin(), members.end(), static_cast<std::size_t>(slot)) !=
            members.end())
            return static_cast<int>(g);
    }
    return -1;
}

/// Whether a BSDF has the colour of its group that is searched, or none. Parts of a blend are seen
/// together with those that have.
bool tells_of(const SearchFrame& f, const SearchGroup& group, BsdfId bsdf) {
    const Scene& scene = *f.view.scene.scene;
    const auto is_read = [&](std::size_t member) {
        return reads(scene[bsdf], f.plan.unknowns[member]);
    };
    const auto is_other = [&](std::size_t member) {
        return f.plan.colors[member] && is_read(member);
    };
    return !group.color || is_read(group.members[*group.color]) ||
           std::ranges::none_of(group.members, is_other) || !shares_of(scene, bsdf).empty();
}

void find_bsdfs(SearchFrame& f) {
    const Scene& scene = *f.view.scene.scene;
    f.slots = unknown_slots(scene, f.plan);
    for (std::size_t i = 0; i < scene.bsdfs.size(); ++i) {
        const BsdfId bsdf{static_cast<std::int32_t>(i)};
        int group = -1;
        for (const TextureId id : textures_of(scene, bsdf))
            group = std::max(group, group_of(f, id));
        f.groups.push_back(group);
        f.tells.push_back(group >= 0 &&
                          tells_of(f, f.plan.groups[static_cast<std::size_t>(group)], bsdf));
    }
    f.unknown_bsdfs = unknown_bsdfs(scene, f.slots);
    f.textures = std::make_unique<TextureTable>(f.plan.others ? texture_table(scene, *f.plan.others)
                                                              : TextureTable{scene.textures, {}});
    f.shaders = without_derivatives(make_record_shaders(scene, *f.textures, f.slots));
}

/// Non-zero where an unknown is read as a roughness.
std::vector<char> find_roughness(const SearchFrame& f) {
    std::vector<char> roughness;
    for (const TextureId id : f.plan.unknowns)
        roughness.push_back(read_as_roughness(*f.view.scene.scene, id));
    return roughness;
}

/// One component for each value of the chosen unknowns, all others in the middle.
std::vector<ConstantTextures> spread(const SearchFrame& f, const std::vector<char>& chosen,
                                     std::initializer_list<float> values) {
    std::vector<ConstantTextures> mixture;
    for (const float value : values) {
        ConstantTextures c(f.slots.size(), std::numeric_limits<float>::quiet_NaN());
        for (std::size_t i = 0; i < chosen.size(); ++i)
            c[static_cast<std::size_t>(f.plan.unknowns[i].value)] = chosen[i] ? value : 0.5f;
        mixture.push_back(std::move(c));
    }
    return mixture;
}

/// Roughness from smooth to matt; without one the other numbers; colours bend no light.
std::vector<ConstantTextures> make_mixture(const SearchFrame& f) {
    std::vector<char> chosen = find_roughness(f);
    const auto any = [&] { return std::find(chosen.begin(), chosen.end(), 1) != chosen.end(); };
    if (any()) return spread(f, chosen, {0.02f, 0.08f, 0.25f, 0.7f});
    for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i] = !f.plan.colors[i];
    if (any()) return spread(f, chosen, {0.1f, 0.5f, 0.9f});
    return spread(f, chosen, {0.5f});
}

/// The mean of a channel of the target in the square at pixel (x, y), and the least of its mask, in
/// units of SearchView::max_mask.
std::array<float, 2> mean_and_mask(const SearchFrame& f, int x, int y, int channel) {
    const Image& target = f.view.target;
    float sum = 0, count = 0, min = std::numeric_limits<float>::infinity();
    for (int py = y; py < std::min(y + f.plan.scale, target.height); ++py)
        for (int px = x; px < std::min(x + f.plan.scale, target.width); ++px) {
            sum += target.at(px, py, channel), ++count;
            min = std::min(min, static_cast<float>(mask_at(f.view.mask, px, py, channel)));
        }
    return {sum / count, min / f.view.max_mask};
}

/// Of a squared residual without the exposure, as of relMSE, whose 0.01 is `small` here; finite
/// where squares overflow, too.
float weight_of(float mean, float mask, float exposure, float small) {
    const float square = mean * mean, weight = mask * exposure * exposure / (square + small);
    constexpr double kMax = 1e30;
    if (std::isfinite(square) && std::isfinite(weight))
        return std::min(weight, static_cast<float>(kMax));
    const double m = mean, e = exposure;
    return static_cast<float>(std::min(double{mask} * e * e / (m * m + double{small}), kMax));
}

/// The 0.01 of relMSE for a picture whose white, that of the squares in which an unknown may be
/// seen, is 1 or more. A darker one is judged as if it were made so bright: otherwise all losses
/// are small beside kNoLoss, and nothing decides.
float small_of(const SearchFrame& f, const Image& means, const std::vector<float>& masks) {
    std::vector<char> counting(masks.size());
    for (std::size_t i = 0; i < masks.size(); ++i) counting[i] = masks[i] > 0 && f.seen[i / 3];
    const float white = quantile(means, 0.99, counting);
    constexpr float kMinSquare = 1e-30f;  // above 0 after the 0.01, too
    return 0.01f * (white > 0 && white < 1 ? std::max(white * white, kMinSquare) : 1);
}

void shrink_target(SearchFrame& f) {
    const ExposureFactors factors = factors_of(f.view.exposure);
    Image means = make_image(f.width, f.height, 3);
    std::vector<float> masks(means.values.size());
    for (std::size_t i = 0; i < masks.size(); ++i) {
        const auto square = static_cast<int>(i / 3);
        const auto [mean, mask] =
            mean_and_mask(f, square % f.width * f.plan.scale, square / f.width * f.plan.scale,
                          static_cast<int>(i % 3));
        const bool known = mask > 0 && std::isfinite(mean / factors[i % 3]);
        means.values[i] = known ? mean : 0, masks[i] = known ? mask : 0;
    }
    const float small = small_of(f, means, masks);
    for (std::size_t i = 0; i < masks.size(); ++i) {
        const float exposure = factors[i % 3];
        f.target.push_back(means.values[i] / exposure);
        f.weight.push_back(masks[i] > 0 ? weight_of(means.values[i], masks[i], exposure, small)
                                        : 0);
    }
}

void find_seen(SearchFrame& f) {
    const Film& film = f.view.scene.film;
    const std::vector<char> near = seen_pixels(f.view.scene, f.unknown_bsdfs);
    f.seen.assign(static_cast<std::size_t>(f.width * f.height), 0);
    for (int y = 0; y < film.crop_height; ++y)
        for (int x = 0; x < film.crop_width; ++x)
            if (near[static_cast<std::size_t>(y * film.crop_width + x)])
                f.seen[static_cast<std::size_t>(y / f.plan.scale * f.width + x / f.plan.scale)] = 1;
}

SearchPasses draw_half(const SearchFrame& f, std::uint32_t seed, std::uint32_t passes,
                       std::uint32_t number, std::uint32_t half) {
    const auto seeds =
        philox4x32({number, half, 0, 0}, {seed, static_cast<std::uint32_t>(Stream::kSearch)});
    const ReconstructionFilter& filter = f.view.scene.film.filter;
    SearchPasses drawn{{seeds[0], Stream::kSearch}, {}};
    for (std::uint32_t pass = 0; pass < passes; ++pass) {
        const Vec2f offset = film_offset(drawn.key, pass, Sequence::kSobol);
        const auto u = uniforms({seeds[1], Stream::kSearch}, pass, 0, 0);
        drawn.shifts.push_back({draw_shift(filter, f.plan.scale, offset.x, u[0]),
                                draw_shift(filter, f.plan.scale, offset.y, u[1])});
    }
    return drawn;
}

void draw_halves(SearchFrame& f, std::uint32_t seed, std::uint32_t passes, std::uint32_t number) {
    f.halves = {draw_half(f, seed, passes, number, 0), draw_half(f, seed, passes, number, 1)};
}

}  // namespace

std::vector<int> unknown_slots(const Scene& scene, const SearchPlan& plan) {
    std::vector<int> slots(scene.textures.size(), -1);
    for (std::size_t i = 0; i < plan.unknowns.size(); ++i)
        slots[static_cast<std::size_t>(plan.unknowns[i].value)] = static_cast<int>(i);
    return slots;
}

std::vector<char> seen_pixels(const TracedScene& view, std::span<const char> bsdfs) {
    return dilate(visible_pixels(view, bsdfs), view.film.crop_width, view.film.crop_height,
                  filter_halo(view.film.filter));
}

int draw_shift(const ReconstructionFilter& filter, int scale, float offset, float u) {
    const int halo = filter_halo(filter);
    std::vector<double> sums;
    double sum = 0;
    for (int shift = -halo; shift < scale + halo; ++shift) {
        for (int pixel = 0; pixel < scale; ++pixel)
            sum += std::max(0.0, eval_filter_exact(filter, shift + double{offset} - pixel - 0.5));
        sums.push_back(sum);
    }
    const auto drawn = std::upper_bound(sums.begin(), sums.end(), double{u} * sum);
    const auto last = static_cast<std::ptrdiff_t>(sums.size()) - 1;
    return static_cast<int>(std::min(drawn - sums.begin(), last)) - halo;
}

SearchFrame make_search_frame(const SearchPlan& plan, const SearchView& view,
                              std::uint32_t number) {
    SearchFrame f{plan, view};
    f.width = (view.scene.film.crop_width + plan.scale - 1) / plan.scale;
    f.height = (view.scene.film.crop_height + plan.scale - 1) / plan.scale;
    find_bsdfs(f);
    f.mixture = make_mixture(f);
    find_seen(f);
    shrink_target(f);
    draw_halves(f, plan.seed, plan.passes, number);
    return f;
}

std::vector<SearchFrame> make_search_frames(const SearchPlan& plan,
                                            std::span<const SearchView> views) {
    std::vector<std::optional<SearchFrame>> made(views.size());
    parallel_for(views.size(), [&](std::size_t v) {
        made[v].emplace(make_search_frame(plan, views[v], static_cast<std::uint32_t>(v)));
    });
    std::vector<SearchFrame> frames;
    for (auto& frame : made) frames.push_back(std::move(*frame));
    return frames;
}

void draw_passes(std::span<SearchFrame> frames, std::uint32_t seed, std::uint32_t passes) {
    for (std::uint32_t number = 0; number < frames.size(); ++number)
        draw_halves(frames[number], seed, passes, number);
}

}  // namespace burnish
