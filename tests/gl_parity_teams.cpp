// As gl_parity.cpp, of trees of which few are of a shape: trees of several shapes side by side in one work group, and
// one shared by a group, in two orders; what a barrier parts is the same in both precisions.
#include <utility>

#include "gl_parity_calls.h"

using namespace parity;

namespace {

template <class Scalar>
void compare_trees(Precision precision, const CpuKernels& reference, GlTeam wanted, const char* what) {
  require_parity(precision);
  const GlTeam before = std::exchange(gl_team(), wanted);
  const std::unique_ptr<Backend> at = require_gl(precision);
  gl_team() = before;
  compare<Scalar>(reference, what, [&](Kernel kernel, std::size_t info, State<Scalar>& state) {
    if (of_trees(schema(kernel).domain))
      run_gl(*at, 1, kernel, info, state);
    else
      run_cpu(reference, kernel, info, state);
  });
}

}  // namespace

TEST_CASE("GL equals scalar float: a tree a block") {
  compare_trees<float>(Precision::f32, cpu_kernels_f1, {1}, "GL, a tree a block");
}
TEST_CASE("GL equals scalar float: a tree a work group, in two orders") {
  compare_trees<float>(Precision::f32, cpu_kernels_f1, {32}, "GL, a tree a work group");
  compare_trees<float>(Precision::f32, cpu_kernels_f1, {32, true}, "GL, a tree a work group in another order");
}
TEST_CASE("GL equals scalar double: a tree a block, and a work group") {
  compare_trees<double>(Precision::f64, cpu_kernels_d1, {1}, "GL, a tree a block");
  compare_trees<double>(Precision::f64, cpu_kernels_d1, {32}, "GL, a tree a work group");
}
