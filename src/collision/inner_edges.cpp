// Inner edges: where surfaces that stand go on in each other, nothing is hit between them.
#include <algorithm>
#include <limits>

#include "collision/contact_meeting.h"

namespace pcphys {
namespace {

/// Normals that are turned against each other by less than this are one [rad].
constexpr double same_normal = 3e-4;

}  // namespace

/// Whether a point that x has lies in what y is with, where the body touches that with another normal.
template <class Scalar> bool Detector::lies_in(const Meeting<Scalar>& x, std::uint32_t point, const Meeting<Scalar>& y) const {
  if (y.row == x.row || !y.c.acts) return false;
  Scalar turned = 0;
  for (int k = 0; k < 3; k++) turned += (x.out[k] - y.out[k]) * (x.out[k] - y.out[k]);
  if (turned < Scalar(same_normal * same_normal)) return false;
  const double t = std::max(0.0, double(x.out[31]));
  ShapeView<Scalar> place = y.view(y.pb, y.c.shapes[1], y.row_b);
  Scalar apart[3] = {0, 0, 0};
  x.bodies.poses().shift(y.row_a, y.row_b, apart);
  ShapeView<Scalar> dot{ShapeKind::sphere, {Scalar(1e-6 * x.thick), 0, 0}, {}, {0, 0, 0, 1}};
  for (std::uint32_t k = 0; k < 3; k++) {
    place.p[k] += apart[k];
    dot.p[k] = x.out[4 + 4 * point + k] + Scalar(double(x.ta.v[k]) * t);
  }
  Manifold<Scalar> m;
  std::uint32_t hint = 0;
  narrow(dot, place, Scalar(seam_share * x.thick), hint, m);
  return m.count > 0;
}

/// Of the points at which a contact is closed, how far apart the shapes are where they overlap most.
template <class Scalar> Scalar Detector::depth(const Meeting<Scalar>& x) {
  Scalar least = std::numeric_limits<Scalar>::max();
  for (std::uint32_t point = 0; point < 4; point++)
    if (x.c.together >> point & 1) least = std::min(least, x.out[7 + 4 * point]);
  return least;
}

/// Whether y may take x's place there. Over a seam each of two lies in the other: the one that holds more stays.
template <class Scalar> bool Detector::covers(const Meeting<Scalar>& y, const Meeting<Scalar>& x, std::uint32_t point) const {
  if (!lies_in<Scalar>(x, point, y)) return false;
  const Scalar of_x = depth(x), of_y = depth(y);
  if (of_y < of_x || (of_y == of_x && y.row < x.row)) return true;
  for (std::uint32_t other = 0; other < 4; other++)
    if ((y.c.together >> other & 1) != 0 && !lies_in<Scalar>(y, other, x)) return true;
  return false;
}

/// Where all points at which a contact with what stands is closed lie in other things that stand, which the body touches with
/// other normals, the surface goes on, and there is nothing to hit. `among`: places of which some may go.
template <class Scalar> void Detector::drop_inner_edges(const Substep<Scalar>& look, std::span<const std::uint32_t> among) {
  const auto row_of = [&](std::uint32_t at) { return look.contacts[at]; };
  const auto body_of = [&](std::uint32_t at) { return standings_[row_of(at)].rows[0]; };
  const auto meeting = [&](std::uint32_t at) {
    return Meeting<Scalar>{*this, look.s, look.bodies, look.options, look.h, row_of(at)};
  };
  std::ranges::sort(on_standing_, {}, [&](std::uint32_t at) { return std::pair(body_of(at), row_of(at)); });
  inner_.clear();
  for (std::size_t begin = 0, end = 0; begin < on_standing_.size(); begin = end) {
    for (end = begin; end < on_standing_.size() && body_of(on_standing_[end]) == body_of(on_standing_[begin]);) end++;
    for (std::size_t i = begin; i < end && end - begin > 1; i++) {
      if (among.size() < on_standing_.size() && std::ranges::find(among, on_standing_[i]) == among.end()) continue;
      const Meeting<Scalar> x = meeting(on_standing_[i]);
      bool covered = x.c.together != 0;
      for (std::uint32_t point = 0; point < 4 && covered; point++) {
        if ((x.c.together >> point & 1) == 0) continue;
        covered = false;
        for (std::size_t j = begin; j < end && !covered; j++) covered = covers<Scalar>(meeting(on_standing_[j]), x, point);
      }
      if (covered) inner_.push_back(on_standing_[i]);
    }
  }
  for (const std::uint32_t at : inner_) {
    meeting(at).stand_aside();
    standings_[row_of(at)].touches = false;  // it is looked at again while it is near
    renewed_.push_back(at);
  }
}

template void Detector::drop_inner_edges(const Substep<float>&, std::span<const std::uint32_t>);
template void Detector::drop_inner_edges(const Substep<double>&, std::span<const std::uint32_t>);

}  // namespace pcphys
