// Flush-to-zero while a step runs: GPUs flush subnormals, and on CPUs they are slow. The host's own setting
// comes back afterwards.
#pragma once
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace pcphys {

class FlushSubnormals {
 public:
  FlushSubnormals(const FlushSubnormals&) = delete;
  FlushSubnormals& operator=(const FlushSubnormals&) = delete;
#if defined(__SSE2__)
  // FTZ and DAZ on, rounding to nearest, no traps: what every kernel was compiled for
  FlushSubnormals() : before_(_mm_getcsr()) { _mm_setcsr(0x9fc0); }
  ~FlushSubnormals() { _mm_setcsr(before_); }

 private:
  unsigned before_;
#else
  FlushSubnormals() = default;
#endif
};

}  // namespace pcphys
