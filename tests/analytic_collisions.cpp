// Pins A16(i): the impulse stage on two spheres at the exact touching configuration gives Newton's restitution
// with Coulomb's friction, whatever masses, angles and spins; and A21(b): a box slides down an incline.
#include "support_physics.h"

using namespace physics;

namespace {

struct Row {
  SphereContact before;
  Vec3 v1, v2, w1, w2;  // expected
};

Vec3 vector_at(const Csv& csv, std::size_t row, const char* name) {
  const std::string n(name);
  return {csv.at(row, (n + "x").c_str()), csv.at(row, (n + "y").c_str()), csv.at(row, (n + "z").c_str())};
}

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
    row.v1 = vector_at(csv, i, "v1"), row.v2 = vector_at(csv, i, "v2");
    row.w1 = vector_at(csv, i, "w1"), row.w2 = vector_at(csv, i, "w2");
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

TEST_CASE("A16: the same collisions through a whole step, gap and all") {
  // The step sees a gap of a few last places of the positions; what it leaves of the closing speed, and how
  // far the bodies move within the step, bound the error from both sides: least at dt = 1e-8 s.
  for (const Row& row : collisions()) {
    const SphereContact& c = row.before;
    Run run({Precision::f64});
    StepSettings settings = run.stepper.settings();
    settings.restitution_threshold = 0;
    REQUIRE(run.stepper.configure(settings));
    BodyDef def;
    def.material = {c.friction, c.friction, c.restitution};
    def.shapes = {ShapeDef::sphere(c.radius1)};
    def.mass = c.mass1;
    def.pose.position = -(c.radius1 + c.radius2 + 1e-15) * c.normal;
    def.velocity = c.v1;
    def.angular_velocity = c.w1;
    const BodyId one = run.add(def);
    def.shapes = {ShapeDef::sphere(c.radius2)};
    def.mass = c.mass2;
    def.pose.position = {};
    def.velocity = c.v2;
    def.angular_velocity = c.w2;
    const BodyId two = run.add(def);
    run.step(1e-8);
    SphereContact after = c;
    after.v1 = *run.world.velocity(one), after.v2 = *run.world.velocity(two);
    after.w1 = *run.world.angular_velocity(one), after.w2 = *run.world.angular_velocity(two);
    CAPTURE(c.mass2);
    CAPTURE(c.restitution);
    CAPTURE(c.friction);
    CHECK(error_of(row, after) <= 2e-6);
  }
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
double worst_slide(const Mode& mode, std::uint32_t substeps, bool settled) {
  double worst = 0;
  for (const Slide& s : slides)
    for (double dt : {1.0 / 60, 1.0 / 240, 1.0 / 1200}) {
      const double error =
          std::fabs(slide(mode, s.friction, dt, substeps, settled) - 0.5 * s.acceleration) / (s.acceleration * dt);
      worst = std::max(worst, error);
      MESSAGE("A21b " << mode.name() << std::string(settled ? ", settled, " : ", just touching, ") << substeps
                      << " sub-steps, mu " << s.friction << ", dt " << dt << ": " << error << " of the must");
    }
  return worst;
}

}  // namespace

TEST_CASE("A21b: a settled box slides down an incline") {
  for (const Mode& mode : precisions())
    for (std::uint32_t substeps : {1u, 4u}) {
      CAPTURE(mode.name());
      CAPTURE(substeps);
      CHECK(worst_slide(mode, substeps, true) <= 1);
    }
}

// While the box sinks to the overlap that carries it, the soft rows let go of a few percent of the load: friction by
// what they leave would be 6.7 times off with one sub-step.
TEST_CASE("A21b: a box that starts just touching slides down an incline") {
  for (const Mode& mode : precisions())
    for (std::uint32_t substeps : {1u, 4u}) {
      CAPTURE(mode.name());
      CAPTURE(substeps);
      CHECK(worst_slide(mode, substeps, false) <= 1);
    }
}

TEST_CASE("A21b: on every backend and lane width") {
  for (const Mode& mode : everywhere()) {
    CAPTURE(mode.name());
    CHECK(std::fabs(slide(mode, 0.1, 1.0 / 60, 1, false, 0.5) - 0.125 * 4.055429) <= 4.055429 / 60 * 0.5);
  }
}
