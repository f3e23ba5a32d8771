#include "core/pages.h"

#include "core/parallel.h"

namespace burnish {

void touch_pages(void* begin, std::size_t bytes) {
    constexpr std::size_t kPage = 4096, kChunk = 512 * kPage;
    if (bytes <= kChunk) return;  // whoever fills it is as fast
    parallel_chunks(bytes, kChunk, [&](std::size_t i, std::size_t end) {
        for (; i < end; i += kPage) static_cast<volatile char*>(begin)[i] = 0;
    });
}

}  // namespace burnish
