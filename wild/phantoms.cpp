#include "wild/phantoms.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "wild/distance.h"
#include "wild/shapes.h"

namespace pcphys::wild {
namespace {

constexpr double smallest_gap = 1e-4;  // [m]
constexpr double share_of_size = 1e-3;
/// Impulses that change a velocity by less than this share of the speeds at hand are rounding.
constexpr double rounding = 1e-6;

Vec3 spin_of(const WorldState& s, std::uint32_t row, Quat q) {
  const Vec3 l = s.tables.get3(Buffer::motion, row, 4);
  if (!s.responds(row)) return l;  // a kinematic body keeps its angular velocity there
  const Vec3 inverse = s.tables.get3(Buffer::mass, row, 4), inner = rotate(conjugate(q), l);
  return rotate(q, {inner.x * inverse.x, inner.y * inverse.y, inner.z * inverse.z});
}

const ShapeDef& shape_of(const WorldState& s, std::uint32_t shape) { return s.shapes[shape].def; }

/// The gap that is no gap: by the smaller of the two.
double allowed(const ShapeDef& a, const ShapeDef& b) {
  const double of_a = a.kind == ShapeKind::plane ? 1e30 : 2 * outer_radius(a);
  const double of_b = b.kind == ShapeKind::plane ? 1e30 : 2 * outer_radius(b);
  return std::max(share_of_size * std::min(of_a, of_b), smallest_gap);
}

}  // namespace

void Phantoms::read(const WorldState& state, std::vector<Body>& bodies) const {
  bodies.resize(state.bodies.size());
  for (std::uint32_t row = 0; row < bodies.size(); row++) {
    Body& b = bodies[row];
    b.pose = state.pose(row);
    b.velocity = state.tables.get3(Buffer::motion, row, 0);
    b.angular_velocity = spin_of(state, row, b.pose.orientation);
    b.contacts = 0;
    b.pushed = 0;
  }
}

void Phantoms::begin(const WorldState& state) {
  read(state, before_);
  struck_.assign(state.contact_rows(), 0);
  widest_ = driven_work_ = impulses_ = 0;
  pushes_ = 0;
}

/// Along the normal, in this sub-step: of the rows, and what impacts have added.
double Phantoms::normal_impulse(const TracedContact& c) {
  double rows = 0, struck = 0;
  for (const double impulse : c.impulse) rows += impulse;
  for (const double impulse : c.struck) struck += std::max(impulse, 0.0);
  return rows + std::max(struck - std::exchange(struck_[c.contact], struck), 0.0);
}

/// The least distance of the two on their ways to and from their meeting, as a multiple of what is allowed; 0 where
/// they met.
double Phantoms::gap_of(const WorldState& state, double h, const TracedContact& c) const {
  const auto [shape_a, shape_b] = state.contacts.keys[c.contact];
  const std::uint32_t rows[2] = {state.body_ids.row(state.shapes[shape_a].body),
                                 state.body_ids.row(state.shapes[shape_b].body)};
  const ShapeDef *a = &shape_of(state, shape_a), *b = &shape_of(state, shape_b);
  const double near = allowed(*a, *b);
  const Body &a0 = before_[rows[0]], &b0 = before_[rows[1]], &a1 = now_[rows[0]], &b1 = now_[rows[1]];
  double least =
      std::min(distance(placed(*a, a1.pose), placed(*b, b1.pose)), distance(placed(*a, a0.pose), placed(*b, b0.pose)));
  if (least <= near) return 0;
  const auto on_its_way = [&](const ShapeDef* shape, const Body& body, std::uint32_t row) {
    Moving way{shape, body.pose, body.velocity, body.angular_velocity};
    if (!state.responds(row)) return way;
    way.velocity =
        way.velocity + h * (state.gravity + state.tables.get(Buffer::motion, row, 3) * state.given_force(row));
    way.angular_velocity = way.angular_velocity + h * state.spin_of(row, state.given_torque(row));
    return way;
  };
  const Moving to_a = on_its_way(a, a0, rows[0]), to_b = on_its_way(b, b0, rows[1]);
  least = std::min(least, least_distance(to_a, to_b, h, near));
  if (least <= near) return 0;
  const Moving from_a{a, a1.pose, -a1.velocity, -a1.angular_velocity},
      from_b{b, b1.pose, -b1.velocity, -b1.angular_velocity};
  least = std::min(least, least_distance(from_a, from_b, h, near));
  // Who is pushed several times in a sub-step goes ways that neither end of it tells.
  if (a1.contacts > 1 || b1.contacts > 1) least -= (a1.pushed + b1.pushed) * h;
  return least <= near ? 0 : least / near;
}

/// Along the normal at most what the driven side's points bring along; friction at most its share of that.
void Phantoms::add_work(const WorldState& state, const TracedContact& c, double normal) {
  const auto ends = state.contacts.ends[c.contact];
  const Vec3 arm = state.tables.get3(Buffer::contact, c.contact, 4);
  const double slipping = state.tables.get(Buffer::contact, c.contact, 28) * normal;
  const double friction = std::max(slipping, std::hypot(c.friction[0], c.friction[1]));
  impulses_ += normal + friction;
  for (const std::uint32_t row : ends) {
    const Body& b = now_[row];
    if (state.responds(row) || (b.velocity == Vec3{} && b.angular_velocity == Vec3{})) continue;
    const Vec3 at = now_[ends[0]].pose.position + arm;
    const double fastest = length(b.velocity) + length(b.angular_velocity) * length(at - b.pose.position);
    driven_work_ += (normal + friction) * fastest;
  }
}

void Phantoms::substep(const WorldState& state, double h, std::span<const TracedContact> contacts) {
  read(state, now_);
  const auto rows_of = [&](const TracedContact& c) { return state.contacts.ends[c.contact]; };
  normals_.clear();
  for (const TracedContact& c : contacts) {
    normals_.push_back(normal_impulse(c));
    if (normals_.back() <= 0) continue;
    for (const std::uint32_t row : rows_of(c)) {
      now_[row].contacts++;
      now_[row].pushed += normals_.back() * state.tables.get(Buffer::motion, row, 3);
    }
  }
  for (std::size_t i = 0; i < contacts.size(); i++) {
    const TracedContact& c = contacts[i];
    const double pushed = std::max(normals_[i], std::hypot(c.friction[0], c.friction[1]));
    if (pushed <= 0) continue;
    pushes_++;
    add_work(state, c, normals_[i]);
    double change = 0, speed = length(state.gravity) * h;
    for (const std::uint32_t row : rows_of(c)) {
      change = std::max(change, pushed * state.tables.get(Buffer::motion, row, 3));
      speed = std::max(speed, std::max(length(before_[row].velocity), length(now_[row].velocity)));
    }
    if (change > rounding * speed) widest_ = std::max(widest_, gap_of(state, h, c));
  }
  std::swap(before_, now_);
}

}  // namespace pcphys::wild
