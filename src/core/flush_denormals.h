// Numbers below the normal ones count as 0 while loops run.
#pragma once

#ifdef __SSE__
#include <xmmintrin.h>
#endif

namespace burnish {

/// On this thread while it lives: results and operands below 2^-126 are 0. Moments decay to such
/// numbers, with which some processors are a hundred times slower. To be asked for: who starts a
/// thread, or loads a library, decides otherwise, and the same program could make other bytes.
class FlushDenormals {
  public:
#ifdef __SSE__
    FlushDenormals() : before_(_mm_getcsr()) {
        _mm_setcsr(before_ | kFlushResults | kFlushOperands);
    }
    ~FlushDenormals() { _mm_setcsr(before_); }

  private:
    static constexpr unsigned kFlushResults = 1u << 15, kFlushOperands = 1u << 6;
    unsigned before_;

  public:
#else
    FlushDenormals() = default;
    ~FlushDenormals() {}  // other processors are as fast with them
#endif
    FlushDenormals(const FlushDenormals&) = delete;
    FlushDenormals& operator=(const FlushDenormals&) = delete;
};

}  // namespace burnish
