// Hashes of bytes, to tell whether they are the same: XXH3, 64 bits.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

namespace burnish {

std::uint64_t hash_of(std::string_view bytes);

/// Of bytes that come in parts.
class Hasher {
  public:
    Hasher();
    void add(const void* bytes, std::size_t size);
    std::uint64_t hash() const;

  private:
    struct Free {
        void operator()(void* state) const;
    };
    std::unique_ptr<void, Free> state_;
};

}  // namespace burnish
