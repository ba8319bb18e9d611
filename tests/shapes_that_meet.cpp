// When two shapes that move and turn come together (collision/meeting.h), against many looks on their way.
#include <doctest/doctest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "collision/meeting.h"
#include "narrow_shapes.h"
#include "scenes/random.h"

namespace {
using namespace narrow_test;
using pcphys::scenes::Random;

constexpr double h = 1, near_enough = 1e-6;
constexpr int samples = 300;

Vec3 direction(Random& random) {
  Vec3 v;
  do v = {random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
  while (length(v) < 0.1 || length(v) > 1);
  return (1 / length(v)) * v;
}

Shape some_shape(Random& random) {
  const Vec3 size{random.between(0.1, 0.6), random.between(0.1, 0.6), random.between(0.1, 0.6)};
  const int kind = int(random.between(0, 5));
  if (kind < 4) return shape(ShapeKind(kind), size);
  std::vector<Vec3> points;
  for (int i = 0; i < 12; i++) points.push_back(0.6 * direction(random));
  return hull_shape(points);
}

/// Half of them beside their body's centre.
Mover<double> mover(const Shape& s, double radius, Vec3 velocity, Vec3 spin) {
  Mover<double> m{&s, {}, 0, false, 0};
  const double w[] = {spin.x, spin.y, spin.z}, v[] = {velocity.x, velocity.y, velocity.z};
  std::copy_n(w, 3, m.twist.w);
  std::copy_n(v, 3, m.twist.v);
  m.twist.turn = length(spin);
  m.twist.speed = length(velocity);
  m.centred = centre(s) == Vec3{};
  m.lever = float(radius);
  m.spin = float(m.twist.turn) * m.lever;
  return m;
}

struct Flight {
  Shape shapes[2];
  Mover<double> a, b;
  double apart[3];

  explicit Flight(Random& random) {
    double radii[2];
    for (int i = 0; i < 2; i++) {
      shapes[i] = some_shape(random);
      const Vec3 off = random.between(0, 1) < 0.5 ? Vec3{} : 0.4 * direction(random);
      narrow_test::place(shapes[i], off);
      radii[i] = 1.1 + length(off);
    }
    const Vec3 from = random.between(1.5, 4) * direction(random);
    const Vec3 towards = -1 * from + random.between(0, 1) * direction(random);
    const double fast = random.between(0, 2);
    a = mover(shapes[0], radii[0], {}, random.between(0, fast) * direction(random));
    b = mover(shapes[1], radii[1], random.between(0.2, 2) * towards, random.between(0, fast) * direction(random));
    apart[0] = from.x;
    apart[1] = from.y;
    apart[2] = from.z;
  }

  /// Below zero where they overlap; a large number where they are far apart.
  double gap(double t) const {
    auto look = [](const Shape& x, const Shape& y, Manifold<double>& m) { m = find(x, y, 10); };
    Approach<double, decltype(look)> way{a, b, apart, look, {}, {}};
    Manifold<double> m;
    return way.look(t, m) ? way.gap(m) : 1e30;
  }
};

TEST_CASE("shapes that move and turn meet when they first touch") {
  Random random(7);
  int met = 0, missed = 0;
  double early = 0, overlap = 0;
  for (int i = 0; i < 2000; i++) {
    const Flight flight(random);
    if (flight.gap(0) < 0.01) continue;
    auto look = [](const Shape& x, const Shape& y, Manifold<double>& m) { m = find(x, y, 10); };
    Manifold<double> m;
    look(flight.shapes[0], turned(flight.shapes[1], {}, vec(flight.apart)), m);
    const std::optional<double> at = meet_within(flight.a, flight.b, flight.apart, near_enough, 0.0, h, look, m);
    met += at.has_value();
    if (at) early = std::max(early, flight.gap(*at));
    const double until = at.value_or(h);
    double deepest = 0;
    for (int k = 0; k < samples; k++) deepest = std::min(deepest, flight.gap(until * k / samples));
    if (at) overlap = std::min(overlap, deepest);
    missed += !at && deepest < 0;
  }
  MESSAGE(met << " met, " << missed << " were missed, seen " << early << " m too early, " << -overlap << " m too late");
  CHECK(met > 500);
  CHECK(missed == 0);
  CHECK(early <= near_enough);
  CHECK(overlap >= -1e-4);
}

}  // namespace
