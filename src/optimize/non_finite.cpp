#include "optimize/non_finite.h"

#include <fmt/format.h>

#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/parallel.h"
#include "gradient/estimator.h"
#include "optimize/batch.h"
#include "render/render.h"

namespace burnish {

namespace {

/// A million squares of it are a finite float.
constexpr float kMaxGradient = 1e15f;

/// By the bits, which is true of what is not finite, too, and vectorises.
bool is_too_large(float v) {
    return (std::bit_cast<std::uint32_t>(v) & 0x7fffffffu) >
           std::bit_cast<std::uint32_t>(kMaxGradient);
}

bool is_usable(const Image& gradient, const DirtyBlocks& dirty) {
    std::atomic<bool> usable{true};
    parallel_chunks(
        gradient.values.size(), kParallelFloats, [&](std::size_t begin, std::size_t end) {
            std::uint32_t bad = 0;
            for_dirty_intervals(dirty, begin, end, [&](std::size_t i, std::size_t last) {
                for (; i < last; ++i) bad |= is_too_large(gradient.values[i]);
            });
            if (bad) usable = false;
        });
    return usable;
}

}  // namespace

std::size_t leave_out_non_finite(Image& image) {
    std::atomic<std::size_t> count{0};
    parallel_chunks(image.values.size(), kParallelFloats, [&](std::size_t i, std::size_t end) {
        std::size_t bad = 0;
        for (; i < end; ++i)
            if (!std::isfinite(image.values[i])) image.values[i] = 0, ++bad;
        count += bad;
    });
    return count;
}

bool is_usable(const SplitGradient& gradient) {
    return is_usable(gradient.first, gradient.dirty) && is_usable(gradient.second, gradient.dirty);
}

std::size_t leave_out_unusable(SplitGradient& gradient, std::size_t begin, std::size_t end) {
    std::size_t count = 0;
    for (Image* half : {&gradient.first, &gradient.second})
        for (std::size_t i = 0; i < half->values.size(); ++i)
            if (is_too_large(half->values[i])) {
                half->values[i] = 0;
                count += i >= begin && i < end;
            }
    return count;
}

std::string non_finite_text(const Setup& setup, const Iteration& i) {
    const Estimator& estimator = setup.options.estimator;
    const std::optional<KeptCache> kept = kept_cache(estimator);
    const std::uint32_t each =
        kept ? fresh_passes(kept->options.samples, kept->options.window) : image_samples(estimator);
    const double samples = pixels_of_iteration(setup) * each + static_cast<double>(i.paths);
    const auto rejected = static_cast<double>(i.rejected_image + i.rejected_derivatives);
    if (rejected <= kMaxRejectedShare * samples) return {};
    return fmt::format(
        "iteration {}: {} of about {:.0f} samples were not finite, expected at most one in 1000: "
        "values of the scene or of the loss are too large, or not finite",
        i.number, rejected, samples);
}

}  // namespace burnish
