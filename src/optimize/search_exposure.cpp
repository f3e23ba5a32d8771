#include "optimize/search_exposure.h"

#include <algorithm>

#include "core/parallel.h"
#include "optimize/exposure.h"
#include "optimize/search_samples.h"
#include "render/render.h"

namespace burnish {

namespace {

using Channels = std::array<double, 3>;

/// Weighted sums over squares: P black picture, B what white adds to it, G the target. Products of
/// pictures are those of one half with the other, independent one: without noise on average.
struct Moments {
    Channels pp{}, pb{}, bb{}, gp{}, gb{}, gg{};
};

Moments& operator+=(Moments& to, const Moments& from) {
    for (std::size_t c = 0; c < 3; ++c) {
        to.pp[c] += from.pp[c], to.pb[c] += from.pb[c], to.bb[c] += from.bb[c];
        to.gp[c] += from.gp[c], to.gb[c] += from.gb[c], to.gg[c] += from.gg[c];
    }
    return to;
}

/// Adds a value of the picture in both halves: black, and what white adds.
void add(std::size_t c, double weight, double target, const std::array<double, 2>& p,
         const std::array<double, 2>& b, Moments& to) {
    to.pp[c] += weight * p[0] * p[1], to.bb[c] += weight * b[0] * b[1];
    to.pb[c] += weight * 0.5 * (p[0] * b[1] + p[1] * b[0]);
    to.gp[c] += weight * target * 0.5 * (p[0] + p[1]);
    to.gb[c] += weight * target * 0.5 * (b[0] + b[1]);
    to.gg[c] += weight * target * target;
}

/// Of a view: for each group its candidates, and what no unknown changes.
struct ViewMoments {
    std::vector<std::vector<Moments>> groups;
    Moments constant;
};

Moments tile_moments(const TracedTile& t, std::size_t group, std::size_t candidate) {
    const SearchFrame& f = t.frame;
    const GroupPictures pictures = shade_group(t, group, candidate);
    const auto& black = pictures.black;
    const auto& white = f.plan.groups[group].color ? pictures.white : black;
    Moments sum;
    for (const RegionShare& s : t.shares[group])
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t at = 3 * frame_index(f, t.tile, static_cast<int>(s.square)) + c;
            const std::size_t i = 3 * std::size_t{s.square} + c;
            const std::array<double, 2> p{double{black[0][i]}, double{black[1][i]}};
            add(c, double{s.weight} * double{f.weight[at]}, double{f.target[at]}, p,
                {double{white[0][i]} - p[0], double{white[1][i]} - p[1]}, sum);
        }
    return sum;
}

/// The pixels of squares that see no unknown, in units of squares.
Moments constant_moments(const SearchFrame& f) {
    constexpr std::uint32_t kPasses = 4;
    const Film& film = f.view.scene.film;
    const auto picture = [&](std::size_t half) {
        const TraceInput input{.scene = &f.view.scene,
                               .textures = f.textures.get(),
                               .key = {f.halves[half].key.seed, Stream::kSearch},
                               .unknown_bsdfs = f.unknown_bsdfs,
                               .mixture = f.mixture,
                               .slots = f.slots};
        return render(input, 0, kPasses);
    };
    const Image a = picture(0), b = picture(1);
    std::vector<Moments> rows(static_cast<std::size_t>(f.height));
    parallel_for(rows.size(), [&](std::size_t row) {
        const int y0 = static_cast<int>(row) * f.plan.scale;
        for (int x = 0; x < film.crop_width; ++x)
            for (int y = y0; y < std::min(y0 + f.plan.scale, film.crop_height); ++y) {
                const std::size_t square = row * static_cast<std::size_t>(f.width) +
                                           static_cast<std::size_t>(x / f.plan.scale);
                if (f.seen[square]) continue;
                for (int c = 0; c < 3; ++c) {
                    const std::size_t at = 3 * square + static_cast<std::size_t>(c);
                    if (!(f.weight[at] > 0)) continue;
                    add(static_cast<std::size_t>(c),
                        double{f.weight[at]} / (f.plan.scale * f.plan.scale),
                        double{f.view.target.at(x, y, c)},
                        {double{a.at(x, y, c)}, double{b.at(x, y, c)}}, {0, 0}, rows[row]);
                }
            }
    });
    Moments sum;
    for (const Moments& row : rows) sum += row;
    return sum;
}

ViewMoments view_moments(const SearchFrame& f) {
    const std::vector<SearchTile> tiles = make_search_tiles(f);
    std::vector<std::vector<std::vector<Moments>>> found(tiles.size());
    parallel_for(tiles.size(), [&](std::size_t i) {
        const TracedTile tile = trace_tile(f, tiles[i]);
        for (std::size_t g = 0; g < f.plan.groups.size(); ++g) {
            found[i].emplace_back();
            for (std::size_t k = 0; k < f.plan.groups[g].candidates.size(); ++k)
                found[i][g].push_back(tile_moments(tile, g, k));
        }
    });
    ViewMoments sum;
    for (const SearchGroup& g : f.plan.groups) sum.groups.emplace_back(g.candidates.size());
    for (const auto& tile : found)
        for (std::size_t g = 0; g < tile.size(); ++g)
            for (std::size_t k = 0; k < tile[g].size(); ++k) sum.groups[g][k] += tile[g][k];
    sum.constant = constant_moments(f);
    return sum;
}

/// Numerators and denominators of an exposure.
struct ViewEquation {
    Channels gi{}, ii{};

    void add(const Moments& m, const Channels& color) {
        for (std::size_t c = 0; c < 3; ++c) {
            gi[c] += m.gp[c] + color[c] * m.gb[c];
            ii[c] += m.pp[c] + 2 * color[c] * m.pb[c] + color[c] * color[c] * m.bb[c];
        }
    }
};

Channels solve(const Exposure& exposure, const ViewEquation& n) {
    if (const auto* own = std::get_if<ExposureFactors>(&exposure))
        return {double{(*own)[0]}, double{(*own)[1]}, double{(*own)[2]}};
    Channels e{1, 1, 1};
    const bool by_channel = std::get<FitExposure>(exposure).by_channel;
    for (std::size_t c = 0; c < 3; ++c) {
        const double gi = by_channel ? n.gi[c] : n.gi[0] + n.gi[1] + n.gi[2];
        const double ii = by_channel ? n.ii[c] : n.ii[0] + n.ii[1] + n.ii[2];
        if (gi > 0 && ii > 0) e[c] = gi / ii;
    }
    return e;
}

/// A candidate of a group, with the best colour.
struct Fit {
    double loss = 0;
    Channels color{0.5, 0.5, 0.5};
};

/// In turns, from the middle: where the scale is ambiguous, colours stay near there. Without a
/// colour white adds nothing, and all rounds are alike.
Fit fit_candidate(std::span<const SearchView> views, std::span<const ViewMoments> moments,
                  std::size_t group, std::size_t candidate) {
    constexpr int kRounds = 20;
    Fit fit;
    for (int round = 0; round < kRounds; ++round) {
        Channels numerator{}, denominator{};
        fit.loss = 0;
        for (std::size_t v = 0; v < views.size(); ++v) {
            const Moments& m = moments[v].groups[group][candidate];
            ViewEquation n;
            n.add(moments[v].constant, {}), n.add(m, fit.color);
            const Channels e = solve(views[v].exposure, n);
            for (std::size_t c = 0; c < 3; ++c) {
                fit.loss += e[c] * e[c] * n.ii[c] - 2 * e[c] * n.gi[c] + m.gg[c] +
                            moments[v].constant.gg[c];
                numerator[c] += e[c] * m.gb[c] - e[c] * e[c] * m.pb[c];
                denominator[c] += e[c] * e[c] * m.bb[c];
            }
        }
        for (std::size_t c = 0; c < 3; ++c)
            if (denominator[c] > 0)
                fit.color[c] = std::clamp(numerator[c] / denominator[c], 0.02, 1.0);
    }
    return fit;
}

}  // namespace

std::vector<SearchView> with_exposures(const SearchPlan& plan, std::span<const SearchView> views) {
    if (std::none_of(views.begin(), views.end(),
                     [](const SearchView& v) { return fits_exposure(v.exposure); }))
        return {views.begin(), views.end()};
    constexpr std::uint32_t kPasses = 4;  // a number for each view needs few samples
    SearchPlan brief = plan;
    brief.passes = std::min(plan.passes, kPasses), brief.seed = seed_of_half(plan.seed, 2);
    std::vector<SearchView> plain;
    for (const SearchView& v : views) plain.push_back(at_exposure({1, 1, 1}, v));
    std::vector<ViewMoments> moments;
    for (const SearchFrame& frame : make_search_frames(brief, plain))
        moments.push_back(view_moments(frame));
    std::vector<ViewEquation> normals(views.size());
    for (std::size_t v = 0; v < views.size(); ++v) normals[v].add(moments[v].constant, {});
    for (std::size_t g = 0; g < plan.groups.size(); ++g) {
        std::vector<Fit> fits;
        for (std::size_t k = 0; k < plan.groups[g].candidates.size(); ++k)
            fits.push_back(fit_candidate(views, moments, g, k));
        const auto best = std::min_element(
            fits.begin(), fits.end(), [](const Fit& a, const Fit& b) { return a.loss < b.loss; });
        const auto k = static_cast<std::size_t>(best - fits.begin());
        for (std::size_t v = 0; v < views.size(); ++v)
            normals[v].add(moments[v].groups[g][k], best->color);
    }
    std::vector<SearchView> exposed;
    for (std::size_t v = 0; v < views.size(); ++v) {
        const Channels e = solve(views[v].exposure, normals[v]);
        exposed.push_back(at_exposure(
            {static_cast<float>(e[0]), static_cast<float>(e[1]), static_cast<float>(e[2])},
            views[v]));
    }
    return exposed;
}

}  // namespace burnish
