// Instantiates every kernel for PC_LANES lanes of PC_SCALAR: loops and pointers, no arithmetic.
#include "cpu/kernels.h"
#include "cpu/prelude.h"

// variants of a text have no use for all of its parameters
#pragma GCC diagnostic ignored "-Wunused-parameter"

namespace pcphys {
namespace PC_NAMESPACE {

using Info = InfoOf<Scalar>;

// element types of the buffers, and the lengths of their rows
using element_bodies = uint;
using element_contact_ends = uint;
using element_contact_order = uint;
using element_joint_ends = uint;
using element_joint_order = uint;
using element_joint_paths = uint;
using element_tree_blocks = uint;
using element_tree_parents = uint;
using element_tree_ends = uint;
using element_tree_order = uint;
using element_contact_paths = uint;
using element_nets = uint;
using element_island_ends = uint;
using element_island_labels = uint;
#define PC_TABLE(table, doc)
#define PC_BUFFER(table, buffer, quads, doc) \
  using element_##buffer = Scalar;           \
  constexpr uint quads_##buffer = quads;
#define PC_PROPERTY(table, buffer, offset, type, name, role, initial, unit, doc)
#include "kernels/properties.inl"
#undef PC_TABLE
#undef PC_BUFFER
#undef PC_PROPERTY
#define PC_ROWS(domain, buffer, reals) \
  using element_##buffer = Scalar;     \
  constexpr uint reals_##buffer = reals;
#include "kernels/kernels.inl"
#undef PC_ROWS

// the pointers of one kernel
#define PC_READ(buffer) const element_##buffer* buffer;
#define PC_WRITE(buffer) element_##buffer* buffer;
#define PC_KERNEL(name, domain, stage, accesses) \
  namespace name {                               \
  struct Io {                                    \
    accesses const Info* info;                   \
  };                                             \
  }
#include "kernels/kernels.inl"
#undef PC_READ
#undef PC_WRITE
#undef PC_KERNEL

// each kernel's text in the namespace of its name; written by pcphys_list_kernels,
// as C++ cannot include by a macro list
#include "kernel_texts.inl"

// loops, by domain
#define PC_LOOP_body \
  for (uint k = call.begin; k < call.end; k += PC_LANES) pc_kernel(io, pc_index(io.bodies + k));
#define PC_LOOP_contact \
  for (uint block = call.begin; block < call.end; block++) pc_kernel(io, Slot{block});
#define PC_LOOP_free_contact PC_LOOP_contact
#define PC_LOOP_tree_contact PC_LOOP_contact
#define PC_LOOP_joint PC_LOOP_contact
#define PC_LOOP_free_joint PC_LOOP_contact
#define PC_LOOP_tree_joint PC_LOOP_contact
#define PC_LOOP_tree PC_LOOP_contact
#define PC_LOOP_tree_nodes PC_LOOP_contact
#define PC_LOOP_net PC_LOOP_contact
#define PC_LOOP_row \
  for (uint k = call.begin; k < call.end; k++) pc_kernel(io, k);
#define PC_LOOP_edge PC_LOOP_row
#define PC_READ(buffer) io.buffer = static_cast<const element_##buffer*>(call.buffers[unsigned(Buffer::buffer)]);
#define PC_WRITE(buffer) io.buffer = static_cast<element_##buffer*>(call.buffers[unsigned(Buffer::buffer)]);
#define PC_KERNEL(name, domain, stage, accesses)                      \
  namespace name {                                                    \
  static __attribute__((noinline)) void run(const KernelCall& call) { \
    Io io;                                                            \
    accesses io.info = static_cast<const Info*>(call.info);           \
    PC_LOOP_##domain                                                  \
  }                                                                   \
  }
#include "kernels/kernels.inl"
#undef PC_READ
#undef PC_WRITE
#undef PC_KERNEL

}  // namespace PC_NAMESPACE

const CpuKernels PC_EXPORT = {PC_LANES,
                              sizeof(PC_SCALAR) == 8,
                              {
#define PC_KERNEL(name, domain, stage, accesses) PC_NAMESPACE::name::run,
#include "kernels/kernels.inl"
#undef PC_KERNEL
                              }};

}  // namespace pcphys
