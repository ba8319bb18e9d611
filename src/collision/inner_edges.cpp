// Inner edges: where surfaces that stand go on in each other, nothing is hit between them.
#include <algorithm>
#include <limits>

#include "collision/contact_meeting.h"

namespace pcphys {
namespace {

/// Normals that are turned against each other by less than this are one [rad].
constexpr double same_normal = 3e-4;
/// How far beside a point it counts how the surface goes on, as a share of the body's thickness.
constexpr double beside_share = 0.02;

/// Where a shape is nearest to a point; false where it is further away than `most`.
template <class Scalar> bool nearest(const ShapeView<Scalar>& shape, const Scalar* point, Scalar most, Scalar* found) {
  const ShapeView<Scalar> dot{
      ShapeKind::sphere, {most * Scalar(1e-4), 0, 0}, {point[0], point[1], point[2]}, {0, 0, 0, 1}};
  Manifold<Scalar> m;
  std::uint32_t hint = 0;
  narrow(dot, shape, most, hint, m);
  if (m.count == 0) return false;
  const Scalar gap = std::max(m.points[0].separation + dot.size[0], Scalar(0));
  for (int k = 0; k < 3; k++) found[k] = point[k] + m.normal[k] * gap;
  return true;
}

/// Whether a shape that holds `point` to within `seam` reaches further against `normal`, which points into it, `beside`
/// the point: on the side to which the normal leans from `other` [m].
template <class Scalar>
bool reaches_beyond(const ShapeView<Scalar>& shape, const Scalar* point, const Scalar* normal, const Scalar* other,
                    Scalar seam, Scalar beside) {
  const Scalar along = normal[0] * other[0] + normal[1] * other[1] + normal[2] * other[2];
  Scalar lean[3], size = 0;
  for (int k = 0; k < 3; k++) {
    lean[k] = along * other[k] - normal[k];
    size += lean[k] * lean[k];
  }
  size = std::sqrt(size);
  if (size < Scalar(same_normal)) return false;
  Scalar here[3], next[3], there[3];
  for (int k = 0; k < 3; k++) next[k] = point[k] + beside / size * lean[k];
  if (!nearest(shape, point, seam, here) || !nearest(shape, next, 2 * beside, there)) return false;
  Scalar rise = 0;
  for (int k = 0; k < 3; k++) rise -= normal[k] * (there[k] - here[k]);
  return rise > beside / 2 * size;
}

}  // namespace

/// A point of a contact on what stands, seen from the body's centre as it is now. What meets later in the sub-step has
/// its points where they then are.
template <class Scalar> void Detector::point_of(const Meeting<Scalar>& x, std::uint32_t point, Scalar* at) const {
  const Vec3 moved = origin(x.row) - x.bodies.poses().position(x.row_a);
  const Scalar* const p = x.out + 4 + 4 * point;
  const Scalar open = x.out[place::impact_time] > 0 ? Scalar(0) : p[3],
               since[3] = {Scalar(moved.x), Scalar(moved.y), Scalar(moved.z)};
  for (int k = 0; k < 3; k++) at[k] = p[k] + since[k] + x.out[k] * open;
}

/// Whether y's surface goes on beyond x's normal at a point that x has, and x's does not beyond that of y: the two are
/// in one surface. (Where each goes on beyond the other's they meet in a hollow, and the body touches both.)
template <class Scalar>
bool Detector::covers(const Meeting<Scalar>& y, const Meeting<Scalar>& x, std::uint32_t point) const {
  if (y.row == x.row || !y.c.acts) return false;
  Scalar at[3], below = 0;
  point_of(x, point, at);
  for (std::uint32_t i = 0; i < std::uint32_t(y.out[3]); i++) {
    Scalar on[3];
    point_of(y, i, on);
    below = std::max(below, y.out[0] * (at[0] - on[0]) + y.out[1] * (at[1] - on[1]) + y.out[2] * (at[2] - on[2]));
  }
  const auto place = [&](const Meeting<Scalar>& of) {
    ShapeView<Scalar> shape = of.view(of.pb, of.c.shapes[1], of.row_b);
    Scalar apart[3] = {0, 0, 0};
    x.bodies.poses().shift(of.row_a, of.row_b, apart);
    for (int k = 0; k < 3; k++) shape.p[k] += apart[k];
    return shape;
  };
  const Scalar seam = Scalar(seam_share * x.thick), beside = Scalar(beside_share * x.thick);
  // (what has sunk into y has its points below the brim of both)
  return reaches_beyond(place(y), at, x.out, y.out, seam, beside) &&
         !reaches_beyond(place(x), at, y.out, x.out, seam, beside + 4 * below);
}

/// Where all points at which a contact with what stands is closed lie in other things that stand, whose surface goes on
/// beyond its normal, there is nothing to hit. `inner_`: places of those that may go, ascending.
template <class Scalar> void Detector::drop_inner_edges(const Substep<Scalar>& look) {
  if (inner_.empty()) return;
  const auto row_of = [&](std::uint32_t at) { return look.contacts[at]; };
  const auto body_of = [&](std::uint32_t at) { return standings_[row_of(at)].rows[0]; };
  const auto meeting_at = [&](std::uint32_t at) { return meeting(look, row_of(at)); };
  const auto is_covered = [&](std::uint32_t at) {
    const auto first = std::ranges::lower_bound(beside_, body_of(at), {}, body_of);
    const auto last = std::ranges::upper_bound(beside_, body_of(at), {}, body_of);
    const Meeting<Scalar> x = meeting_at(at);
    for (std::uint32_t point = 0; point < 4; point++) {
      const auto covers_it = [&](std::uint32_t other) { return covers<Scalar>(meeting_at(other), x, point); };
      if ((x.c.together >> point & 1) != 0 && std::none_of(first, last, covers_it)) return false;
    }
    return x.c.together != 0;
  };
  touching_.assign(levers_.size(), 0);
  for (const std::uint32_t at : on_standing_) touching_[body_of(at)]++;
  const auto alone = [&](std::uint32_t at) { return touching_[body_of(at)] < 2; };
  std::erase_if(inner_, alone);
  if (inner_.empty()) return;
  beside_ = on_standing_;
  std::erase_if(beside_, alone);
  std::ranges::sort(beside_, {}, [&](std::uint32_t at) { return std::pair(body_of(at), row_of(at)); });
  std::erase_if(inner_, [&](std::uint32_t at) { return !is_covered(at); });
  for (const std::uint32_t at : inner_) {
    meeting_at(at).stand_aside();
    gone_.push_back(row_of(at));
    standings_[row_of(at)].touches = false;  // it is looked at again while it is near
    renewed_.push_back(at);
  }
}

template void Detector::drop_inner_edges(const Substep<float>&);
template void Detector::drop_inner_edges(const Substep<double>&);

}  // namespace pcphys
