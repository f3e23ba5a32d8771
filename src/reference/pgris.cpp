#include "reference/pgris.h"

#include <algorithm>
#include <optional>

#include "core/dual.h"
#include "paths/light_resampling.h"
#include "paths/one_ray.h"
#include "shading/bsdf.h"
#include "shading/filter.h"

namespace burnish::reference {

namespace {

/// Le, and the density p_e of the direction, at the end of a ray.
EmissionSample Le(const World& world, const Hit& hit, const Vec3f& from, const Vec3f& way) {
    return hit.shape < 0 ? emission_at_infinity(*world.traced.lights, from, way)
                         : emission_at_hit(*world.traced.lights, hit, from, way);
}

/// f(y) Le(y) / (p_e(y) + p_b(y)) as if nothing hid y.
float weight(const World& world, const SeenPoint& p, const Path& x, const LightSample& y) {
    if (!(y.pdf > 0)) return 0;
    const Bsdf& bsdf = world.scene()[p.bsdf];
    const auto inputs = bsdf_inputs(world.textures, bsdf, x.uv);
    const Vec3f wo = p.to_local(y.direction_world);
    const float p_b = y.delta ? 0 : pdf_bsdf(bsdf, inputs, x.wi, wo);
    return candidate_weight(eval_bsdf(bsdf, inputs, x.wi, wo), y.radiance, y.pdf + p_b);
}

/// One of the candidates of a light sample [RIS].
CandidateChoice choose(const World& world, const SeenPoint& p, const Numbers& numbers,
                       const Path& x) {
    const Lights& lights = *world.traced.lights;
    std::vector<float> weights;
    for (std::uint32_t c = 0; c < candidates_of(lights.selector); ++c)
        weights.push_back(
            weight(world, p, x, sample_light(lights, p.surface.position, numbers.u, c)));
    return weights.size() > 1 ? choose_candidate(weights, numbers.choice) : CandidateChoice{};
}

void sample_emitter(const World& world, const SeenPoint& p, const Numbers& numbers, Path& x) {
    const auto [candidate, inverse_probability] = choose(world, p, numbers, x);
    const LightSample light =
        sample_light(*world.traced.lights, p.surface.position, numbers.u, candidate);
    x.wo = p.to_local(light.direction_world);
    if (!(light.pdf > 0) || is_blocked(world.traced.geometry->accel, p, light)) return;
    const Bsdf& bsdf = world.scene()[p.bsdf];
    const float p_b = pdf_bsdf(bsdf, bsdf_inputs(world.textures, bsdf, x.uv), x.wi, x.wo);
    x.light = light.radiance * (1 / (light.pdf + (light.delta ? 0 : p_b))) * inverse_probability *
              p.share_of_light(light.direction_world);
}

void sample_bsdf(const World& world, const SeenPoint& p, const Numbers& numbers, Path& x) {
    const Bsdf& bsdf = world.scene()[p.bsdf];
    const auto inputs = bsdf_inputs(world.textures, bsdf, x.uv);
    const SampledDirection<float> sample =
        burnish::sample_bsdf(bsdf, inputs, x.wi, {numbers.u[0], numbers.u[1]}, numbers.u[2]);
    x.wo = sample.wo_local, x.delta = sample.delta, x.lobe = sample.lobe.f;
    const float p_b = sample.delta ? sample.lobe.pdf : pdf_bsdf(bsdf, inputs, x.wi, x.wo);
    if (!sample.proper || !(p_b > 0)) return;
    const Vec3f way = p.to_world(x.wo);
    const Hit hit = first_hit(world.traced.geometry->accel, p.leave(way), way);
    const EmissionSample light = Le(world, hit, p.surface.position, way);
    x.light = light.radiance * (1 / ((x.delta ? 0 : light.pdf) + p_b)) * p.share_of_light(way);
}

/// f: BSDF times cosine, or the share of light of a delta lobe.
Rgbf value(const World& world, const Path& x) {
    if (x.delta) return x.lobe;
    const Bsdf& bsdf = world.scene()[x.bsdf];
    return eval_bsdf(bsdf, bsdf_inputs(world.textures, bsdf, x.uv), x.wi, x.wo);
}

/// What the unknown weights of blends leave of the part that x meets, but for one of them.
float share(const World& world, const Path& x, std::optional<std::size_t> left_out) {
    float product = 1;
    const auto shares = shares_of(world.scene(), x.bsdf);
    for (std::size_t s = 0; s < shares.size(); ++s) {
        if (s == left_out || world.slot(shares[s].weight) < 0) continue;
        const float w = eval_scalar(world.textures, {0, shares[s].weight}, x.uv);
        product *= shares[s].second ? w : 1 - w;
    }
    return product;
}

/// Calls body(x) for the paths of both techniques for each sample k in each pixel j.
void for_each_path(const World& world, const RandomStream& s, std::uint32_t v, const auto& body) {
    const Film& film = world.traced.film;
    const auto n = static_cast<std::uint32_t>(film.crop_width * film.crop_height);
    for (std::uint32_t k = 0; k < s.m; ++k)
        for (const Technique technique : {Technique::kEmitter, Technique::kBsdf})
            for (std::uint32_t j = 0; j < n; ++j) {
                const PathSample sample{{j, v, k}, technique};
                body(make_path(world, sample, numbers_of(s, sample)));
            }
}

/// h_j(x) along one axis: the filter r(x - j) over its integral on a film of `size` pixels.
float h(const ReconstructionFilter& r, int pixel, float within, int j, int size) {
    const float center = static_cast<float>(j) + 0.5f, end = static_cast<float>(size);
    return eval_filter(r, within - 0.5f - static_cast<float>(j - pixel)) /
           filter_integral(r, std::max(-center, -r.radius), std::min(end - center, r.radius));
}

/// Calls body(j_x, j_y, h_j(x)) for all pixels j that a path reaches.
void for_each_pixel(const Film& f, const Path& x, const auto& body) {
    const int px = static_cast<int>(x.sample.camera.pixel) % f.crop_width;
    const int py = static_cast<int>(x.sample.camera.pixel) / f.crop_width;
    const int reach = static_cast<int>(std::ceil(f.filter.radius - 0.5f));
    for (int jy = std::max(0, py - reach); jy <= std::min(f.crop_height - 1, py + reach); ++jy)
        for (int jx = std::max(0, px - reach); jx <= std::min(f.crop_width - 1, px + reach); ++jx)
            body(jx, jy,
                 h(f.filter, px, x.film.x, jx, f.crop_width) *
                     h(f.filter, py, x.film.y, jy, f.crop_height));
}

float sum(const Rgbf& v) { return v.x + v.y + v.z; }

/// The chain rule to the texels of a texture, of which x reads a number or the channels of a
/// colour. v: the derivatives of f_c, weighed, by those.
void add_texels(const World& world, const Path& x, TextureId texture, std::span<const Rgbf> v,
                std::map<Texel, Derivative>& all) {
    const int slot = world.slot(texture);
    if (slot < 0) return;
    const auto& bitmap = std::get<Bitmap>(world.scene()[texture]);
    Derivative by_texel{luminance(v[0]), scalar_to_texel(bitmap.channels, sum(v[0]))};
    if (v.size() == 3) {
        const Rgbf g = color_to_texel(bitmap.channels, Rgbf{sum(v[0]), sum(v[1]), sum(v[2])});
        by_texel = {luminance(g), g};
    }
    if (by_texel.q == 0 && is_black(by_texel.g)) return;
    const TexelFootprint texels = footprint(bitmap, x.uv);
    for (std::size_t k = 0; k < static_cast<std::size_t>(texels.count); ++k) {
        Derivative& d = all[{static_cast<std::uint32_t>(slot), texels.texel[k]}];
        d.q += by_texel.q * texels.weight[k], d.g += by_texel.g * texels.weight[k];
    }
}

/// Uniforms for decision k of a texel's reservoirs, or (`merging`) for all of its merge.
std::array<float, 4> rand(const Problem& p, std::uint32_t v, Texel i, std::uint32_t k,
                          bool merging) {
    return uniforms({p.derivative.key.seed, Stream::kReservoir}, k, v, i.index,
                    2 * i.texture + (merging ? 1 : 0));
}

/// [PR alg. 1], in the reservoir of the sign of q(x).
void update(ReservoirPair& pair, const Path& x, const Derivative& at_x, double w, double u) {
    if (!(w > 0)) return;
    Reservoir& r = pair[at_x.q < 0 ? 1 : 0];
    r.w_sum += w;
    if (u * r.w_sum < w) r.x = x, r.at_x = at_x;
    r.W = static_cast<float>(r.w_sum / std::abs(double{r.at_x.q}));
}

/// y = T(x): the path of the same random numbers under other textures [PR sec. 4.2], or x itself,
/// with the density that it was made with. |dT/dx| = 1 for both.
Path shifted(const World& to, const Problem& p, const Path& x) {
    return p.shift == Shift::kReplay ? make_path(to, x.sample, numbers_of(p.derivative, x.sample))
                                     : x;
}

/// N q / (N q + N' q') [PR eq. 13]; one term stands for both signs, as |q| = q_+ + q_-.
double mis_weight(float N, float q, float N_other, float q_other) {
    const double own = double{N} * std::abs(double{q});
    return own > 0 ? own / (own + double{N_other} * std::abs(double{q_other})) : 0;
}

}  // namespace

Numbers numbers_of(const RandomStream& stream, const PathSample& sample) {
    const auto& [pixel, v, k] = sample.camera;
    const std::uint32_t block = k * kTechniques + static_cast<std::uint32_t>(sample.technique);
    return {film_offset(stream.key, film_pass(sample.camera, stream.m)),
            uniforms(stream.key, pixel, v, block),
            uniforms(stream.key, pixel, v, block, kCandidateNumbers)[0]};
}

Path make_path(const World& world, const PathSample& sample, const Numbers& numbers) {
    Path x{sample, numbers.film};
    const auto ray = camera_ray(world.traced, sample.camera.pixel, numbers.film);
    if (ray.max_distance < 0) return x;  // outside of the lens's field
    const Hit hit = first_hit(camera_accel(*world.traced.geometry), ray.origin, ray.direction,
                              ray.max_distance);
    if (!world.scene().hide_emitters) x.seen = Le(world, hit, ray.origin, ray.direction).radiance;
    if (hit.shape < 0) return x;
    const SeenPoint p = seen_point(world.traced, world.textures, {world.slots}, ray, hit);
    x.bsdf = p.bsdf, x.uv = p.surface.uv, x.wi = p.wi;
    (sample.technique == Technique::kEmitter ? sample_emitter : sample_bsdf)(world, p, numbers, x);
    x.light = x.light * (1 / p.chance);
    return x;
}

Rgbf contribution(const World& world, const Path& x) {
    if (is_black(x.light)) return {};
    return value(world, x) * share(world, x, {}) * x.light;
}

Image render(const World& world, const RandomStream& stream, std::uint32_t v) {
    const Film& film = world.traced.film;
    Image image = make_image(film.crop_width, film.crop_height, 3);
    for_each_path(world, stream, v, [&](const Path& x) {
        const bool first = x.sample.technique == Technique::kEmitter;  // of a camera sample's two
        const Rgbf light = contribution(world, x) + (first ? x.seen : Rgbf{});
        const Rgbf mean = light * (1 / static_cast<float>(stream.m));
        for_each_pixel(film, x, [&](int jx, int jy, float h_j) {
            for (int c = 0; c < 3; ++c) image.at(jx, jy, c) += h_j * mean[c];
        });
    });
    return image;
}

LossValue relative_mse(const Image& image, const Image& target) {
    LossValue loss{0, image};
    const double n = static_cast<double>(image.values.size());
    for (std::size_t j = 0; j < image.values.size(); ++j) {
        const double I = double{image.values[j]}, G = double{target.values[j]};
        loss.value += (I - G) * (I - G) / (G * G + 0.01) / n;
        loss.adjoint.values[j] = static_cast<float>(2 * (I - G) / (G * G + 0.01) / n);
    }
    return loss;
}

std::map<Texel, Derivative> derivatives(const World& world, const Image& adjoint, const Path& x) {
    if (is_black(x.light)) return {};
    Rgbf w;  // w(x) = sum_j dL/dI_j h_j(x)
    for_each_pixel(world.traced.film, x, [&](int jx, int jy, float h_j) {
        for (int c = 0; c < 3; ++c) w[c] += h_j * adjoint.at(jx, jy, c);
    });
    // By what the BSDF reads, the channels of its colours and then numbers, and by shares.
    const Bsdf& bsdf = world.scene()[x.bsdf];
    const auto f = eval_bsdf(bsdf, variables(bsdf_inputs(world.textures, bsdf, x.uv)), x.wi, x.wo);
    const float all_shares = share(world, x, {});
    std::array<Rgbf, kBsdfInputs> v;
    for (std::size_t k = 0; k < kBsdfInputs; ++k)
        v[k] = w * x.light * Rgbf{f.x.d[k], f.y.d[k], f.z.d[k]} * all_shares;
    std::map<Texel, Derivative> all;
    std::size_t k = 0;
    for (const ColorInput& color : colors_of(bsdf))
        add_texels(world, x, color.texture, {&v[k], 3}, all), k += 3;
    for (const ScalarInput& scalar : scalars_of(bsdf))
        add_texels(world, x, scalar.texture, {&v[k++], 1}, all);
    const auto shares = shares_of(world.scene(), x.bsdf);
    for (std::size_t s = 0; s < shares.size(); ++s) {
        const float slope = share(world, x, s) * (shares[s].second ? 1.0f : -1.0f);
        const Rgbf by_weight = w * x.light * value(world, x) * slope;
        add_texels(world, x, shares[s].weight, {&by_weight, 1}, all);
    }
    return all;
}

Reservoirs generate_candidates(const Problem& p, const Integrand& now, std::uint32_t v) {
    const World world{p.scene, now.pi};
    Reservoirs rs;
    std::map<Texel, std::uint32_t> count;
    for_each_path(world, p.derivative, v, [&](const Path& x) {
        for (const auto& [i, d] : derivatives(world, now.adjoint, x)) {
            // q / (M p_j) [PR eq. 14]: with p_j a density over all n pixels, M p_j is m p.
            const double w = std::abs(double{d.q}) / static_cast<double>(p.derivative.m);
            const auto u = rand(p, v, i, count[i]++, false);
            update(rs[i], x, d, w, fine_uniform(u[0], u[1]));
        }
    });
    return rs;
}

Gradient reuse(const Problem& p, const Integrand& now, std::uint32_t v, const Reservoirs& cur,
               History& history) {
    const Integrand& before = history.M > 0 ? history.integrand : now;
    const World world{p.scene, now.pi}, world_before{p.scene, before.pi};
    const float M_cur = static_cast<float>(p.derivative.m), M_prev = std::min(history.M, p.M_cap);
    Reservoirs all = cur, rs;
    for (const auto& [i, pair] : history.rs) all[i];  // texels without a fresh candidate, too
    Gradient gradient;
    for (const auto& [i, pair] : all) {
        const auto u = rand(p, v, i, 0, true);
        std::size_t k = 0;
        for (const auto& [x, at_x, w_sum, W] : pair) {
            if (W == 0) continue;
            const Path y = shifted(world_before, p, x);
            const float q_before = derivatives(world_before, before.adjoint, y)[i].q;
            const double m = mis_weight(M_cur, at_x.q, M_prev, q_before);
            update(rs[i], x, at_x, m * std::abs(double{at_x.q}) * double{W}, u[k++]);
        }
        for (const auto& [x, at_x, w_sum, W] : history.rs[i]) {  // of either sign, into either
            if (W == 0) continue;
            const Path y = shifted(world, p, x);
            const Derivative at_y = derivatives(world, now.adjoint, y)[i];
            const double m = mis_weight(M_prev, at_x.q, M_cur, at_y.q);
            update(rs[i], y, at_y, m * std::abs(double{at_y.q}) * double{W}, u[k++]);
        }
        for (const Reservoir& r : rs[i]) gradient[i] += r.at_x.g * r.W;
    }
    history = {now, std::move(rs), M_cur + M_prev};
    return gradient;
}

Iteration iterate(const Problem& p, const Theta& pi, std::uint32_t v, History& history) {
    const Image image = render({p.scene, pi}, p.image, v);
    const LossValue loss = relative_mse(image, p.target);
    const Integrand now{pi, loss.adjoint};
    return {loss.value, reuse(p, now, v, generate_candidates(p, now, v), history)};
}

}  // namespace burnish::reference
