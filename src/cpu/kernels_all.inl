// Instantiates every kernel for PC_LANES lanes of PC_SCALAR: loops and pointers, no arithmetic.
#include "cpu/kernels.h"
#include "cpu/prelude.h"

namespace pcphys {
namespace PC_NAMESPACE {

using Info = InfoOf<Scalar>;

// element types of the buffers, and the lengths of their rows
using element_bodies = uint;
using element_contact_ends = uint;
using element_contact_order = uint;
using element_joint_ends = uint;
using element_joint_order = uint;
#define PC_TABLE(table, doc)
#define PC_BUFFER(table, buffer, quads, doc) using element_##buffer = Scalar; constexpr uint quads_##buffer = quads;
#define PC_PROPERTY(table, buffer, offset, type, name, role, initial, unit, doc)
#include "kernels/properties.inl"
#undef PC_TABLE
#undef PC_BUFFER
#undef PC_PROPERTY
#define PC_ROWS(domain, buffer, reals) using element_##buffer = Scalar; constexpr uint reals_##buffer = reals;
#include "kernels/kernels.inl"
#undef PC_ROWS

// the pointers of one kernel
#define PC_READ(buffer) const element_##buffer* buffer;
#define PC_WRITE(buffer) element_##buffer* buffer;
#define PC_KERNEL(name, domain, stage, accesses) namespace name { struct Io { accesses const Info* info; }; }
#include "kernels/kernels.inl"
#undef PC_READ
#undef PC_WRITE
#undef PC_KERNEL

#define PC_KERNEL_TEXT(name) namespace name
PC_KERNEL_TEXT(begin) {
#include "kernels/begin.inl"
}
PC_KERNEL_TEXT(begin_drag) {
#include "kernels/begin_drag.inl"
}
PC_KERNEL_TEXT(integrate) {
#include "kernels/integrate.inl"
}
PC_KERNEL_TEXT(integrate_drag) {
#include "kernels/integrate_drag.inl"
}
PC_KERNEL_TEXT(remember) {
#include "kernels/remember.inl"
}
PC_KERNEL_TEXT(advance) {
#include "kernels/advance.inl"
}
PC_KERNEL_TEXT(advance_round) {
#include "kernels/advance_round.inl"
}
PC_KERNEL_TEXT(synchronise) {
#include "kernels/synchronise.inl"
}
PC_KERNEL_TEXT(joint_prepare) {
#include "kernels/joint_prepare.inl"
}
PC_KERNEL_TEXT(joint_solve) {
#include "kernels/joint_solve.inl"
}
PC_KERNEL_TEXT(contact_prepare) {
#include "kernels/contact_prepare.inl"
}
PC_KERNEL_TEXT(contact_warm) {
#include "kernels/contact_warm.inl"
}
PC_KERNEL_TEXT(contact_solve) {
#include "kernels/contact_solve.inl"
}
PC_KERNEL_TEXT(contact_restitution) {
#include "kernels/contact_restitution.inl"
}
PC_KERNEL_TEXT(contact_store) {
#include "kernels/contact_store.inl"
}
#undef PC_KERNEL_TEXT

// loops, by domain
#define PC_LOOP_body for (uint k = call.begin; k < call.end; k += PC_LANES) pc_kernel(io, pc_index(io.bodies + k));
#define PC_LOOP_contact for (uint block = call.begin; block < call.end; block++) pc_kernel(io, Slot{block});
#define PC_LOOP_joint PC_LOOP_contact
#define PC_READ(buffer) io.buffer = static_cast<const element_##buffer*>(call.buffers[unsigned(Buffer::buffer)]);
#define PC_WRITE(buffer) io.buffer = static_cast<element_##buffer*>(call.buffers[unsigned(Buffer::buffer)]);
#define PC_KERNEL(name, domain, stage, accesses)                     \
  namespace name {                                                   \
  static __attribute__((noinline)) void run(const KernelCall& call) { \
    Io io;                                                           \
    accesses io.info = static_cast<const Info*>(call.info);          \
    PC_LOOP_##domain                                                 \
  }                                                                  \
  }
#include "kernels/kernels.inl"
#undef PC_READ
#undef PC_WRITE
#undef PC_KERNEL

}  // namespace PC_NAMESPACE

const CpuKernels PC_EXPORT = {PC_LANES, sizeof(PC_SCALAR) == 8, {
#define PC_KERNEL(name, domain, stage, accesses) PC_NAMESPACE::name::run,
#include "kernels/kernels.inl"
#undef PC_KERNEL
}};

}  // namespace pcphys
