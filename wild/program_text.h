// Values of the public API as C++ text, for programs that are printed.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "pcphys/step.h"
#include "pcphys/types.h"
#include "pcphys/world.h"

namespace pcphys::wild::program {

/// The shortest decimal that reads back as the same number; infinity is the name of a constant.
std::string text(double value);
std::string text(bool value);
std::string text(std::int32_t value);
std::string text(std::uint32_t value);
std::string text(std::size_t value);
/// In braces, empty ones for what it is by default.
std::string text(Vec3 v);
std::string text(Quat q);
std::string text(const Pose& pose);
std::string text(Precision precision);
std::string text(Place place);
std::string text(Integrator integrator);
std::string text(NarrowPhase narrow);
std::string text(BodyKind kind);
std::string text(ShapeKind kind);
std::string text(Combine rule);
std::string text(AngleFreedom::Kind kind);

/// Members of a struct that are not what they are by default, as a designated initialiser.
class Members {
 public:
  explicit Members(std::string_view type = "") : type_(type) {}

  template <class T> Members& add(std::string_view name, const T& value, const T& usual) {
    return value == usual ? *this : put(name, text(value));
  }
  Members& put(std::string_view name, const std::string& value) {
    list_ += (list_.empty() ? "." : ", .") + std::string(name) + " = " + value;
    return *this;
  }
  /// Of a struct within: nothing where all of it is as by default.
  Members& put(std::string_view name, const Members& inner) {
    return inner.list_.empty() ? *this : put(name, inner.str());
  }
  bool empty() const { return list_.empty(); }
  std::string str() const { return type_ + "{" + list_ + "}"; }

 private:
  std::string type_, list_;
};

Members members(const Material& material);
Members members(const Filter& filter);
Members members(const AngleFreedom& freedom);
Members members(const Motor& motor);
Members members(const AngularSpring& spring);
Members members(const StepSettings& settings);

}  // namespace pcphys::wild::program
