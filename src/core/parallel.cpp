#include "core/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <thread>

namespace burnish {

void parallel_chunks(std::size_t count, std::size_t chunk,
                     const std::function<void(std::size_t, std::size_t)>& body) {
    const std::size_t chunks = (count + chunk - 1) / chunk;
    tbb::parallel_for(std::size_t{0}, chunks,
                      [&](std::size_t i) { body(i * chunk, std::min(count, (i + 1) * chunk)); });
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
    tbb::parallel_for(std::size_t{0}, count, body);
}

ThreadLimit::ThreadLimit(int threads) {
    const std::size_t n = threads > 0
                              ? static_cast<std::size_t>(threads)
                              : std::max<std::size_t>(1, std::thread::hardware_concurrency());
    control_ = new tbb::global_control(tbb::global_control::max_allowed_parallelism, n);
}

ThreadLimit::~ThreadLimit() { delete static_cast<tbb::global_control*>(control_); }

}  // namespace burnish
