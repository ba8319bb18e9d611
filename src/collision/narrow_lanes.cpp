#include "collision/narrow_lanes.h"

namespace pcphys {

template <> const NarrowLanes<float>& narrow_lanes(std::uint32_t lanes) {
#ifdef PCPHYS_HAVE_X86_LANES
  if (lanes != 1 && lanes != 4 && __builtin_cpu_supports("avx2")) return narrow_lanes_f8;
  if (lanes != 1 && __builtin_cpu_supports("sse4.2")) return narrow_lanes_f4;
#else
  (void)lanes;
#endif
  return narrow_lanes_f1;
}
template <> const NarrowLanes<double>& narrow_lanes(std::uint32_t lanes) {
#ifdef PCPHYS_HAVE_X86_LANES
  if (lanes != 1 && __builtin_cpu_supports("avx2")) return narrow_lanes_d4;
#else
  (void)lanes;
#endif
  return narrow_lanes_d1;
}

}  // namespace pcphys
