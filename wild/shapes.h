// Random shapes and steps, which most families draw from.
#pragma once
#include "pcphys/types.h"
#include "wild/dice.h"

namespace pcphys::wild {

/// A shape that moves (no plane), within a sphere of `radius` [m], and not thinner than a twentieth of it.
ShapeDef random_shape(Dice& dice, double radius);
/// The same of this kind.
ShapeDef random_shape(Dice& dice, ShapeKind kind, double radius);
/// A hull of 4 to 24 random points within a sphere of `radius`.
Hull random_hull(Dice& dice, double radius);
/// The radius of the sphere about the shape's centre that holds it.
double outer_radius(const ShapeDef& shape);
/// The half extent of the shape, as it is turned, along a unit direction.
double extent_along(const ShapeDef& shape, Quat orientation, Vec3 direction);
/// Time steps of hosts: 1/30 to 1/240 s.
double random_dt(Dice& dice);
/// Friction 0 to 1, restitution 0 in half of the draws.
Material random_material(Dice& dice);

}  // namespace pcphys::wild
