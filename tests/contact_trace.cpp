// Pins: what a trace tells of contacts is what they did. A ball's momentum changes by gravity and by the traced
// impulses alone, in every precision and number of lanes, with rows and with impacts; friction of what slides is its
// share of the load; each sub-step is told once, whatever the octaves; and where a stage stands on a device nothing is
// told, and nothing breaks.
#include "step/contact_trace.h"

#include <cmath>
#include <vector>

#include "pcphys/device.h"
#include "support_physics.h"

using namespace physics;

namespace {

/// Sums up what was told of a step.
class Sum final : public ContactTrace {
 public:
  void begin(const WorldState& state) override {
    struck_.assign(state.contact_rows(), 0);
    pushed = {};
    dragged = load = 0;
    substeps = 0;
  }
  void substep(const WorldState& state, double, std::span<const TracedContact> contacts) override {
    substeps++;
    for (const TracedContact& c : contacts) {
      double rows = 0, struck = 0;
      for (int i = 0; i < 4; i++) {
        rows += c.impulse[std::size_t(i)];
        struck += std::fmax(c.struck[std::size_t(i)], 0);
      }
      const double now = rows + struck - struck_[c.contact];
      struck_[c.contact] = struck;
      const Vec3 normal = state.tables.get3(Buffer::contact, c.contact, 0);
      pushed = pushed - normal * now;  // on the first body
      dragged += std::hypot(c.friction[0], c.friction[1]);
      load += rows;
    }
  }

  Vec3 pushed;
  double dragged = 0, load = 0;  // of rows [N s]
  int substeps = 0;

 private:
  std::vector<double> struck_;
};

BodyDef plane(const Material& material) {
  BodyDef def;
  def.kind = BodyKind::fixed;
  def.shapes = {ShapeDef::plane()};
  def.material = material;
  return def;
}

struct Lanes {
  Precision precision;
  std::uint32_t lanes;
};
constexpr Lanes all_lanes[] = {
    {Precision::f32, 1}, {Precision::f32, 4}, {Precision::f32, 8}, {Precision::f64, 1}, {Precision::f64, 4}};

}  // namespace

TEST_CASE("contact trace: momentum is gravity's and what was told") {
  for (const Lanes& with : all_lanes)
    for (const double restitution : {0.0, 0.8})
      for (const double friction : {0.0, 0.5}) {
        World world({with.precision, {0, -10, 0}});
        Material material;
        material.static_friction = material.kinetic_friction = friction;
        material.restitution = restitution;
        REQUIRE(world.create_body(plane(material)));
        BodyDef ball;
        ball.shapes = {ShapeDef::sphere(0.5)};
        ball.mass = 2;
        ball.material = material;
        ball.pose.position = {0, 0.9, 0};
        REQUIRE(world.create_body(ball));
        Stepper stepper(StepSettings{.lanes = with.lanes});
        Sum sum;
        stepper.set_trace(&sum);
        const double dt = 1.0 / 60, bound = with.precision == Precision::f64 ? 1e-12 : 1e-5;
        REQUIRE(stepper.step(world, dt));  // its first sub-step has half of gravity
        bool touched = false;
        for (int i = 0; i < 60; i++) {
          const Vec3 before = world.momentum();
          REQUIRE(stepper.step(world, dt));
          const Vec3 change = world.momentum() - before;
          // A bounce at the end of the step is not told; balls alone have none.
          CHECK(std::fabs(change.y - (sum.pushed.y - 2 * 10 * dt)) < bound);
          if (sum.pushed.y > 0) CHECK(sum.substeps == 4);  // in a flight there are none to tell of
          touched = touched || sum.pushed.y > 0;
        }
        CHECK(touched);
      }
}

TEST_CASE("contact trace: friction of what slides is its share of the load") {
  World world({Precision::f64, {0, -10, 0}});
  Material material;
  material.static_friction = material.kinetic_friction = 0.3;
  REQUIRE(world.create_body(plane(material)));
  BodyDef box;
  box.shapes = {ShapeDef::box({0.5, 0.1, 0.5})};
  box.material = material;
  box.pose.position = {0, 0.1, 0};
  box.velocity = {5, 0, 0};
  REQUIRE(world.create_body(box));
  Stepper stepper;
  Sum sum;
  stepper.set_trace(&sum);
  for (int i = 0; i < 20; i++) REQUIRE(stepper.step(world, 1.0 / 60));
  CHECK(sum.load > 0);
  CHECK(sum.dragged == doctest::Approx(0.3 * sum.load).epsilon(1e-9));
}

TEST_CASE("contact trace: islands of other octaves are told each of their sub-steps once") {
  World world({Precision::f32, {0, -10, 0}});
  REQUIRE(world.create_body(plane({})));
  BodyDef box;
  for (const double mass : {1.0, 1000.0}) {  // the heavy one on the light one asks for more sub-steps
    box.shapes = {ShapeDef::box({0.5, 0.5, 0.5})};
    box.mass = mass;
    box.pose.position.y = mass > 1 ? 1.5 : 0.5;
    REQUIRE(world.create_body(box));
  }
  box.pose.position = {20, 0.5, 0};
  REQUIRE(world.create_body(box));
  Stepper stepper;
  Sum sum;
  stepper.set_trace(&sum);
  int refined = 0;
  for (int i = 0; i < 10; i++) {
    const StepReport& report = stepper.step(world, 1.0 / 60);
    REQUIRE(report);
    if (report.substeps == 4) continue;
    refined++;
    CHECK(sum.substeps == 4 + int(report.substeps));
  }
  CHECK(refined > 0);
}

TEST_CASE("contact trace: on a device nothing is told, and taken back nobody is") {
  if (!probe_gl(-1).usable) return;
  World world;
  REQUIRE(world.create_body(plane({})));
  BodyDef ball;
  ball.shapes = {ShapeDef::sphere(0.5)};
  ball.pose.position = {0, 0.5, 0};
  REQUIRE(world.create_body(ball));
  StepSettings settings;
  settings.set_all(Place::gl);
  Stepper stepper(settings);
  Sum sum;
  stepper.set_trace(&sum);
  REQUIRE(stepper.step(world, 1.0 / 60));
  CHECK(sum.substeps == 0);
  settings.set_all(Place::cpu);
  REQUIRE(stepper.configure(settings));
  REQUIRE(stepper.step(world, 1.0 / 60));
  CHECK(sum.substeps == 4);
  stepper.set_trace(nullptr);
  REQUIRE(stepper.step(world, 1.0 / 60));
  CHECK(sum.substeps == 4);
}
