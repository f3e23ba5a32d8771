// Parallel loops over fixed chunks. Chunk boundaries never depend on the number of threads, so that
// a reduction folded in chunk order gives the same bytes on any machine.
#pragma once

#include <cstddef>
#include <functional>

namespace burnish {

/// Calls body(begin, end) for consecutive chunks of at most `chunk` indices of [0, count), in
/// parallel.
void parallel_chunks(std::size_t count, std::size_t chunk,
                     const std::function<void(std::size_t, std::size_t)>& body);

/// Calls body(i) for every i in [0, count), in parallel.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);

/// Limits the threads of everything below it while it lives; 0 means all cores.
class ThreadLimit {
  public:
    explicit ThreadLimit(int threads);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;

  private:
    void* control_;
};

}  // namespace burnish
