// The share of the work of many threads that is done, as it is told.
#pragma once

#include <atomic>
#include <cstdint>
#include <utility>

#include "burnish/renderer.h"

namespace burnish {

/// Tells a progress of the share that is done, one call at a time. A thread that comes while
/// another one tells does not wait: the call may start loops of its own, whose threads come here
/// again.
class Telling {
  public:
    /// all: of what is added.
    Telling(const Progress& progress, double all) : progress_(progress), all_(all) {}

    void add(std::uint32_t done) {
        done_ += done;
        tell();
    }
    /// What was not told yet; of nothing, that it is done.
    void tell() {
        if (!progress_ || is_telling_.exchange(true)) return;
        const Ended ended{is_telling_};
        const std::uint64_t done = done_;
        if (all_ == 0)
            progress_(1);
        else if (done > std::exchange(told_, done))
            progress_(static_cast<double>(done) / all_);
    }

  private:
    struct Ended {
        std::atomic<bool>& is_telling;
        ~Ended() { is_telling = false; }
    };
    const Progress& progress_;
    double all_;
    std::atomic<std::uint64_t> done_ = 0;
    std::atomic<bool> is_telling_ = false;
    std::uint64_t told_ = 0;  ///< by who tells
};

}  // namespace burnish
