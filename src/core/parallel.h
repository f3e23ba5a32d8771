// Parallel loops over fixed chunks. Chunk boundaries never depend on the number of threads, so that
// a reduction folded in chunk order gives the same bytes on any machine. Numbers below 2^-126 are 0
// in them (core/flush_denormals.h).
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

/// The same of tasks that may throw: all are called; then what the least i has thrown is thrown,
/// the same for any number of threads.
void parallel_tasks(std::size_t count, const std::function<void(std::size_t)>& body);
/// The same, at most `at_once` of them at a time; 0 counts as 1. Not stopped between them.
void parallel_tasks(std::size_t count, std::size_t at_once,
                    const std::function<void(std::size_t)>& body);

/// What a loop throws that was stopped.
struct Stopped {};
/// Whether to stop; asked by any thread.
using StopQuestion = std::function<bool()>;

/// While it lives, loops that this thread starts ask before each chunk, and throw Stopped where the
/// answer is yes. Empty: they ask nobody.
class Stoppable {
  public:
    explicit Stoppable(const StopQuestion& stop);
    ~Stoppable();
    Stoppable(const Stoppable&) = delete;
    Stoppable& operator=(const Stoppable&) = delete;

  private:
    const StopQuestion* outer_;
};

/// The number of threads that a setting means: 0 and less are one for each processor.
std::size_t threads_of(int setting);

/// Limits the threads of everything below it while it lives to threads_of(threads).
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
