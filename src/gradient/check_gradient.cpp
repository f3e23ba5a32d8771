#include "gradient/check_gradient.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "burnish/error.h"
#include "render/render.h"

namespace burnish {

namespace {

constexpr int kBlocks = 8;  // a side of what is moved, and of what is weighed, with one sign

/// What a texture is moved along, and how the image is weighed: of all textures alike.
struct Direction {
    const char* name;
    Image texels, adjoint;
};
constexpr std::size_t kDirections = 2;

/// Signs by blocks of an image, the same for all of its channels.
Image signs(int width, int height, int channels, std::uint32_t seed) {
    Image image = make_image(width, height, channels);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const auto block =
                static_cast<std::uint32_t>(y * kBlocks / height * kBlocks + x * kBlocks / width);
            const auto u = uniforms({seed, Stream::kProbe}, block, 0, 0);
            for (int c = 0; c < channels; ++c) image.at(x, y, c) = u[0] < 0.5f ? -1.0f : 1.0f;
        }
    return image;
}

using Directions = std::array<Direction, kDirections>;

Directions directions_of(const Image& texels, const Film& film, std::uint32_t seed) {
    const int width = film.crop_width, height = film.crop_height;
    return {{{"all texels together", make_image(texels.width, texels.height, texels.channels, 1),
              make_image(width, height, 3, 1)},
             {"blocks up and down", signs(texels.width, texels.height, texels.channels, seed),
              signs(width, height, 3, seed + 1)}}};
}

/// The image with a texture moved by so many steps.
Image moved_image(const TracedScene& view, Theta theta, std::size_t slot, const Direction& d,
                  int steps, RandomKey key, std::uint32_t passes) {
    Image& texels = theta.textures[slot].values;
    for (std::size_t i = 0; i < texels.values.size(); ++i)
        texels.values[i] += static_cast<float>(steps) * kCheckStep * d.texels.values[i];
    const Binding binding(view, theta);
    return render(unknown_part(binding, key, passes), 0, passes);
}

/// Of images under common random numbers.
struct Difference {
    double slope = 0;  ///< central difference of fourth order
    /// The difference of third order, summed without signs over pixels, in the unit of the slope:
    /// 0, up to rounding, unless a sample takes another path within the steps, or a pixel's slope
    /// changes.
    double jump = 0;
    double rounding = 0;  ///< about that of the slope, in its unit: images are floats
};

Difference difference(const TracedScene& view, const Theta& theta, std::size_t slot,
                      const Direction& d, RandomKey key, std::uint32_t passes) {
    constexpr double kRounding = 16 * 0x1p-24;  // of images, which are floats
    const auto at = [&](int steps) {
        return moved_image(view, theta, slot, d, steps, key, passes);
    };
    const Image up = at(1), down = at(-1), up2 = at(2), down2 = at(-2);
    double slope = 0, jump = 0, rounding = 0;
    for (std::size_t i = 0; i < up.values.size(); ++i) {
        const double weight = d.adjoint.values[i];
        const double one = double{up.values[i]} - double{down.values[i]},
                     two = double{up2.values[i]} - double{down2.values[i]};
        slope += weight * (8 * one - two);
        jump += std::abs(weight * (two - 2 * one));
        rounding += kRounding * std::abs(weight * double{up.values[i]});
    }
    const double unit = 12 * double{kCheckStep};
    return {slope / unit, jump > rounding ? jump / unit : 0, rounding / unit};
}

CheckedMean mean_of(const std::vector<double>& values) {
    const auto n = static_cast<double>(values.size());
    double sum = 0, squares = 0;
    for (const double v : values) sum += v;
    for (const double v : values) squares += (v - sum / n) * (v - sum / n);
    return {sum / n, std::sqrt(squares / (n - 1) / n)};
}

double size_of(const GradientCheck& check) {
    return std::max(std::abs(check.estimate.mean), std::abs(check.difference.mean));
}

/// Where paths are drawn by the texture, images differ by jumps as samples take other paths within
/// the steps. Few batches in which one does tell neither mean nor standard error.
bool is_told(const std::vector<double>& jumps, const GradientCheck& check) {
    constexpr double kMin = 1e-3;
    return std::ranges::count_if(
               jumps, [&](double jump) { return jump > kMin * size_of(check); }) >= kCheckDrawn;
}

/// rounding: about that of the difference.
Agreement agreement_of(const GradientCheck& check, double rounding) {
    const double error = std::max(check.estimate.standard_error, check.difference.standard_error);
    const double size = size_of(check);
    if (size == 0 && error == 0) return Agreement::kNothing;
    const double gap = std::abs(check.estimate.mean - check.difference.mean);
    if (std::abs(check.t) > kCheckThreshold && gap > std::max(kCheckRounding * size, rounding))
        return Agreement::kDisagree;
    return 4 * std::max(error, rounding) > size ? Agreement::kTooNoisy : Agreement::kAgree;
}

/// Of one direction of one texture, by batches.
struct Batches {
    std::vector<double> estimates, differences, jumps;
    double rounding = 0;  ///< about that of a difference
};

/// How a texture's values decide which paths samples take.
enum class Draws { kNothing, kRoulette, kPaths, kParts };

Draws draws_of(const Scene& scene, TextureId texture) {
    if (weighs_parts(scene, texture)) return Draws::kParts;
    if (draws_paths(scene, texture)) return Draws::kPaths;
    const bool has_roulette = has_bounces(scene) && scene.rr_depth < scene.max_depth;
    return has_roulette ? Draws::kRoulette : Draws::kNothing;
}

/// Whether the verdict is one only where enough batches have jumps. Of parts of blends differences
/// are jumps alone: without them nothing agrees either. Roulette may end no path that counts.
bool asks_for_jumps(const GradientCheck& check, Draws draws, const std::vector<double>& jumps) {
    if (draws == Draws::kParts) return check.agreement != Agreement::kNothing;
    if (check.agreement != Agreement::kDisagree) return false;
    const bool any = std::ranges::any_of(jumps, [](double jump) { return jump > 0; });
    return draws == Draws::kPaths || (draws == Draws::kRoulette && any);
}

GradientCheck check_of(const Batches& batches, Draws draws) {
    std::vector<double> gaps;
    for (std::size_t i = 0; i < batches.estimates.size(); ++i)
        gaps.push_back(batches.estimates[i] - batches.differences[i]);
    const CheckedMean gap = mean_of(gaps);
    GradientCheck check;
    check.estimate = mean_of(batches.estimates), check.difference = mean_of(batches.differences);
    check.t = gap.mean == 0 ? 0 : gap.mean / gap.standard_error;  // infinite where nothing is noisy
    check.agreement = agreement_of(check, batches.rounding);
    if (asks_for_jumps(check, draws, batches.jumps) && !is_told(batches.jumps, check))
        check.agreement = Agreement::kTooNoisy;
    return check;
}

}  // namespace

Theta within_steps(Theta theta) {
    for (ThetaTexture& t : theta.textures)
        for (float& v : t.values.values) v = std::clamp(v, 2 * kCheckStep, 1 - 2 * kCheckStep);
    return theta;
}

std::vector<GradientCheck> check_gradient(const CheckGradientOptions& options,
                                          const TracedScene& view, const Theta& theta,
                                          const Progress& report) {
    if (options.samples < kCheckBatches)
        throw InputError("samples per pixel are " + std::to_string(options.samples) +
                         ": expected at least " + std::to_string(kCheckBatches) +
                         ", one for each batch");
    const std::uint32_t passes = (options.samples + kCheckBatches - 1) / kCheckBatches;
    const Binding binding(view, theta);
    const std::size_t slots = theta.textures.size();
    std::vector<Directions> directions;
    for (const ThetaTexture& t : theta.textures)
        directions.push_back(directions_of(t.values, view.film, options.seed));
    std::vector<std::array<Batches, kDirections>> batches(slots);
    const auto all = static_cast<double>(kDirections * kCheckBatches * slots);
    double done = 0;
    for (std::size_t d = 0; d < kDirections && slots > 0; ++d)
        for (std::uint32_t batch = 0; batch < kCheckBatches; ++batch) {
            const std::uint32_t seed = seed_of_half(options.seed, batch);
            const auto gradient = mean_gradient({options.estimator, passes, seed}, binding,
                                                directions.front()[d].adjoint);
            for (std::size_t slot = 0; slot < slots; ++slot) {
                const Direction& along = directions[slot][d];
                batches[slot][d].estimates.push_back(dot(gradient[slot], along.texels));
                const Difference images =
                    difference(view, theta, slot, along, {seed, Stream::kEvaluation}, passes);
                batches[slot][d].differences.push_back(images.slope);
                batches[slot][d].jumps.push_back(images.jump);
                batches[slot][d].rounding = std::max(batches[slot][d].rounding, images.rounding);
                if (report) report(++done / all);
            }
        }
    std::vector<GradientCheck> checks;
    for (std::size_t slot = 0; slot < slots; ++slot)
        for (std::size_t d = 0; d < kDirections; ++d) {
            const Draws draws = draws_of(*view.scene, theta.textures[slot].texture);
            checks.push_back(check_of(batches[slot][d], draws));
            checks.back().slot = slot, checks.back().direction = directions[slot][d].name;
        }
    return checks;
}

}  // namespace burnish
