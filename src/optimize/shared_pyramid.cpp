#include "optimize/shared_pyramid.h"

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
        std::memcpy(theirs.data(), message.data(), values.size_bytes());
        for (std::size_t i = 0; i < values.size(); ++i) values[i] += theirs[i];
    }
}

void share_moved(const Ranks& ranks, const std::vector<MovedFloats>& arrays) {
    std::string mine;
    for (const MovedFloats& a : arrays)
        put_blocks({a.values.data()}, a.dirty, own_range(a.values.size(), ranks.rank, ranks.count),
                   mine);
    const std::vector<std::string> came = all_gather(ranks, mine);
    for (int r = 0; r < ranks.count; ++r) {
        if (r == ranks.rank) continue;
        MessageReader message(came[static_cast<std::size_t>(r)]);
        for (const MovedFloats& a : arrays)
            message.get_blocks({a.values.data()}, own_range(a.values.size(), r, ranks.count),
                               a.dirty);
    }
}

template <class T>
void gather(const Ranks& ranks, std::size_t floats, std::size_t per, std::vector<T>& array) {
    const auto came = all_gather(ranks, message_of(array.data(), array.size()));
    const bool parts = is_part(came.front().size() / sizeof(T), floats, per, ranks);
    std::size_t size = 0, at = 0;
    const std::size_t count = parts ? came.size() : 1;  // what is no part is the first one's
    for (std::size_t r = 0; r < count; ++r) size += came[r].size();
    array.resize(size / sizeof(T));
    for (std::size_t r = 0; r < count; ++r) {
        if (!came[r].empty())
            std::memcpy(reinterpret_cast<char*>(array.data()) + at, came[r].data(), came[r].size());
        at += came[r].size();
    }
}

}  // namespace

std::vector<PyramidPart> own_parts(const Setup& setup) {
    const Ranks& ranks = setup.problem.ranks;
    std::vector<PyramidPart> parts;
    for (const UnknownTexture& u : setup.unknowns)
        parts.push_back(part_of(u.maps, u.start.channels, ranks.rank, ranks.count));
    return parts;
}

std::vector<GradientShape> gradient_shapes(const Setup& setup) {
    std::vector<GradientShape> shapes;
    for (const UnknownTexture& u : setup.unknowns) {
        GradientShape shape{u.start.width, u.start.height, u.start.channels,
                            has_split_gradient(setup.options.estimator)};
        const int count = setup.problem.ranks.count;
        for (int r = 0; r < count; ++r)
            shape.parts.push_back(part_of(u.maps, shape.channels, r, count).front().read);
        shapes.push_back(std::move(shape));
    }
    return shapes;
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
