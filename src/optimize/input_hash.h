// An input of a run, as the hash of its values.
#pragma once

#include <utility>

#include "burnish/input.h"
#include "core/archive.h"
#include "core/hash.h"

namespace burnish {

/// write(ArchiveWriter&) writes the values.
template <class Write>
Input hashed_input(std::string name, const Write& write) {
    Hasher hasher;
    Input result{std::move(name), 0, 0};
    ArchiveWriter archive([&](const void* from, std::size_t size) {
        hasher.add(from, size);
        result.bytes += size;
    });
    write(archive);
    result.hash = hasher.hash();
    return result;
}

}  // namespace burnish
