// Memory of large arrays. The system clears a page when it is first written, which takes most of
// the time of filling a new array: here all threads have it done.
#pragma once

#include <cstddef>
#include <vector>

namespace burnish {

/// Writes to every page of uninitialised memory.
void touch_pages(void* begin, std::size_t bytes);

/// Reserves room for `count` values, whose pages are there then. The values stay.
template <class T>
void reserve_pages(std::size_t count, std::vector<T>& values) {
    if (count <= values.capacity()) return;
    values.reserve(count);
    touch_pages(values.data() + values.size(), (count - values.size()) * sizeof(T));
}

}  // namespace burnish
