#include "gradient/candidates.h"

#include <algorithm>
#include <cmath>

#include "core/contract.h"
#include "core/parallel.h"
#include "gradient/texel_ranges.h"

namespace burnish {

namespace {

constexpr std::size_t kChunk = 2048;

std::size_t chunks_of(std::size_t count, std::size_t chunk) { return (count + chunk - 1) / chunk; }

/// |g|^2 / |w|^2, finite.
float relative_square(double g_square, const Rgbf& adjoint) {
    constexpr double kMax = 1e30;  // sums of them stay finite
    const double w_square = double{dot(adjoint, adjoint)};
    return w_square > 0 ? static_cast<float>(std::min(g_square / w_square, kMax)) : 0.0f;
}

Candidates differentiate_chunk(const DerivativeInput& input, const TracedPaths& traced,
                               std::size_t begin, std::size_t end) {
    Candidates chunk;
    TexelDerivatives texels;
    for (std::size_t i = begin; i < end; ++i) {
        const PathRecord& record = traced.paths[i].record;
        if (traced.places.empty())
            differentiate(input, record, texels);
        else
            differentiate(input, record, scattered_by_others(traced.chains, traced.places[i]),
                          texels);
        double square = 0;
        for (int k = 0; k < texels.count; ++k) {
            const TexelDerivative& d = texels.items[static_cast<std::size_t>(k)];
            if (!std::isfinite(d.q) || !is_finite(d.g)) {
                ++chunk.rejected;
                continue;
            }
            chunk.items.push_back({d, static_cast<std::uint32_t>(i)});
            square += double{dot(d.g, d.g)};
            const Outlier contribution{largest_channel(d.g), record.pixel, d.key.slot, d.key.texel,
                                       record.technique};
            if (stands_out_more(contribution, chunk.largest)) chunk.largest = contribution;
        }
        chunk.squares.push_back({record.pixel, relative_square(square, texels.adjoint)});
    }
    return chunk;
}

/// What one batch of samples brought.
TracedPaths trace_chunk(const TraceInput& input, std::span<const BatchSample> samples) {
    BatchOutput out;
    trace_batch(input, samples, out);
    TracedPaths chunk;
    chunk.rejected = out.rejected;
    for (const DirectSample& direct_sample : out.direct_samples)
        chunk.paths.push_back({{samples[static_cast<std::size_t>(direct_sample.sample)].camera,
                                direct_sample.record.technique, direct_sample.vertex},
                               direct_sample.record,
                               direct_sample.hit});
    return chunk;
}

/// The same in paths to one light each.
TracedPaths trace_chunk_of_chains(const TraceInput& input, const Binding& binding,
                                  std::span<const BatchSample> samples) {
    ChainOutput out;
    trace_chains(input, samples, out);
    for (ChainVertex& v : out.vertices) {
        if (!is_black(v.emitted)) v.f_light = scattered(binding, {v.bsdf, v.uv, v.wi, v.wo_light});
        if (!is_black(v.gathered) || !is_black(v.onward))
            v.f_next = scattered(binding, {v.bsdf, v.uv, v.wi, v.wo_next});
    }
    std::vector<LightPath> paths;
    TracedPaths chunk;
    chunk.rejected = out.rejected + append_light_paths(input, samples, out, paths);
    for (const LightPath& path : paths) {
        chunk.paths.push_back(
            {{samples[static_cast<std::size_t>(path.sample)].camera, path.record.technique,
              static_cast<std::uint16_t>(path.place.vertex - path.place.begin)},
             path.record});
        chunk.places.push_back(path.place);
    }
    chunk.chains = std::move(out.vertices);
    return chunk;
}

TracedPaths join(const std::vector<TracedPaths>& chunks) {
    TracedPaths all;
    concatenate(chunks, &TracedPaths::paths, all.paths);
    concatenate(chunks, &TracedPaths::chains, all.chains);
    std::uint32_t first = 0;
    for (const TracedPaths& chunk : chunks) {
        for (const auto& [begin, vertex, last, technique] : chunk.places)
            all.places.push_back({first + begin, first + vertex, first + last, technique});
        first += static_cast<std::uint32_t>(chunk.chains.size());
        all.rejected += chunk.rejected;
    }
    return all;
}

/// Calls trace(samples) for `count` chunks of samples in parallel, and joins what they bring.
/// samples_of: of a chunk's index.
TracedPaths trace_chunks(const TraceInput& input, const Binding* vertices_under, std::size_t count,
                         const auto& samples_of) {
    const bool chains = vertices_under && has_bounces(*input.scene->scene);
    std::vector<TracedPaths> chunks(count);
    parallel_for(count, [&](std::size_t c) {
        const auto& samples = samples_of(c);
        chunks[c] = chains ? trace_chunk_of_chains(input, *vertices_under, samples)
                           : trace_chunk(input, samples);
    });
    return join(chunks);
}

}  // namespace

std::vector<BatchSample> trial_samples(std::span<const char> pixels, std::size_t max_samples) {
    const auto all = static_cast<std::size_t>(std::count(pixels.begin(), pixels.end(), 1));
    const std::size_t every = (all + max_samples - 1) / max_samples;
    std::vector<BatchSample> samples;
    std::size_t count = 0;
    for (std::uint32_t pixel = 0; pixel < pixels.size(); ++pixel)
        if (pixels[pixel] && count++ % every == 0) samples.push_back({{pixel, 0, 0}});
    return samples;
}

TracedPaths trace_paths(const TraceInput& input, std::uint32_t iteration, std::uint32_t passes,
                        const Binding* vertices_under) {
    // Batches are blocks of 32 x 32 pixels of one pass: neighbours share packets and texels.
    const Film& film = input.scene->film;
    constexpr int kBlock = 32;
    static_assert(kBlock * kBlock <= kBatchSamples);
    const int columns = (film.crop_width + kBlock - 1) / kBlock,
              rows = (film.crop_height + kBlock - 1) / kBlock;
    const std::size_t blocks = static_cast<std::size_t>(columns * rows);
    return trace_chunks(input, vertices_under, blocks * passes, [&](std::size_t c) {
        const auto pass = static_cast<std::uint32_t>(c / blocks);
        const int bx = static_cast<int>(c % blocks) % columns * kBlock,
                  by = static_cast<int>(c % blocks) / columns * kBlock;
        std::vector<BatchSample> samples;
        for (int y = by; y < std::min(by + kBlock, film.crop_height); ++y)
            for (int x = bx; x < std::min(bx + kBlock, film.crop_width); ++x)
                samples.push_back(
                    {{static_cast<std::uint32_t>(y * film.crop_width + x), iteration, pass}});
        return samples;
    });
}

TracedPaths trace_paths(const TraceInput& input, std::span<const BatchSample> samples,
                        const Binding* vertices_under) {
    const std::size_t chunks = chunks_of(samples.size(), kBatchSamples);
    return trace_chunks(input, vertices_under, chunks, [&](std::size_t c) {
        const std::size_t begin = c * kBatchSamples;
        return samples.subspan(begin, std::min<std::size_t>(kBatchSamples, samples.size() - begin));
    });
}

std::vector<PathRecord> trace_again(const TraceInput& input, std::span<const PathSample> paths,
                                    std::size_t& rejected) {
    std::vector<PathRecord> records(paths.size());
    std::vector<BatchSample> samples;
    BatchOutput out;
    for (std::size_t begin = 0; begin < paths.size(); begin += kBatchSamples) {
        samples.clear();
        for (const PathSample& p :
             paths.subspan(begin).first(std::min<std::size_t>(kBatchSamples, paths.size() - begin)))
            samples.push_back(
                {p.camera, p.technique == Technique::kEmitter, p.technique == Technique::kBsdf});
        trace_batch(input, samples, out);
        rejected += out.rejected;
        for (const DirectSample& d : out.direct_samples) {
            const std::size_t i = begin + static_cast<std::size_t>(d.sample);
            if (d.vertex == paths[i].vertex && d.record.technique == paths[i].technique)
                records[i] = d.record;
        }
    }
    return records;
}

std::vector<PathRecord> replay_paths(const TraceInput& input, std::span<const PathSample> paths,
                                     std::span<const Hit> hits, std::vector<PathRecord> records,
                                     std::size_t& rejected) {
    if (has_bounces(*input.scene->scene)) return trace_again(input, paths, rejected);
    BURNISH_REQUIRE(hits.size(), ==, paths.size());
    BURNISH_REQUIRE(records.size(), ==, paths.size());
    std::vector<CameraSample> samples;
    std::vector<Hit> hits_of_samples;
    std::vector<std::size_t> places;  // of the samples' paths
    std::vector<PathRecord> replayed;
    for (const Technique technique : {Technique::kEmitter, Technique::kBsdf}) {
        const auto replay = [&] {
            rejected += replay_batch(input, technique, samples, hits_of_samples, replayed);
            for (std::size_t i = 0; i < places.size(); ++i) records[places[i]] = replayed[i];
            samples.clear(), hits_of_samples.clear(), places.clear(), replayed.clear();
        };
        for (std::size_t i = 0; i < paths.size(); ++i) {
            if (paths[i].technique != technique) continue;
            samples.push_back(paths[i].camera), hits_of_samples.push_back(hits[i]);
            places.push_back(i), replayed.push_back(records[i]);
            if (places.size() == kBatchSamples) replay();
        }
        replay();
    }
    return records;
}

Candidates make_candidates(const DerivativeInput& input, TracedPaths traced) {
    std::vector<Candidates> chunks(chunks_of(traced.paths.size(), kChunk));
    parallel_chunks(traced.paths.size(), kChunk, [&](std::size_t begin, std::size_t end) {
        chunks[begin / kChunk] = differentiate_chunk(input, traced, begin, end);
    });
    Candidates all;
    std::vector<std::vector<Candidate>> items;
    for (Candidates& chunk : chunks) {
        items.push_back(std::move(chunk.items));
        all.rejected += chunk.rejected;
        if (stands_out_more(chunk.largest, all.largest)) all.largest = chunk.largest;
    }
    concatenate(chunks, &Candidates::squares, all.squares);
    all.items = sort_by_texel(std::move(items));
    all.rejected += traced.rejected;
    all.traced = std::move(traced);
    return all;
}

std::uint32_t passes_per_iteration(const Sampling& sampling) {
    return sampling.adaptive ? kMaxOfMean * sampling.samples_per_pixel : sampling.samples_per_pixel;
}

PassTaps derivative_taps(const Binding& binding, const Sampling& sampling,
                         std::uint32_t iteration) {
    return pass_taps(binding.film().filter, {sampling.seed, Stream::kDerivative},
                     first_pass(sampling, iteration), passes_per_iteration(sampling));
}

Integrand make_integrand(const Binding& binding, const Image& normalized_adjoint,
                         const PassTaps& taps, const Sampling& sampling, TargetFunction target) {
    return {{&binding, &normalized_adjoint, &taps, target},
            unknown_derivatives(binding, {sampling.seed, Stream::kDerivative},
                                passes_per_iteration(sampling))};
}

namespace {

const Binding* vertices_under(const Integrand& integrand, const Sampling& sampling) {
    return sampling.keep_vertices ? integrand.derivative.binding : nullptr;
}

/// As many in every pixel.
Candidates draw_uniform(const Integrand& integrand, std::uint32_t iteration,
                        const Sampling& sampling) {
    TracedPaths traced = trace_paths(integrand.trace, iteration, sampling.samples_per_pixel,
                                     vertices_under(integrand, sampling));
    for (TracedPath& p : traced.paths) p.share = 1 / static_cast<float>(sampling.samples_per_pixel);
    return make_candidates(integrand.derivative, std::move(traced));
}

/// Where pixels matter most to the gradient.
Candidates draw_adaptive(const Integrand& integrand, std::uint32_t iteration,
                         const Sampling& sampling, PixelStatistics& statistics) {
    const Binding& binding = *integrand.derivative.binding;
    if (statistics.seen.empty()) statistics = make_pixel_statistics(binding);
    const std::vector<float> expected =
        expected_samples(binding.film(), *integrand.derivative.normalized_adjoint,
                         static_cast<float>(sampling.samples_per_pixel), statistics);
    const auto samples = choose_samples(binding.film(), expected, sampling.seed, iteration,
                                        passes_per_iteration(sampling));
    TracedPaths traced = trace_paths(integrand.trace, samples, vertices_under(integrand, sampling));
    for (TracedPath& p : traced.paths) p.share = 1 / expected[p.record.pixel];
    Candidates candidates = make_candidates(integrand.derivative, std::move(traced));
    update_statistics(samples, candidates.squares, statistics);
    return candidates;
}

}  // namespace

Candidates draw_candidates(const Integrand& integrand, std::uint32_t iteration,
                           const Sampling& sampling, PixelStatistics& statistics) {
    return sampling.adaptive ? draw_adaptive(integrand, iteration, sampling, statistics)
                             : draw_uniform(integrand, iteration, sampling);
}

}  // namespace burnish
