// Pins the contract of the whole library, kernel by kernel: the same text gives the same bits as scalar C++,
// as SIMD lanes and as GLSL, in float and double. Covered: static and kinematic bodies, padding slots,
// zero vectors, colours, trees of several shapes (free, and hanging from what is fixed), locked and infinite
// limits, contacts and joints of trees with themselves, each other and the rest, many turns, small and large values.
// On a device that cannot round exactly (see `pcphys doctor`) parity is not promised, and this test says so.
#include "gl_parity_calls.h"

namespace {
using namespace parity;

template <class Scalar> void compare_lanes(const CpuKernels& reference, const CpuKernels& lanes) {
  const std::string what = std::to_string(lanes.lanes) + " lanes";
  compare<Scalar>(reference, what.c_str(),
                  [&](Kernel kernel, std::size_t info, State<Scalar>& state) { run_cpu(lanes, kernel, info, state); });
}

}  // namespace

TEST_CASE("GL equals scalar float, kernel by kernel") { compare_gl<float>(Precision::f32, cpu_kernels_f1); }

#ifdef PCPHYS_HAVE_X86_LANES
TEST_CASE("four lanes of float equal scalar") { compare_lanes<float>(cpu_kernels_f1, cpu_kernels_f4); }
TEST_CASE("eight lanes of float equal scalar") {
  if (__builtin_cpu_supports("avx2")) compare_lanes<float>(cpu_kernels_f1, cpu_kernels_f8);
}
TEST_CASE("eight lanes of float with AVX-512 equal scalar") {
  if (has_avx512()) compare_lanes<float>(cpu_kernels_f1, cpu_kernels_f8v);
}
TEST_CASE("scalars with AVX-512 equal scalar") {
  if (!has_avx512()) return;
  compare_lanes<float>(cpu_kernels_f1, cpu_kernels_f1v);
  compare_lanes<double>(cpu_kernels_d1, cpu_kernels_d1v);
}
TEST_CASE("four lanes of double equal scalar") {
  if (__builtin_cpu_supports("avx2")) compare_lanes<double>(cpu_kernels_d1, cpu_kernels_d4);
}
#endif

/// The comparison itself must be able to fail: the contents are neither empty nor constant, and no value
/// has left the numbers (not-a-number spreads, and compares as equal).
TEST_CASE("the contents that parity is checked on move, and stay numbers") {
  for (const Mood& mood : moods) {
    State<float> state = made<float>(mood);
    std::string first;
    for (const Call& call : calls(3)) {
      if (!mood.loops && closes_loops(call.kernel)) continue;
      const State<float> before = state;
      run_cpu(cpu_kernels_f1, call.kernel, call.info, state);
      const std::string where = std::string(schema(call.kernel).name) + ", " + mood.name;
      INFO(where);
      CHECK(differences(call.kernel, before, state, first) > 50);
      for (std::size_t b = 0; b < buffer_count; b++) {
        const std::vector<float>& reals = state.reals[b];
        // free angles of coloured joints are infinite
        const bool infinite =
            Buffer(b) == Buffer::joint_frame || Buffer(b) == Buffer::joint_solved || Buffer(b) == Buffer::joint_rows;
        const auto is_bad = [&](float x) { return infinite ? x != x : !std::isfinite(x); };
        const std::ptrdiff_t bad = std::find_if(reals.begin(), reals.end(), is_bad) - reals.begin();
        const std::ptrdiff_t row = std::max(1, int(schema(Buffer(b)).reals));
        INFO(std::string(schema(Buffer(b)).name) << " row " << bad / row << " real " << bad % row);
        CHECK(bad == std::ptrdiff_t(reals.size()));
      }
    }
  }
}
