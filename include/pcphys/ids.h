// Typed generational ids. An id is an index and a generation; the generation changes when the index is
// used again, so an id that outlived its object is recognised and reported as stale, never followed.
// Ids are assigned by the sequence of create and destroy calls alone: the smallest free index first.
#pragma once
#include <compare>
#include <cstdint>

namespace pcphys {

template <class Tag> struct Id {
  std::uint32_t index = 0;
  std::uint32_t generation = 0;  // 0 is never assigned: a default-constructed id is no object

  explicit constexpr operator bool() const { return generation != 0; }
  friend constexpr auto operator<=>(const Id&, const Id&) = default;
};

using BodyId = Id<struct BodyTag>;
using ShapeId = Id<struct ShapeTag>;
using JointId = Id<struct JointTag>;
using SpringId = Id<struct SpringTag>;

}  // namespace pcphys
