// Parameter-space ReSTIR for differentiable and inverse rendering [PR], without features: read it
// first. One path after the other, in plain floats; tests hold the fast code of the same steps
// (gradient/estimator.h) to it, from the same random numbers.
//
//     iterate                  image -> loss -> gradient, by which an optimiser moves the textures
//       render                 I_j = integral of h_j(x) f_c(x)            [PR eq. 1]
//       relative_mse           L(I, G), dL/dI_j                           [PR eq. 3, 4]
//       generate_candidates    paths x_{j,k} -> reservoirs            [PR alg. 1, 2; eq. 11, 14]
//         make_path            camera -> surface -> light
//         derivatives          g_i(x) = w(x) df_c(x)/dpi_i,  q_i(x)       [PR eq. 5; sec. 4.1]
//       reuse                  reservoirs of this and the last iteration  [PR alg. 3; eq. 12, 13]
//
// A path is a function of its random numbers and of the textures: the same numbers make another
// path under other textures [PR sec. 4.2]. It carries 1 / p(x): f_c, g_i and q_i stand for what the
// paper writes as f_c(x) / p(x), g_i(x) / p(x) and q_i(x) / p(x).
#pragma once

#include <map>

#include "burnish/options.h"
#include "gradient/theta.h"
#include "paths/trace.h"

namespace burnish::reference {

/// The scene with the textures pi in their places. Views: both must outlive it.
struct World {
    const TracedScene& traced;  ///< rays, surfaces, lights; there is a light
    const Theta& pi;
    TextureTable textures = texture_table(*traced.scene, pi);
    std::vector<int> slots = theta_slots(*traced.scene, pi);
    const Scene& scene() const { return *traced.scene; }
    /// Where pi has the texture; -1: it is known.
    int slot(TextureId t) const { return t ? slots[static_cast<std::size_t>(t.value)] : -1; }
};

/// Random numbers for m samples per pixel in each iteration.
struct RandomStream {
    RandomKey key;
    std::uint32_t m = 1;
};
struct Numbers {
    Vec2f film;  ///< film position within the pixel
    std::array<float, 4> u;
    float choice = 0;  ///< by which a light sample chooses among its candidates
};
Numbers numbers_of(const RandomStream& stream, const PathSample& sample);

struct Path {
    PathSample sample;  ///< names its random numbers: pixel j, sample k, technique
    Vec2f film{};       ///< as of Numbers
    Rgbf seen{};        ///< what the camera's ray brings itself, without a surface that scatters
    BsdfId bsdf{};
    Vec2f uv{};
    Vec3f wi{}, wo{};  ///< local, to the camera and to the light
    Rgbf light{};      ///< Le / (p_e + p_b), over the probability of a blend's part; black: no path
    bool delta = false;  ///< wo is that of a delta lobe, whose share of light is `lobe`
    Rgbf lobe{};
};
/// By emitter or BSDF sampling, whose densities of wo are p_e and p_b. The balance heuristic makes
/// of either f Le / (p_e + p_b), f: BSDF times cosine.
Path make_path(const World& world, const PathSample& sample, const Numbers& numbers);
Rgbf contribution(const World& world, const Path& x);  ///< f_c(x), RGB
/// I from m samples per pixel, both techniques each. h_j: the filter over its exact integral.
Image render(const World& world, const RandomStream& stream, std::uint32_t v);
/// L, the mean of (I_j - G_j)^2 / (G_j^2 + 0.01) over pixels and channels, and dL/dI_j.
LossValue relative_mse(const Image& image, const Image& target);

struct Texel {                  // pi_i; its channels share reservoirs
    std::uint32_t texture = 0;  ///< index in Theta::textures
    std::uint32_t index = 0;    ///< y * width + x
    friend auto operator<=>(const Texel&, const Texel&) = default;
};
struct Derivative {
    float q = 0;  ///< q_i(x): target function, the signed luminance of g_i(x)
    Rgbf g;       ///< g_i(x) by the channels of the texel; one-channel textures use x
};
/// At all texels that x touches, but where both are 0.
std::map<Texel, Derivative> derivatives(const World& world, const Image& adjoint, const Path& x);

struct Reservoir {     // [PR alg. 1]
    Path x;            ///< the selected sample
    Derivative at_x;   ///< of the reservoir's texel
    double w_sum = 0;  ///< of all samples
    float W = 0;       ///< unbiased contribution weight [PR eq. 8]; 0: empty
};
/// For each texel those of q_+ = max(q, 0) and q_- = max(-q, 0) [PR eq. 11].
using ReservoirPair = std::array<Reservoir, 2>;
using Reservoirs = std::map<Texel, ReservoirPair>;
using Gradient = std::map<Texel, Rgbf>;  ///< absent texels have 0
/// What a run is given.
struct Problem {
    const TracedScene& scene;
    Image target;
    RandomStream image{{0, Stream::kImage}, 32}, derivative{{0, Stream::kDerivative}, 1};
    Shift shift = Shift::kReplay;
    float M_cap = 16;
};
/// What an iteration integrates.
struct Integrand {
    Theta pi;
    Image adjoint;  ///< dL/dI_j
};
/// What the next iteration reuses.
struct History {
    Integrand integrand;
    Reservoirs rs;
    float M = 0;  ///< candidates per pixel behind each texel, hit or not; of both signs
};
/// [PR alg. 2]
Reservoirs generate_candidates(const Problem& p, const Integrand& now, std::uint32_t v);
/// [PR alg. 3]: merges the candidates' reservoirs with the history, which becomes that of v.
Gradient reuse(const Problem& p, const Integrand& now, std::uint32_t v, const Reservoirs& cur,
               History& history);
struct Iteration {
    double loss = 0;
    Gradient gradient;
};
/// That of the textures pi.
Iteration iterate(const Problem& p, const Theta& pi, std::uint32_t v, History& history);

}  // namespace burnish::reference
