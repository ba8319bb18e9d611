// Properties: what a table holds of each of its objects. Those that the library works with stand in docs/properties.md;
// a host adds its own (World::add_property). Views show the world's own memory, strided, never copied.
#pragma once
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <type_traits>

#include "pcphys/ids.h"
#include "pcphys/math.h"
#include "pcphys/types.h"

namespace pcphys {

/// What a property holds of each object. `real`: float or double, as the world was made;
/// vectors and matrices are of such reals.
enum class PropertyType : std::uint8_t { real, vec3, quat, sym3, vec4, mat3, float32, float64, int32, uint32 };
std::string_view name(PropertyType type);
/// Numbers in a value.
std::uint32_t components(PropertyType type);

/// input: the host writes it; state: what snapshots and the hash hold; derived: follows from others; scratch: means
/// nothing between steps; host: what a host hangs on its objects.
/// Snapshots hold that, and the hash since a kernel has named it.
enum class Role : std::uint8_t { input, state, derived, scratch, host };
std::string_view name(Role role);

/// A number in the world's precision.
struct Real {
  double value = 0;
  constexpr Real() = default;
  constexpr Real(double v) : value(v) {}
  constexpr operator double() const { return value; }
};

/// The type of a property whose values C++ holds as T.
template <class T> inline constexpr bool is_property_value = false;
template <class T> inline constexpr PropertyType property_type = PropertyType::real;
#define PCPHYS_PROPERTY_VALUE(T, type)                           \
  template <> inline constexpr bool is_property_value<T> = true; \
  template <> inline constexpr PropertyType property_type<T> = PropertyType::type;
PCPHYS_PROPERTY_VALUE(Real, real)
PCPHYS_PROPERTY_VALUE(Vec3, vec3)
PCPHYS_PROPERTY_VALUE(Quat, quat)
PCPHYS_PROPERTY_VALUE(SymMat3, sym3)
PCPHYS_PROPERTY_VALUE(Vec4, vec4)
PCPHYS_PROPERTY_VALUE(Mat3, mat3)
PCPHYS_PROPERTY_VALUE(float, float32)
PCPHYS_PROPERTY_VALUE(double, float64)
PCPHYS_PROPERTY_VALUE(std::int32_t, int32)
PCPHYS_PROPERTY_VALUE(std::uint32_t, uint32)
#undef PCPHYS_PROPERTY_VALUE
template <class T>
concept PropertyValue = is_property_value<T>;

/// Names a property of a world whose values are of type T.
template <PropertyValue T> using Property = Id<T>;

/// Names a table: of bodies, of joints, whichever world's, or one of the host's own (World::add_table).
using TableId = Id<struct TableTag>;
inline constexpr TableId body_table{0, 1}, joint_table{1, 1};

/// An object, or the row of a table of the host's own, whose value is meant.
struct RowOf {
  enum class Kind : std::uint8_t { body, joint, row };
  Kind kind;
  Id<struct AnyTag> id;  // of a row: its number in place of an index
  RowOf(BodyId of) : kind(Kind::body), id{of.index, of.generation, of.world} {}
  RowOf(JointId of) : kind(Kind::joint), id{of.index, of.generation, of.world} {}
  RowOf(SpringId of) : kind(Kind::joint), id{of.index, of.generation, of.world} {}
  explicit RowOf(std::uint32_t row) : kind(Kind::row), id{row, 0, 0} {}
};

/// A value as its numbers, in the order of its members.
struct PropertyNumbers {
  double x[9] = {};
  PropertyNumbers() = default;
  template <PropertyValue T> explicit PropertyNumbers(const T& value) {
    if constexpr (std::is_arithmetic_v<T>)
      x[0] = double(value);
    else
      std::memcpy(x, &value, sizeof value);
  }
  template <PropertyValue T> T as() const {
    T value{};
    if constexpr (std::is_arithmetic_v<T>)
      value = T(x[0]);
    else
      std::memcpy(&value, x, sizeof value);
    return value;
  }
};

/// What a world says of a property.
struct PropertyInfo {
  std::string_view name, unit, table;
  PropertyType type = PropertyType::real;
  Role role = Role::state;
  bool own = false;  // the host's: added by World::add_property
};

/// `count` rows of `components` numbers each; row i starts `stride` bytes after row i - 1.
struct PropertyView {
  const std::byte* data = nullptr;
  std::size_t count = 0, stride = 0;
  std::uint32_t components = 0;
  Precision precision = Precision::f32;  // of a real
  PropertyType type = PropertyType::real;

  /// Component c of row i as a double, whatever it is stored as.
  double at(std::size_t i, std::uint32_t c = 0) const {
    assert(i < count && c < components);
    const std::byte* row = data + i * stride;
    if (type == PropertyType::int32) return reinterpret_cast<const std::int32_t*>(row)[c];
    if (type == PropertyType::uint32) return reinterpret_cast<const std::uint32_t*>(row)[c];
    return precision == Precision::f32 ? double(reinterpret_cast<const float*>(row)[c])
                                       : reinterpret_cast<const double*>(row)[c];
  }
};

}  // namespace pcphys
