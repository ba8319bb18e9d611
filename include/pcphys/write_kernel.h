// Kernels of the host's own: a function of one row of a table, run by the step over all of them, on the CPU, on the GPU
// or on either.
//
//   PCPHYS_KERNEL(wind_drag,
//                 (PC_IN(Vec3) displacement_rate, PC_IN(Real) area, PC_INOUT(Vec3) force, PC_PARAM(Vec3) wind), {
//     Vec3 past = pc_sub(wind, displacement_rate);
//     Real push = area * pc_length(past);
//     force = pc_madd(force, past, push);
//   })
//   stepper.add_kernel(world, {.text = wind_drag::text(), .parameters = {{"wind", Vec3{5, 0, 0}}}});
//
// The signature declares what is read (PC_IN), changed (PC_INOUT), written anew (PC_OUT) and given with the kernel
// (PC_PARAM). Names are those of properties, the library's (docs/properties.md) or the host's own; types Real, Vec3,
// Quaternion, Quad (four numbers), Sym3, Mat3, float, double, int, uint. The parameters `h` (Real: the sub-step, or the
// step of a kernel that runs once a step) and `gravity` (Vec3) need not be given. From one text come a C++ function and
// a GLSL program; in both what is PC_IN or PC_PARAM is const. Of the library's properties a kernel may write force,
// torque, displacement_rate and angular_momentum.
//
// Of a body and each other one, all or those within KernelDef::cutoff: PC_SELF and PC_OTHER read (the other's names end
// in _other), PC_ADD and PC_SUM name the properties that take the sum of what the text gives for each pair, added or in
// place of what was there.
//
//   PCPHYS_PAIR_KERNEL(push_apart, (PC_SELF(Vec3) position, PC_OTHER(Vec3) position_other, PC_ADD(Vec3) force), {
//     force = pc_sub(position, position_other);
//   })
//
// Of a joint and the two bodies that it joins, over joint_table: PC_A and PC_B read of a body (the names end in _a and
// _b), PC_ADD_A and PC_ADD_B name what the text gives to it; a body takes the sum of its joints. PC_IN, PC_INOUT and
// PC_OUT are of the joint.
//
//   PCPHYS_KERNEL(bond,
//                 (PC_A(Vec3) position_a, PC_B(Vec3) position_b, PC_ADD_A(Vec3) force_a, PC_ADD_B(Vec3) force_b), {
//     force_a = pc_sub(position_b, position_a);
//     force_b = pc_negate(force_a);
//   })
//   stepper.add_kernel(world, {.text = bond::text(), .over = joint_table});
//
// Of all rows to one value: PC_SUM, PC_MIN, PC_MAX in a PCPHYS_KERNEL name properties
// of a table of one row. docs/own-kernels.md
//
// Not part of pcphys.h: kernels' text needs macros of short names (precise, PC_REAL, ...).
#pragma once
#include <cstring>
#include <tuple>
#include <utility>

#include "pcphys/kernel.h"
#include "pcphys/kernel_text.h"
#include "pcphys/pair_loop.h"

namespace pcphys {

namespace detail {
template <auto Run, class = decltype(Run)> struct RowLoop;
template <auto Run, class... Arguments> struct RowLoop<Run, void (*)(Arguments...)> {
  /// By its address: inlined together, each loop has fewer registers than alone.
  static void run(const KernelRows& k) {
    const auto loop = k.joined ? &run_all<true> : &run_all<false>;
    loop(k);
  }

 private:
  template <class Argument, class T> static void store(std::byte* p, const T& value) {
    if constexpr (std::is_reference_v<Argument>) std::memcpy(p, &value, sizeof value);
  }
  template <bool joined> static std::byte* place(const KernelRows& k, std::uint32_t n, std::size_t row, std::size_t i) {
    if constexpr (joined) row = k.joined[3 * std::size_t{n} + k.of_three[i]];
    return k.columns[i] + row * k.strides[i];
  }
  template <bool joined> static void run_all(const KernelRows& k) {
    run_each<joined>(k, std::index_sequence_for<Arguments...>());
  }
  template <bool joined, std::size_t... I> static void run_each(const KernelRows& k, std::index_sequence<I...>) {
    for (std::uint32_t n = k.begin; n < k.end; n++) {
      const std::size_t row = k.rows ? k.rows[n] : n;
      std::tuple<std::remove_cvref_t<Arguments>...> values{
          load<std::remove_cvref_t<Arguments>>(place<joined>(k, n, row, I))...};
      Run(std::get<I>(values)...);
      (store<Arguments>(place<joined>(k, n, row, I), std::get<I>(values)), ...);
    }
  }
};

template <class... Arguments> consteval std::size_t count_arguments(void (*)(Arguments...)) {
  return sizeof...(Arguments);
}
}  // namespace detail

#define PCPHYS_KERNEL_SIDE(side, signature, ...)            \
  struct side {                                             \
    using Real = ::pcphys::kernel_##side::Real;             \
    using Vec3 = ::pcphys::kernel_##side::Vec3;             \
    using Quad = ::pcphys::kernel_##side::Quad;             \
    using Quaternion = ::pcphys::kernel_##side::Quaternion; \
    using Sym3 = ::pcphys::kernel_##side::Sym3;             \
    using Mat3 = ::pcphys::kernel_##side::Mat3;             \
    using uint = std::uint32_t;                             \
    static void run signature {                             \
      using namespace ::pcphys::kernel_##side;              \
      __VA_ARGS__                                           \
    }                                                       \
  };
#define PCPHYS_KERNEL_TEXT(Name, signature, declared, body, ...) \
  struct Name {                                                  \
    PCPHYS_KERNEL_SIDE(f32, signature, __VA_ARGS__)              \
    PCPHYS_KERNEL_SIDE(f64, signature, __VA_ARGS__)              \
    static ::pcphys::KernelText text() {                         \
      return {#Name,                                             \
              declared,                                          \
              body,                                              \
              __FILE__,                                          \
              __LINE__,                                          \
              &::pcphys::detail::RowLoop<&f32::run>::run,        \
              &::pcphys::detail::RowLoop<&f64::run>::run};       \
    }                                                            \
  };

/// Whether C++ rounds each product and sum on its own, as the shader does. Where the processor has fused multiply-adds
/// compilers use them unless told not to, which no macro of theirs tells: pcphys_add_kernel gives -ffp-contract=off,
/// and says so by PCPHYS_EXACT.
#if defined(__FAST_MATH__)
#define PCPHYS_KEEPS_BITS false
#elif !defined(PCPHYS_EXACT) && (defined(__FMA__) || defined(__FMA4__) || defined(__FP_FAST_FMA) || \
                                 defined(__FP_FAST_FMAF) || defined(__ARM_FEATURE_FMA))
#define PCPHYS_KEEPS_BITS false
#else
#define PCPHYS_KEEPS_BITS true
#endif
#define PCPHYS_CHECK_BITS                                                                                             \
  static_assert(                                                                                                      \
      PCPHYS_KEEPS_BITS,                                                                                              \
      "compiled like this, a kernel has other bits on the CPU than on the GPU: add its file by "                      \
      "pcphys_add_kernel(target file.cpp) in CMake, or compile it with -ffp-contract=off -DPCPHYS_EXACT and without " \
      "-ffast-math");

/// Written once for both sides, in the common subset.
#define PCPHYS_KERNEL(Name, signature, ...) \
  PCPHYS_CHECK_BITS PCPHYS_KERNEL_TEXT(Name, signature, #signature, #__VA_ARGS__, __VA_ARGS__)
/// C++ alone: anything that C++ can say. Rows may run on several threads at once (StepSettings::threads).
#define PCPHYS_CPU_KERNEL(Name, signature, ...) PCPHYS_KERNEL_TEXT(Name, signature, #signature, nullptr, __VA_ARGS__)

#define PCPHYS_PAIR_KERNEL_TEXT(Name, signature, declared, body, ...)                                                  \
  struct Name {                                                                                                        \
    PCPHYS_KERNEL_SIDE(f32, signature, __VA_ARGS__)                                                                    \
    PCPHYS_KERNEL_SIDE(f64, signature, __VA_ARGS__)                                                                    \
    static ::pcphys::KernelText text() {                                                                               \
      constexpr auto kinds = ::pcphys::detail::pair_arguments<::pcphys::detail::count_arguments(&f32::run)>(declared); \
      return {#Name,                                                                                                   \
              declared,                                                                                                \
              body,                                                                                                    \
              __FILE__,                                                                                                \
              __LINE__,                                                                                                \
              nullptr,                                                                                                 \
              nullptr,                                                                                                 \
              &::pcphys::detail::PairLoop<&f32::run, kinds, f32::Real>::run,                                           \
              &::pcphys::detail::PairLoop<&f64::run, kinds, f64::Real>::run};                                          \
    }                                                                                                                  \
  };
/// The same of a body and each other one.
#define PCPHYS_PAIR_KERNEL(Name, signature, ...) \
  PCPHYS_CHECK_BITS PCPHYS_PAIR_KERNEL_TEXT(Name, signature, #signature, #__VA_ARGS__, __VA_ARGS__)
#define PCPHYS_CPU_PAIR_KERNEL(Name, signature, ...) \
  PCPHYS_PAIR_KERNEL_TEXT(Name, signature, #signature, nullptr, __VA_ARGS__)

}  // namespace pcphys
