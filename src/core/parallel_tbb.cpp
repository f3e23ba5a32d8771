#include "core/parallel_loop.h"

#ifndef BURNISH_PLAIN_THREADS  // those are in parallel_threads.cpp

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

namespace burnish {

void run_loop(std::size_t count, const std::function<void(std::size_t)>& body) {
    tbb::parallel_for(std::size_t{0}, count, body);
}

void* limit_threads(std::size_t threads) {
    return new tbb::global_control(tbb::global_control::max_allowed_parallelism, threads);
}
void lift_limit(void* limit) { delete static_cast<tbb::global_control*>(limit); }

}  // namespace burnish

#endif
