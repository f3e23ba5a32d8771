// Messages of numbers and of the dirty blocks of arrays.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "burnish/error.h"
#include "core/kept_blocks.h"
#include "optimize/ranks.h"

namespace burnish {

template <class T>
void put(std::string& message, const T& value) {
    message.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Of arrays that share their flags: each run of dirty blocks of a range, as begin and end, counted
/// from that of the range, and the floats of each array.
inline void put_blocks(const std::vector<const float*>& arrays, const DirtyBlocks& dirty,
                       const IndexRange& range, std::string& message) {
    for_dirty_intervals(dirty, range.begin, range.end, [&](std::size_t from, std::size_t to) {
        put(message, std::uint64_t{from - range.begin});
        put(message, std::uint64_t{to - range.begin});
        for (const float* array : arrays)
            message.append(reinterpret_cast<const char*>(array + from),
                           (to - from) * sizeof(float));
    });
    put(message, ~std::uint64_t{0});
}

/// Reads what put and put_blocks wrote. Throws Error where a message is too short, or its blocks
/// lie outside of their range.
class MessageReader {
  public:
    explicit MessageReader(const std::string& bytes) : bytes_(bytes) {}
    bool at_end() const { return at_ == bytes_.size(); }
    template <class T>
    T get() {
        T value;
        copy(&value, sizeof value);
        return value;
    }
    /// Into a range as long as the one that they were of. What came becomes dirty.
    void get_blocks(const std::vector<float*>& arrays, const IndexRange& range,
                    DirtyBlocks& dirty) {
        for (auto from = get<std::uint64_t>(); from != ~std::uint64_t{0};
             from = get<std::uint64_t>()) {
            const auto to = get<std::uint64_t>();
            if (from >= to || to > range.size())
                throw Error(fmt::format("an exchange gave values {} to {}, expected some of {}",
                                        from, to, range.size()));
            const std::size_t begin = range.begin + from, end = range.begin + to;
            for (float* array : arrays) copy(array + begin, (end - begin) * sizeof(float));
            mark_dirty(dirty, begin, end);
        }
    }
    /// Throws Error where there is more.
    void require_end() const { require_bytes(bytes_, at_); }

  private:
    void copy(void* to, std::size_t size) {
        const std::size_t left = bytes_.size() - at_;
        if (size > left)
            throw Error(fmt::format("an exchange gave a message of {} bytes, expected {} more",
                                    bytes_.size(), size - left));
        std::memcpy(to, bytes_.data() + at_, size);
        at_ += size;
    }
    const std::string& bytes_;
    std::size_t at_ = 0;
};

}  // namespace burnish
