// Not part of the tests' program: what a kernel may not write does not compile. tests/CMakeLists.txt names one of them
// after the other to the compiler and looks for its refusal; with none named it all compiles.
#include "pcphys/pcphys.h"
#include "pcphys/write_kernel.h"

#ifndef OF_A_ROW
#define OF_A_ROW rate
#endif
#ifndef OF_A_PAIR
#define OF_A_PAIR rate
#endif
#ifndef OF_A_JOINT
#define OF_A_JOINT rate_a
#endif

namespace {

PCPHYS_KERNEL(of_a_row, (PC_IN(Real) age, PC_PARAM(Real) limit, PC_INOUT(Real) rate), {
  rate = age * limit;
  OF_A_ROW = 1;
})

PCPHYS_PAIR_KERNEL(of_a_pair, (PC_SELF(Real) mine, PC_OTHER(Real) mine_other, PC_ADD(Real) rate), {
  rate = mine * mine_other;
  OF_A_PAIR = 1;
})

PCPHYS_KERNEL(of_a_joint, (PC_A(Real) load_a, PC_B(Real) load_b, PC_ADD_A(Real) rate_a), {
  rate_a = load_a * load_b;
  OF_A_JOINT = 1;
})

}  // namespace

int main() { return of_a_row::text().name && of_a_pair::text().name && of_a_joint::text().name ? 0 : 1; }
