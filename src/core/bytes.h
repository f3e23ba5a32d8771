// Numbers in the bytes of a file.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace burnish {

/// The unsigned number of `size` bytes, at most eight, that begins at `at`; 0 where it does not end
/// within the bytes.
inline std::uint64_t number_at(std::string_view bytes, std::size_t at, std::size_t size,
                               std::endian order = std::endian::little) {
    if (at > bytes.size() || size > bytes.size() - at) return 0;
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < size; ++i) {
        const std::size_t place = order == std::endian::little ? i : size - 1 - i;
        number |= std::uint64_t{static_cast<unsigned char>(bytes[at + i])} << (8 * place);
    }
    return number;
}

}  // namespace burnish
