// Pyramids of which each of several processes steps a part: what the parts say to each other, and
// the whole that they are together.
#pragma once

#include "optimize/setup.h"
#include "optimize/view_sum.h"
#include "texture/pyramid_step.h"

namespace burnish {

/// The process's part of each unknown.
std::vector<PyramidPart> own_parts(const Setup& setup);

/// Of the gradient by each unknown: each process gets what its part reads.
std::vector<GradientParts> gradient_parts(const Setup& setup);

/// By messages of all processes to all.
PartExchange exchange_of(const Ranks& ranks);

/// Makes whole pyramids of the parts of all processes, on each of them. What is whole stays so.
void gather_parts(const Ranks& ranks, std::vector<PyramidState>& pyramids);

/// Whether an array of for_parted_arrays holds the first process's entries only, seen from there.
inline bool is_part(std::size_t entries, std::size_t floats, std::size_t per, const Ranks& ranks) {
    const std::size_t own = entries_of(own_range(floats, 0, ranks.count), per).size();
    return entries == own && own != entries_of({0, floats}, per).size();
}

}  // namespace burnish
