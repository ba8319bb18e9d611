// Kernels of the host's own as data: what Stepper::add_kernel takes. Written with pcphys/write_kernel.h.
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pcphys/plan.h"
#include "pcphys/property.h"

namespace pcphys {

/// The rows that a kernel's C++ side is to run over; its arguments in the order of the signature.
struct KernelRows {
  std::byte* const* columns;   // of each argument, where row 0 stands
  const std::size_t* strides;  // and bytes from row to row; 0 of a parameter
  const std::uint32_t* rows;   // null: begin to end themselves
  std::uint32_t begin, end;
  // in place of `rows`, of joints with their bodies:
  // three by three the rows of the joint, of its body a and of its body b
  const std::uint32_t* joined = nullptr;
  const std::uint8_t* of_three = nullptr;  // and of each argument which of them: 0, 1 or 2
};
using KernelLoop = void (*)(const KernelRows&);

/// The pairs that a pair kernel's C++ side is to run over; its arguments as in KernelRows.
struct KernelPairs {
  static constexpr std::uint32_t tile = 64, most_chunks = 32;

  std::byte* const* columns;
  const std::size_t* strides;
  std::byte* const* totals;     // of each sum, where that of the first of `selves` goes, one after the other
  bool apply;                   // not to sum, but to put totals into properties, once all of them are there
  const std::uint32_t* selves;  // null: begin to end themselves
  std::uint32_t begin, end;     // in `selves`
  const std::uint32_t* order;   // of all rows; null: 1 to count
  const std::uint32_t* places;  // of a row in it
  std::uint32_t count, chunk;   // rows in it; how many of them are summed in one go, a multiple of `tile`
  // within a cut-off: rows that may be near a row, near[first[row]] to near[first[row + 1]]; null: all are
  const std::uint32_t *first, *near;
  const std::byte* centres;  // positions
  std::size_t centre_stride;
  double cutoff_squared;
};
using PairsLoop = void (*)(const KernelPairs&);

/// A kernel as it was written. Without `body` it has no GLSL, without loops no C++: it then runs where it can.
struct KernelText {
  const char* name = "";
  const char* signature = "";
  const char* body = nullptr;
  const char* file = "";
  int line = 0;
  KernelLoop f32 = nullptr, f64 = nullptr;
  PairsLoop pairs32 = nullptr, pairs64 = nullptr;  // in their place, of a pair kernel
};

struct KernelParameter {
  std::string name;
  PropertyType type;
  PropertyNumbers value;
  template <PropertyValue T>
  KernelParameter(std::string n, const T& v) : name(std::move(n)), type(property_type<T>), value(v) {}
  KernelParameter(std::string n, double v) : name(std::move(n)), type(PropertyType::real), value(Real(v)) {}
};

/// When and over what a kernel runs.
struct KernelDef {
  KernelText text = {};
  /// Rows of this table: of bodies those that move, of joints and the host's own tables all. A kernel with PC_A or PC_B
  /// is over `joint_table`, and over those that join a body that moves.
  TableId over = body_table;
  /// Before or after that stage of each sub-step; with `once_a_step` of the first or the last sub-step.
  Stage stage = Stage::integrate;
  bool after = false;
  bool once_a_step = false;
  std::vector<KernelParameter> parameters = {};
  /// Of pairs of bodies: only those whose positions are no further apart [m]. Without one, all.
  std::optional<double> cutoff = {};
  /// Names of kernels of the same moment that run before this one. What follows by itself: of a property first the one
  /// that writes it anew, then those that change it, then those that read it;
  /// and else the order in which they were added.
  std::vector<std::string> follows = {};
};

}  // namespace pcphys
