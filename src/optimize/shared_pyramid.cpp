#include "optimize/shared_pyramid.h"

#include <algorithm>
#include <cstring>

#include "gradient/estimator.h"
#include "optimize/block_message.h"
#include "optimize/ranks.h"

namespace burnish {

namespace {

void add_up(const Ranks& ranks, std::span<double> values) {
    const auto came = all_gather(ranks, message_of(values.data(), values.size()));
    std::vector<double> theirs(values.size());
    std::fill(values.begin(), values.end(), 0.0);
    for (const std::string& message : came) {
        require_bytes(message, values.size_bytes());
        std::memcpy(theirs.data(), message.data(), values.size_bytes());
        for (std::size_t i = 0; i < values.size(); ++i) values[i] += theirs[i];
    }
}

void share_moved(const Ranks& ranks, const std::vector<MovedFloats>& arrays) {
    std::string mine;
    ArchiveWriter writer(sink_into(mine));
    for (const MovedFloats& a : arrays)
        put_blocks({a.values.data()}, a.dirty, own_range(a.values.size(), ranks.rank, ranks.count),
                   writer);
    const std::vector<std::string> came = all_gather(ranks, mine);
    for (int r = 0; r < ranks.count; ++r) {
        if (r == ranks.rank) continue;
        ArchiveReader message = reader_of(came[static_cast<std::size_t>(r)]);
        for (const MovedFloats& a : arrays)
            get_blocks({a.values.data()}, own_range(a.values.size(), r, ranks.count), a.dirty,
                       message);
        message.require_end();
    }
}

/// What the first process, which sends `first`, may have of an array that lies in no parts: none,
/// AdamState::initial as a block that repeats, or all.
std::size_t whole_entries(std::size_t first, std::size_t all) {
    return first == 0 || first == kDirtyBlock ? first : all;
}

template <class T>
void gather(const Ranks& ranks, std::size_t floats, std::size_t per, std::vector<T>& array) {
    auto came = all_gather(ranks, message_of(array.data(), array.size()));
    const std::size_t first = came.front().size() / sizeof(T);
    const bool parts = is_part(first, floats, per, ranks);
    if (!parts) came.resize(1);  // what is no part is the first one's
    std::size_t entries = 0;
    for (int r = 0; r < (parts ? ranks.count : 1); ++r) {
        const std::size_t own = parts ? entries_of(own_range(floats, r, ranks.count), per).size()
                                      : whole_entries(first, entries_of({0, floats}, per).size());
        require_bytes(came[static_cast<std::size_t>(r)], own * sizeof(T));
        entries += own;
    }
    array.resize(entries);
    char* to = reinterpret_cast<char*>(array.data());
    for (const std::string& message : came) to = std::copy(message.begin(), message.end(), to);
}

}  // namespace

std::vector<PyramidPart> own_parts(const Setup& setup) {
    const Ranks& ranks = setup.problem.ranks;
    std::vector<PyramidPart> parts;
    for (const UnknownTexture& u : setup.unknowns)
        parts.push_back(part_of(u.maps, u.start.channels, ranks.rank, ranks.count));
    return parts;
}

std::vector<GradientParts> gradient_parts(const Setup& setup) {
    const int count = setup.problem.ranks.count;
    std::vector<GradientParts> gradients;
    for (const UnknownTexture& u : setup.unknowns) {
        GradientParts& gradient = gradients.emplace_back();
        gradient.split = has_split_gradient(setup.options.estimator);
        for (int r = 0; r < count; ++r)
            gradient.parts.push_back(part_of(u.maps, u.start.channels, r, count).front().read);
    }
    return gradients;
}

PartExchange exchange_of(const Ranks& ranks) {
    if (ranks.count == 1) return {};
    return {[&ranks](std::span<double> values) { add_up(ranks, values); },
            [&ranks](const std::vector<MovedFloats>& arrays) { share_moved(ranks, arrays); }};
}

void gather_parts(const Ranks& ranks, std::vector<PyramidState>& pyramids) {
    if (ranks.count == 1) return;
    for (PyramidState& pyramid : pyramids)
        for_parted_arrays(pyramid, [&](auto& array, std::size_t floats, std::size_t per) {
            gather(ranks, floats, per, array);
        });
}

}  // namespace burnish
