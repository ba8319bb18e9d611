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

}  // namespace

/// Whether y's surface goes on beyond x's normal at a point that x has: the point lies in what y is with, and that reaches further along x's
/// normal a little beside the point, on the side to which that normal leans.
template <class Scalar> bool Detector::covers(const Meeting<Scalar>& y, const Meeting<Scalar>& x, std::uint32_t point) const {
  if (y.row == x.row || !y.c.acts) return false;
  const Scalar *nx = x.out, *ny = y.out;  // into what stands
  const Scalar along = nx[0] * ny[0] + nx[1] * ny[1] + nx[2] * ny[2];
  Scalar lean[3], size = 0;
  for (int k = 0; k < 3; k++) {
    lean[k] = along * ny[k] - nx[k];
    size += lean[k] * lean[k];
  }
  size = std::sqrt(size);
  if (size < Scalar(same_normal)) return false;
  // what meets later in the sub-step has its points where they then are
  const Vec3 moved = origins_[x.row] - x.bodies.poses().position(x.row_a);
  const Scalar since[3] = {Scalar(moved.x), Scalar(moved.y), Scalar(moved.z)},
               open = x.out[31] > 0 ? Scalar(0) : x.out[7 + 4 * point];
  ShapeView<Scalar> place = y.view(y.pb, y.c.shapes[1], y.row_b);
  Scalar apart[3] = {0, 0, 0};
  x.bodies.poses().shift(y.row_a, y.row_b, apart);
  const Scalar* const p = x.out + 4 + 4 * point;
  ShapeView<Scalar> dot{ShapeKind::sphere, {Scalar(1e-6 * x.thick), 0, 0}, {}, {0, 0, 0, 1}};
  for (std::uint32_t k = 0; k < 3; k++) {
    place.p[k] += apart[k];
    dot.p[k] = p[k] + since[k] + nx[k] * open;
  }
  Manifold<Scalar> m;
  std::uint32_t hint = 0;
  narrow(dot, place, Scalar(seam_share * x.thick), hint, m);
  if (m.count == 0) return false;
  const Scalar beside = Scalar(beside_share * x.thick);
  ShapeView<Scalar> next = dot;
  for (std::uint32_t k = 0; k < 3; k++) next.p[k] += beside / size * lean[k];
  Manifold<Scalar> further;
  narrow(next, place, 2 * beside, hint, further);
  if (further.count == 0) return false;
  // nearest points of what y is with to the one point and to the other
  const auto gap = [&](const Manifold<Scalar>& at) { return std::max(at.points[0].separation + dot.size[0], Scalar(0)); };
  Scalar rise = 0;
  for (std::uint32_t k = 0; k < 3; k++)
    rise -= nx[k] * ((next.p[k] + further.normal[k] * gap(further)) - (dot.p[k] + m.normal[k] * gap(m)));
  return rise > Scalar(same_normal) * beside;
}

/// Where all points at which a contact with what stands is closed lie in other things that stand, whose surface goes on beyond its normal,
/// there is nothing to hit. `inner_`: places of those that may go, ascending.
template <class Scalar> void Detector::drop_inner_edges(const Substep<Scalar>& look) {
  if (inner_.empty()) return;
  const auto row_of = [&](std::uint32_t at) { return look.contacts[at]; };
  const auto body_of = [&](std::uint32_t at) { return standings_[row_of(at)].rows[0]; };
  const auto meeting = [&](std::uint32_t at) {
    return Meeting<Scalar>{*this, look.s, look.bodies, look.options, look.h, row_of(at)};
  };
  std::ranges::sort(on_standing_, {}, [&](std::uint32_t at) { return std::pair(body_of(at), row_of(at)); });
  const auto is_covered = [&](std::uint32_t at) {
    const auto beside = std::ranges::equal_range(on_standing_, body_of(at), {}, body_of);
    if (beside.size() < 2) return false;
    const Meeting<Scalar> x = meeting(at);
    for (std::uint32_t point = 0; point < 4; point++) {
      const auto covers_it = [&](std::uint32_t other) { return covers<Scalar>(meeting(other), x, point); };
      if ((x.c.together >> point & 1) != 0 && std::ranges::none_of(beside, covers_it)) return false;
    }
    return x.c.together != 0;
  };
  std::erase_if(inner_, [&](std::uint32_t at) { return !is_covered(at); });
  for (const std::uint32_t at : inner_) {
    meeting(at).stand_aside();
    gone_.push_back(row_of(at));
    standings_[row_of(at)].touches = false;  // it is looked at again while it is near
    renewed_.push_back(at);
  }
}

template void Detector::drop_inner_edges(const Substep<float>&);
template void Detector::drop_inner_edges(const Substep<double>&);

}  // namespace pcphys
