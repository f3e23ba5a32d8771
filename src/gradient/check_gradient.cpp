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

/// sum A I with a texture moved by so many steps.
double weighed_image(const TracedScene& view, Theta theta, std::size_t slot, const Direction& d,
                     int steps, RandomKey key, std::uint32_t passes) {
    Image& texels = theta.textures[slot].values;
    for (std::size_t i = 0; i < texels.values.size(); ++i)
        texels.values[i] += static_cast<float>(steps) * kCheckStep * d.texels.values[i];
    const Binding binding(view, theta);
    return dot(render(unknown_part(binding, key, passes), 0, passes), d.adjoint);
}

/// Central difference of fourth order under common random numbers.
double difference(const TracedScene& view, const Theta& theta, std::size_t slot, const Direction& d,
                  RandomKey key, std::uint32_t passes) {
    const auto at = [&](int steps) {
        return weighed_image(view, theta, slot, d, steps, key, passes);
    };
    return (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * double{kCheckStep});
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

/// Parts of blends are drawn: the difference of a batch is rounding unless a sample takes another
/// part within the steps. Few batches in which one does tell neither mean nor standard error.
bool is_told(const std::vector<double>& differences, const GradientCheck& check) {
    constexpr double kRounding = 1e-3;
    return std::ranges::count_if(differences, [&](double d) {
               return std::abs(d) > kRounding * size_of(check);
           }) >= kCheckDrawn;
}

Agreement agreement_of(const GradientCheck& check) {
    const double error = std::max(check.estimate.standard_error, check.difference.standard_error);
    const double size = size_of(check);
    if (size == 0 && error == 0) return Agreement::kNothing;
    const double gap = std::abs(check.estimate.mean - check.difference.mean);
    if (std::abs(check.t) > kCheckThreshold && gap > kCheckRounding * size)
        return Agreement::kDisagree;
    return 4 * error > size ? Agreement::kTooNoisy : Agreement::kAgree;
}

/// Of one direction of one texture, by batches.
struct Batches {
    std::vector<double> estimates, differences;
};

/// drawn: whether the texture weighs parts of blends.
GradientCheck check_of(const Batches& batches, bool drawn) {
    std::vector<double> gaps;
    for (std::size_t i = 0; i < batches.estimates.size(); ++i)
        gaps.push_back(batches.estimates[i] - batches.differences[i]);
    const CheckedMean gap = mean_of(gaps);
    GradientCheck check;
    check.estimate = mean_of(batches.estimates), check.difference = mean_of(batches.differences);
    check.t = gap.standard_error > 0 ? gap.mean / gap.standard_error : 0;
    check.agreement = agreement_of(check);
    if (drawn && !is_told(batches.differences, check) && check.agreement != Agreement::kNothing)
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
                batches[slot][d].differences.push_back(
                    difference(view, theta, slot, along, {seed, Stream::kEvaluation}, passes));
                if (report) report(++done / all);
            }
        }
    std::vector<GradientCheck> checks;
    for (std::size_t slot = 0; slot < slots; ++slot)
        for (std::size_t d = 0; d < kDirections; ++d) {
            const bool drawn = weighs_parts(*view.scene, theta.textures[slot].texture);
            checks.push_back(check_of(batches[slot][d], drawn));
            checks.back().slot = slot, checks.back().direction = directions[slot][d].name;
        }
    return checks;
}

}  // namespace burnish
