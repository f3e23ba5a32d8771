#include "footprints.h"

#include <algorithm>

#include "core/parallel.h"
#include "gradient/theta.h"
#include "paths/trace.h"
#include "render/film.h"
#include "render/renderer.h"

namespace burnish {

namespace {

constexpr std::uint32_t kPasses = 16;

/// The texel that each camera sample of a pass meets, -1: none; and the pass's filter.
struct Pass {
    FilterTaps x, y;
    std::vector<std::int64_t> texels;  ///< [crop_height, crop_width]
};

Pass trace_pass(const TraceInput& input, const Bitmap& bitmap, const PassTaps& taps,
                std::uint32_t pass) {
    const Film& film = input.scene->film;
    const auto pixels = static_cast<std::size_t>(pixels_of(film));
    Pass p{taps[pass][0], taps[pass][1], std::vector<std::int64_t>(pixels, -1)};
    parallel_chunks(pixels, kBatchSamples, [&](std::size_t begin, std::size_t end) {
        std::vector<BatchSample> samples(end - begin);
        for (std::size_t i = begin; i < end; ++i)
            samples[i - begin].camera = {static_cast<std::uint32_t>(i), 0, pass};
        BatchOutput out;
        trace_batch(input, samples, out);
        for (const DirectSample& d : out.direct_samples) {
            if (d.vertex > 0 || !d.has_unknowns) continue;
            const TexelFootprint foot = footprint(bitmap, d.record.uv);
            const auto max =
                std::max_element(foot.weight.begin(), foot.weight.begin() + foot.count);
            p.texels[begin + static_cast<std::size_t>(d.sample)] =
                foot.texel[static_cast<std::size_t>(max - foot.weight.begin())];
        }
    });
    return p;
}

/// Calls body(pixel, texel, weight) for each pixel that a sample reaches.
template <class Body>
void for_taps(const Pass& p, int width, int height, const Body& body) {
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const std::int64_t texel = p.texels[static_cast<std::size_t>(y * width + x)];
            if (texel < 0) continue;
            for (int dy = std::max(-p.y.halo, -y); dy <= std::min(p.y.halo, height - 1 - y); ++dy)
                for (int dx = std::max(-p.x.halo, -x); dx <= std::min(p.x.halo, width - 1 - x);
                     ++dx)
                    body(static_cast<std::size_t>((y + dy) * width + x + dx),
                         static_cast<std::size_t>(texel),
                         p.x.weight[static_cast<std::size_t>(dx + p.x.halo)] *
                             p.y.weight[static_cast<std::size_t>(dy + p.y.halo)]);
        }
}

/// Sums of values and of their weights.
struct Sums {
    std::vector<float> values, weights;

    explicit Sums(std::size_t n) : values(n), weights(n) {}
    void add(std::size_t i, float weight, float value) {
        values[i] += weight * value, weights[i] += weight;
    }
    float mean(std::size_t i) const { return weights[i] > 0 ? values[i] / weights[i] : 0; }
};

/// Of each texel what the pixels of a view see there.
Sums seen_by(const Renderer& view, TextureId texture, const Image& texels, int channel) {
    const TracedScene& scene = view.data().traced;
    const Theta theta{{{texture, texels}}};
    const TextureTable table = texture_table(*scene.scene, theta);
    const std::vector<char> unknown = unknown_bsdfs(*scene.scene, theta);
    TraceInput input;
    input.scene = &scene, input.textures = &table, input.key = {0, Stream::kProbe};
    input.unknown_bsdfs = unknown, input.keep_black = true;
    input.choice = SurfaceChoice::kUnknown;
    const auto& bitmap = std::get<Bitmap>((*scene.scene)[texture]);
    const PassTaps taps = pass_taps(scene.film.filter, input.key, 0, kPasses);
    const int width = scene.film.crop_width, height = scene.film.crop_height;
    const auto value = [&](std::size_t texel) {
        return texels.values[texel * static_cast<std::size_t>(texels.channels) +
                             static_cast<std::size_t>(channel)];
    };
    std::vector<Pass> passes;
    for (std::uint32_t i = 0; i < kPasses; ++i)
        passes.push_back(trace_pass(input, bitmap, taps, i));
    Sums pixels(passes.front().texels.size());
    Sums seen(static_cast<std::size_t>(texels.width) * static_cast<std::size_t>(texels.height));
    for (const Pass& p : passes)
        for_taps(p, width, height, [&](std::size_t pixel, std::size_t texel, float weight) {
            pixels.add(pixel, weight, value(texel));
        });
    for (const Pass& p : passes)
        for_taps(p, width, height, [&](std::size_t pixel, std::size_t texel, float weight) {
            seen.add(texel, weight, pixels.mean(pixel));
        });
    return seen;
}

}  // namespace

Image over_footprints(const std::vector<Renderer>& views, TextureId texture, const Image& texels) {
    constexpr int kBlock = 8;
    Image result = texels;
    const int width = texels.width, height = texels.height;
    for (int c = 0; c < texels.channels; ++c) {
        std::vector<Sums> seen;
        for (const Renderer& view : views) seen.push_back(seen_by(view, texture, texels, c));
        for (int y0 = 0; y0 < height; y0 += kBlock)
            for (int x0 = 0; x0 < width; x0 += kBlock) {
                const auto for_texels = [&](const auto& body) {
                    for (int y = y0; y < std::min(height, y0 + kBlock); ++y)
                        for (int x = x0; x < std::min(width, x0 + kBlock); ++x)
                            body(x, y, static_cast<std::size_t>(y * width + x));
                };
                Sums best(1);
                const Sums* from = nullptr;
                for (const Sums& s : seen) {
                    Sums block(1);
                    for_texels(
                        [&](int, int, std::size_t i) { block.add(0, s.weights[i], s.mean(i)); });
                    if (block.weights[0] > best.weights[0]) best = block, from = &s;
                }
                if (!from) continue;
                for_texels([&](int x, int y, std::size_t i) {
                    result.at(x, y, c) = from->weights[i] > 0 ? from->mean(i) : best.mean(0);
                });
            }
    }
    return result;
}

}  // namespace burnish
