// Kernels of the host's own: their signatures read and resolved, and the order in which they run.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pcphys/kernel.h"
#include "pcphys/result.h"
#include "world/state.h"

namespace pcphys {

struct OwnArgument {
  enum class Kind : std::uint8_t { in, inout, out, parameter, self, other, a, b, sum, add, add_a, add_b, least, most };
  std::string name;      // in the kernel's text
  std::string property;  // that it names: without _other, _self, _a or _b
  Kind kind = Kind::in;
  PropertyType type = PropertyType::real;
  std::size_t at = 0;  // in the signature
  // of a property
  Table table{};
  Buffer buffer{};
  std::uint32_t offset = 0, row_bytes = 0;
  // of a parameter: where it stands in OwnKernel::parameters; one of the library's own is known by its name
  std::uint32_t place = 0;
  bool given = false;   // by the library: h, gravity
  bool single = false;  // of a table of one row, which is not the kernel's
  bool of_property() const { return kind != Kind::parameter; }
  bool summed() const { return kind >= Kind::sum; }
  bool adds() const { return kind == Kind::add || kind == Kind::add_a || kind == Kind::add_b; }
  /// Which of the rows of three it is of, of a joint with its bodies: the joint 0, a 1, b 2.
  std::uint8_t of_three() const {
    return kind == Kind::a || kind == Kind::add_a ? 1 : kind == Kind::b || kind == Kind::add_b ? 2 : 0;
  }
  bool writes() const { return kind == Kind::inout || kind == Kind::out || summed(); }
  /// Whatever it was before.
  bool anew() const { return kind == Kind::out || (summed() && !adds()); }
};

struct OwnKernel {
  static constexpr std::size_t most_arguments = 32;
  /// Of one row; of a row and each other one; of a joint with the two bodies that it joins; of all rows to one value.
  enum class Form : std::uint8_t { element, pair, joined, reduction };

  std::uint64_t serial = 0;  // another for each kernel of the process
  std::string name, signature, body, file;
  int line = 0;
  bool own_lines = false;   // the body has the lines of its file, from `line` on; else the preprocessor joined them
  std::size_t reached = 0;  // how far its signature was read and resolved: where what is refused stands
  Form form = Form::element;
  KernelLoop loop = nullptr;
  PairsLoop pairs = nullptr;
  bool in_cpp() const { return loop || pairs; }
  bool of_library() const { return name.starts_with(own_prefix); }
  std::optional<double> cutoff;  // of pairs
  Table table = Table::body;
  Stage stage = Stage::integrate;
  bool after = false, once_a_step = false;
  std::vector<std::string> follows;
  std::vector<OwnArgument> arguments;
  std::vector<Access> accesses;       // each buffer once; of bodies the list of those that move first
  std::vector<Access> first, second;  // of all forms but the first, which are two programs: what each of them binds
  std::size_t real_bytes = 4;         // of the world
  std::vector<std::byte> parameters;  // in the world's precision, each from a multiple of `parameter_bytes` on
  std::vector<std::byte> parameters_before;  // as the last step had them; empty: the host has changed none since
  static constexpr std::size_t parameter_bytes = 12 * 8;

  bool writes(Buffer buffer) const {
    for (const Access& a : accesses)
      if (a.buffer == buffer && a.write) return true;
    return false;
  }
};

/// How many of `count` others a pair kernel sums in one go: a function of the number alone, so that sums are the same
/// everywhere; the fewer there are, the more work groups share them.
std::uint32_t pair_chunk(std::uint32_t count);
/// Rows that a level of a reduction makes one of.
inline constexpr std::uint32_t reduction_block = 64;

/// Reads and checks a kernel for a world. Errors: bad_argument (the signature, or more than eight buffers),
/// unknown_name, wrong_type; they name the kernel's file and line, within the signature the line of the argument.
Result<std::shared_ptr<OwnKernel>> resolve(const WorldState& state, const KernelDef& def);

/// Whether the properties that it was resolved to are still there; stale_id, naming the one that is not.
Status check_properties(const WorldState& state, const OwnKernel& kernel);

/// Another value for a parameter. Errors: unknown_name, wrong_type, not_finite.
Status set(OwnKernel& kernel, const KernelParameter& parameter);

/// The kernels of a world in the order in which those of one moment run.
class OwnKernels {
 public:
  /// Errors: name_taken, and bad_argument where two write the same anew or the order goes in a circle;
  /// nothing is added then.
  Status add(std::shared_ptr<OwnKernel> kernel);
  Status remove(std::string_view name);
  OwnKernel* find(std::string_view name) const;
  void clear();
  void put_back(const OwnKernels& before);

  /// A plan keeps those that it runs.
  using Ordered = std::span<const std::shared_ptr<OwnKernel>>;
  Ordered ordered() const { return ordered_; }
  bool empty() const { return kernels_.empty(); }
  /// Whether bodies act on each other in some, whatever their islands.
  bool pairs_of_bodies() const;
  /// The largest cut-off; 0: none has any.
  double cutoff() const;
  /// Counts the changes.
  std::uint64_t version() const { return version_; }

 private:
  Status order(std::vector<std::shared_ptr<OwnKernel>>& out) const;

  std::vector<std::shared_ptr<OwnKernel>> kernels_;  // as they were added
  std::vector<std::shared_ptr<OwnKernel>> ordered_;
  std::uint64_t version_ = 0;
};

}  // namespace pcphys
