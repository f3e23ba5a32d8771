#include "gradient/candidate.h"

#include <algorithm>
#include <bit>
#include <span>
#include <utility>

#include "core/parallel.h"

namespace burnish {

namespace {

using Runs = std::vector<std::span<const Candidate>>;

constexpr int kDigitBits = 11;         // a histogram stays within the L1 cache
constexpr std::size_t kMaxParts = 64;  // of the runs, counted and moved in parallel

/// Texels numbered through all textures.
struct TexelNumbers {
    std::uint64_t slots = 1, texels = 1;  ///< bounds of TexelKey's numbers

    std::uint64_t operator()(const TexelKey& key) const { return key.slot * texels + key.texel; }
    int bits() const { return static_cast<int>(std::bit_width(slots * texels - 1)); }
};

TexelNumbers number_texels(const Runs& runs) {
    std::vector<TexelNumbers> of_runs(runs.size());
    parallel_for(runs.size(), [&](std::size_t r) {
        TexelNumbers& n = of_runs[r];
        for (const Candidate& c : runs[r]) {
            n.slots = std::max(n.slots, std::uint64_t{c.d.key.slot} + 1);
            n.texels = std::max(n.texels, std::uint64_t{c.d.key.texel} + 1);
        }
    });
    TexelNumbers all;
    for (const TexelNumbers& n : of_runs)
        all = {std::max(all.slots, n.slots), std::max(all.texels, n.texels)};
    return all;
}

/// Which bits of a texel's number a pass sorts by.
struct Digit {
    TexelNumbers number;
    int shift = 0, bits = 0;

    std::size_t operator()(const Candidate& c) const {
        return (number(c.d.key) >> shift) & (count() - 1);
    }
    std::size_t count() const { return std::size_t{1} << bits; }
};

/// A stable pass of counting sort.
void sort_by_digit(const Runs& runs, const Digit& digit, std::vector<Candidate>& out) {
    const std::size_t parts = std::min(runs.size(), kMaxParts);
    const auto each = [&](std::size_t part, const auto& body) {
        for (std::size_t r = part * runs.size() / parts; r < (part + 1) * runs.size() / parts; ++r)
            for (const Candidate& c : runs[r]) body(c);
    };
    // Counts, then where the next candidate of a digit goes.
    std::vector<std::vector<std::size_t>> places(parts);
    parallel_for(parts, [&](std::size_t part) {
        places[part].assign(digit.count(), 0);
        each(part, [&](const Candidate& c) { ++places[part][digit(c)]; });
    });
    std::size_t next = 0;
    for (std::size_t d = 0; d < digit.count(); ++d)
        for (std::vector<std::size_t>& place : places) next += std::exchange(place[d], next);
    out.resize(next);
    parallel_for(parts, [&](std::size_t part) {
        each(part, [&](const Candidate& c) { out[places[part][digit(c)]++] = c; });
    });
}

Runs runs_of(const std::vector<Candidate>& items) {
    constexpr std::size_t kRun = 8192;
    Runs runs;
    for (std::size_t begin = 0; begin < items.size(); begin += kRun)
        runs.push_back(std::span(items).subspan(begin, std::min(kRun, items.size() - begin)));
    return runs;
}

}  // namespace

std::vector<Candidate> sort_by_texel(std::vector<std::vector<Candidate>> unsorted) {
    Runs runs(unsorted.begin(), unsorted.end());
    const TexelNumbers number = number_texels(runs);
    const int passes = std::max(1, (number.bits() + kDigitBits - 1) / kDigitBits);
    const int bits = (number.bits() + passes - 1) / passes;
    std::vector<Candidate> sorted, other;
    for (int pass = 0; pass < passes; ++pass) {
        sort_by_digit(runs, {number, pass * bits, bits}, sorted);
        if (pass == 0) unsorted.clear(), unsorted.shrink_to_fit();
        if (pass + 1 == passes) break;
        std::swap(sorted, other);
        runs = runs_of(other);
    }
    return sorted;
}

}  // namespace burnish
