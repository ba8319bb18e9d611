// The parts of programs that run kernels of the host's own: where arguments stand, and their numbers one by one.
#pragma once
#include <functional>
#include <span>
#include <string>

#include "plan/own_kernels.h"

namespace pcphys {

class OwnText {
 public:
  explicit OwnText(const OwnKernel& kernel) : k_(kernel) {}

  /// Storage blocks in their order, from binding 0 on; those of `writes` are not readonly.
  std::string blocks(std::span<const Access> accesses) const;
  /// Uniforms of the parameters, and what the kernel's text writes as variables.
  std::string variables() const;
  /// The head of the function with the host's text: what it reads is const, what it writes stands outside
  /// and is precise.
  std::string function() const;
  /// A call of it; what it reads has the names that `load` gave it.
  std::string call() const;

  /// Declares what the text reads, of the arguments that `wanted` picks, and loads it from a row.
  std::string load(const std::function<bool(const OwnArgument&)>& wanted, const std::string& row) const;
  /// Component c of an argument in memory.
  std::string place(const OwnArgument& a, std::uint32_t c, const std::string& row) const;

  static std::string type(PropertyType type);
  /// Of one component.
  static std::string number_type(PropertyType type);
  /// Component c of a value of that type in the kernel's text: ".x".
  static std::string part(PropertyType type, std::uint32_t c);
  /// Statements for each component, `each` with its suffix.
  static std::string for_parts(PropertyType type,
                               const std::function<std::string(std::uint32_t, const std::string&)>& each);
  static std::string precise(const OwnArgument& a);

 private:
  std::string label(Buffer buffer) const;
  const OwnArgument& user_of(Buffer buffer) const;
  const OwnKernel& k_;
};

}  // namespace pcphys
