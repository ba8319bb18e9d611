// Pins A16(i): the impulse stage on two spheres at the exact touching configuration gives Newton's restitution
// with Coulomb's friction, whatever masses, angles and spins; and A21(b): a box slides down an incline.
#include "support_cases.h"

using namespace physics;

namespace {

struct Row {
  SphereContact before;
  Vec3 v1, v2, w1, w2;  // expected
};

std::vector<Row> collisions() {
  const Csv csv = read_csv("A16_sphere_collisions.csv");
  std::vector<Row> rows;
  for (std::size_t i = 0; i < csv.rows.size(); i++) {
    Row& row = rows.emplace_back();
    SphereContact& c = row.before;
    const double beta = csv.at(i, "beta_deg") * std::acos(-1.0) / 180;
    c.mass2 = csv.at(i, "m2");
    c.normal = {std::cos(beta), -std::sin(beta), 0};
    c.v1 = {2, 0, 0};
    if (csv.at(i, "spin") != 0) c.w1 = {0, 0, 20}, c.w2 = {0, 15, 0};
    c.friction = csv.at(i, "mu");
    c.restitution = csv.at(i, "e");
    row.v1 = csv.vector(i, "v1"), row.v2 = csv.vector(i, "v2");
    row.w1 = csv.vector(i, "w1"), row.w2 = csv.vector(i, "w2");
  }
  return rows;
}

/// Largest error of a component, relative to the largest speed (or spin times radius) of the row.
double error_of(const Row& row, const SphereContact& after) {
  const double linear = std::max({2.0, length(row.v1), length(row.v2)});
  const double spin =
      std::max({linear / row.before.radius2, length(row.before.w1), length(row.before.w2), length(row.w1), length(row.w2)});
  return std::max({length(after.v1 - row.v1) / linear, length(after.v2 - row.v2) / linear, length(after.w1 - row.w1) / spin,
                   length(after.w2 - row.w2) / spin});
}

}  // namespace

TEST_CASE("A16(i): every oblique collision of two spheres, straight through the solver") {
  const std::vector<Row> rows = collisions();
  REQUIRE(rows.size() >= 180);
  for (const Mode& mode : everywhere()) {
    CAPTURE(mode.name());
    double worst = 0;
    for (std::size_t i = 0; i < rows.size(); i++) {
      if (mode.place == Place::gl && i % 12 != 4) continue;  // llvmpipe is slow; the bits are the CPU's
      SphereContact c = rows[i].before;
      resolve(c, mode);
      const double error = error_of(rows[i], c);
      worst = std::max(worst, error);
      CAPTURE(i);
      CHECK(error <= (mode.is_double() ? 1e-12 : 2e-6));
    }
    MESSAGE("A16(i) " << mode.name() << ": " << worst);
  }
}

// The step sees a gap of a few last places of the positions; what it leaves of the closing speed, and how far the
// bodies move within the step, bound the error from both sides: least at dt = 1e-8 s.
TEST_CASE("A16: the same collisions through a whole step, gap and all") { check_rows(rows_of("A16", {Precision::f64}, 1e-8)); }

TEST_CASE("A16: momentum through an impact in mid-step") {
  for (const Mode& mode : precisions()) check_rows(rows_of("A16", mode, {}, "m2 = 1 kg"), metric("momentum"));
}

// ---- A21(b) --------------------------------------------------------------------------------------------

namespace {

/// Displacement after 1 s from rest of a box on a plane tilted by 30 degrees: gravity is turned instead.
/// A box that settles first sinks by the overlap that its weight needs; else it starts just touching.
double slide(const Mode& mode, double friction, double dt, std::uint32_t substeps, bool settled, double seconds = 1) {
  const double tilt = std::acos(-1.0) / 6;
  const Vec3 weight{0, -gravity * std::cos(tilt), 0};
  Run run(mode, weight, substeps);
  BodyDef floor;
  floor.kind = BodyKind::fixed;
  floor.shapes = {ShapeDef::plane()};
  floor.material = {friction, friction, 0};
  run.add(floor);
  BodyDef box;
  box.shapes = {ShapeDef::box({0.2, 0.1, 0.2})};
  box.mass = 1;
  box.material = {friction, friction, 0};
  box.pose.position = {0, 0.1, 0};
  const BodyId id = run.add(box);
  if (settled) run.step(dt, 300);
  REQUIRE(run.world.set_gravity(weight + Vec3{gravity * std::sin(tilt), 0, 0}));
  const double from = run.position(id).x;
  run.step(dt, std::lround(seconds / dt));
  return run.position(id).x - from;
}

struct Slide {
  double friction, acceleration;
};
constexpr Slide slides[] = {{0.1, 4.055429}, {0.3, 2.356287}, {0.5, 0.657145}};

}  // namespace

namespace {

/// Largest error of all frictions and step lengths as a share of the must, a dt T.
double worst_slide(const Mode& mode, std::uint32_t substeps) {
  double worst = 0;
  for (const Slide& s : slides)
    for (double dt : {1.0 / 60, 1.0 / 240, 1.0 / 1200}) {
      const double error = std::fabs(slide(mode, s.friction, dt, substeps, true) - 0.5 * s.acceleration) / (s.acceleration * dt);
      worst = std::max(worst, error);
      MESSAGE("A21b " << mode.name() << ", settled, " << substeps << " sub-steps, mu " << s.friction << ", dt " << dt << ": "
                      << error << " of the must");
    }
  return worst;
}

}  // namespace

TEST_CASE("A21b: a settled box slides down an incline") {
  for (const Mode& mode : precisions())
    for (std::uint32_t substeps : {1u, 4u}) {
      CAPTURE(mode.name());
      CAPTURE(substeps);
      CHECK(worst_slide(mode, substeps) <= 1);
    }
}

// While the box sinks to the overlap that carries it, the soft rows let go of a few percent of the load: friction by
// what they leave would be 6.7 times off with one sub-step.
TEST_CASE("A21b: a box that starts just touching slides down an incline") {
  for (const Mode& mode : precisions()) check_rows(rows_of("A21", mode, {}, "b, "));
}

TEST_CASE("A21b: on every backend and lane width") {
  for (const Mode& mode : everywhere()) {
    CAPTURE(mode.name());
    CHECK(std::fabs(slide(mode, 0.1, 1.0 / 60, 1, false, 0.5) - 0.125 * 4.055429) <= 4.055429 / 60 * 0.5);
  }
}
