// What runs the loops of parallel.h: TBB, or plain threads in its place where the thread sanitizer
// is to see their synchronisation.
#pragma once

#include <cstddef>
#include <functional>

namespace burnish {

/// Calls body(i) for every i in [0, count), in parallel. The first exception ends the loop.
void run_loop(std::size_t count, const std::function<void(std::size_t)>& body);

/// Limits the threads of loops until the limit is lifted; limits are lifted in reverse order.
void* limit_threads(std::size_t threads);
void lift_limit(void* limit);

}  // namespace burnish
