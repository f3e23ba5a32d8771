// Loopy belief propagation on the regions of a texture. A region r with its neighbours N(r) sends
//
//   m_{r -> s}(b) = min_a  cost_r(a) + sum_{q in N(r), q != s} m_{q -> r}(a) + distance(a, b)
//
// less its minimum over b, in rounds in which all send at once.
#include <algorithm>
#include <limits>

#include "core/parallel.h"
#include "texture/regions.h"

namespace burnish {

namespace {

constexpr int kRounds = 12;
constexpr std::size_t kChunk = 64;

/// The pairs of neighbours, once in each direction: those into region r are [begin[r],
/// begin[r + 1]).
struct Edges {
    std::vector<std::size_t> begin;
    std::vector<std::uint32_t> from;
    std::vector<std::size_t> opposite;  ///< the same pair the other way
};

Edges make_edges(const TextureRegions& regions, const std::vector<char>& present) {
    Edges e;
    for (std::uint32_t r = 0; r < regions.regions.size(); ++r) {
        e.begin.push_back(e.from.size());
        if (!present[r]) continue;
        for (const std::uint32_t n : neighbours(regions, r))
            if (present[n]) e.from.push_back(n);
    }
    e.begin.push_back(e.from.size());
    e.opposite.resize(e.from.size());
    for (std::uint32_t r = 0; r < regions.regions.size(); ++r)
        for (std::size_t i = e.begin[r]; i < e.begin[r + 1]; ++i) {
            const std::uint32_t n = e.from[i];
            const auto back = std::find(e.from.begin() + static_cast<std::ptrdiff_t>(e.begin[n]),
                                        e.from.end(), r);
            e.opposite[i] = static_cast<std::size_t>(back - e.from.begin());
        }
    return e;
}

/// A region's own costs and all that it was sent.
std::vector<float> belief_of(std::size_t region, const Edges& edges, std::span<const float> costs,
                             std::span<const float> messages, std::size_t labels) {
    std::vector<float> belief(labels);
    for (std::size_t a = 0; a < labels; ++a) belief[a] = costs[region * labels + a];
    for (std::size_t i = edges.begin[region]; i < edges.begin[region + 1]; ++i)
        for (std::size_t a = 0; a < labels; ++a) belief[a] += messages[i * labels + a];
    return belief;
}

/// What a region sends along `opposite`, whose other way it was sent `received`.
void send(std::vector<float> belief, std::span<const float> received,
          std::span<const float> distance, float factor, std::span<float> message) {
    const std::size_t labels = belief.size();
    for (std::size_t a = 0; a < labels; ++a) belief[a] -= received[a];
    float min = std::numeric_limits<float>::infinity();
    for (std::size_t b = 0; b < labels; ++b) {
        float m = std::numeric_limits<float>::infinity();
        for (std::size_t a = 0; a < labels; ++a)
            m = std::min(m, belief[a] + factor * distance[b * labels + a]);
        message[b] = m;
        min = std::min(min, m);
    }
    for (float& m : message) m -= min;
}

}  // namespace

std::vector<std::uint32_t> label_regions(const TextureRegions& regions,
                                         const std::vector<char>& present,
                                         std::span<const float> costs,
                                         std::span<const float> distance,
                                         std::span<const std::uint32_t> kinds) {
    constexpr float kUnlike = 0.07f;
    const auto factor = [&](std::size_t a, std::size_t b) {
        return kinds.empty() || kinds[a] == kinds[b] ? 1 : kUnlike;
    };
    const std::size_t count = regions.regions.size();
    std::vector<std::uint32_t> label(count, 0);
    if (count == 0) return label;
    const std::size_t labels = costs.size() / count;
    const Edges edges = make_edges(regions, present);
    std::vector<float> messages(edges.from.size() * labels, 0.0f), next(messages.size());
    for (int round = 0; round < kRounds; ++round) {
        parallel_chunks(count, kChunk, [&](std::size_t r, std::size_t end) {
            for (; r < end; ++r) {
                const auto belief = belief_of(r, edges, costs, messages, labels);
                for (std::size_t i = edges.begin[r]; i < edges.begin[r + 1]; ++i)
                    send(belief, std::span(messages).subspan(i * labels, labels), distance,
                         factor(r, edges.from[i]),
                         std::span(next).subspan(edges.opposite[i] * labels, labels));
            }
        });
        messages.swap(next);
    }
    for (std::uint32_t r = 0; r < count; ++r) {
        if (!present[r]) continue;
        const auto belief = belief_of(r, edges, costs, messages, labels);
        label[r] = static_cast<std::uint32_t>(std::min_element(belief.begin(), belief.end()) -
                                              belief.begin());
    }
    return label;
}

}  // namespace burnish
