// Typed generational ids. An id is an index, a generation and its world; the generation changes when the index is
// used again, so an id that outlived its object, or is of another world, is recognised and reported as stale, never
// followed. Index and generation are assigned by the sequence of create and destroy calls alone:
// the smallest free index first.
#pragma once
#include <compare>
#include <cstdint>

namespace pcphys {

template <class Tag> struct Id {
  std::uint32_t index = 0;
  std::uint32_t generation = 0;  // 0 is never assigned: a default-constructed id is no object
  std::uint32_t world = 0;       // another for each world of the process

  explicit constexpr operator bool() const { return generation != 0; }
  friend constexpr auto operator<=>(const Id&, const Id&) = default;
};

using BodyId = Id<struct BodyTag>;
using ShapeId = Id<struct ShapeTag>;
using JointId = Id<struct JointTag>;
using SpringId = Id<struct SpringTag>;

}  // namespace pcphys
