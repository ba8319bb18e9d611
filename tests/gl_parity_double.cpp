// As gl_parity.cpp, of double; a file of its own, since a software GL compiles for minutes.
#include "gl_parity_calls.h"

using namespace parity;

TEST_CASE("GL equals scalar double, kernel by kernel") { compare_gl<double>(Precision::f64, cpu_kernels_d1); }
