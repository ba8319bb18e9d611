// Pins that a body on a pivot has nothing to solve for where no limit, motor or contact acts, what its joint is then
// said to hold, and that hinges and pins side by side give the same bits in every lane width and on GL
// (kernels/pivot_turn.inl).
#include <algorithm>
#include <cmath>
#include <set>

#include "plan/plan.h"
#include "support_physics.h"

using namespace physics;

namespace {

/// A rod of 2 kg, 1 m long, at rest; its end at `x`. A pin, or a hinge about z.
BodyId hang(Run& run, double x, double lean, bool hinge, AngleFreedom freedom = AngleFreedom::hinge()) {
  BodyDef rod;
  rod.shapes = {ShapeDef::capsule(0.05, 0.45)};
  rod.shapes[0].filter.mask = 0;
  rod.mass = 2;
  rod.pose.orientation = exponential({0, 0, lean});
  rod.pose.position = {x + 0.5 * std::sin(lean), -0.5 * std::cos(lean), 0};
  JointDef joint;
  joint.a = run.world.ground();
  joint.b = run.add(rod);
  const Quat to_z = exponential({0, -std::acos(0.0), 0});  // turns the frames' x axis to z
  joint.frame_a = {{x, 0, 0}, to_z};
  joint.frame_b = {{0, 0.5, 0}, to_z};
  if (hinge) joint.freedom = freedom;
  REQUIRE(run.world.create_joint(joint));
  return joint.b;
}

std::set<std::string> left_out(const Run& run) {
  std::set<std::string> what;
  for (const LeftOut& l : run.stepper.plan().left_out) what.insert(l.what);
  return what;
}

const Vec3 down{0, -gravity, 0};

}  // namespace

TEST_CASE("pivots: where nothing but forces acts on them, no tree is solved") {
  for (bool hinge : {false, true}) {
    Run run(Mode{}, down);
    hang(run, 0, 0.5, hinge);
    run.step(0.01);
    CHECK(left_out(run).contains("tree solve"));
  }
  SUBCASE("a limit is solved") {
    Run run(Mode{}, down);
    hang(run, 0, 0.5, true, AngleFreedom::hinge(-1, 1));
    run.step(0.01);
    CHECK_FALSE(left_out(run).contains("tree solve"));
  }
  SUBCASE("so is a chain beside it") {
    Run run(Mode{}, down);
    JointDef link;
    link.a = hang(run, 0, 0.5, false);
    link.b = run.add(free_body(1, {0.1, 0.1, 0.1}));
    REQUIRE(run.world.create_joint(link));
    hang(run, 3, 0.5, false);
    run.step(0.01);
    CHECK_FALSE(left_out(run).contains("tree solve"));
  }
}

TEST_CASE("pivots: a contact brings the tree solve back, and all of it") {
  PlanSignature s;
  s.bodies = s.trees = s.pivots = s.pivots_bare = true;
  const auto solves = [&s](Kernel kernel) {
    const StepPlan plan = make_plan(s);
    return std::ranges::count_if(plan.entries, [kernel](const PlanEntry& e) { return e.kernel == kernel; });
  };
  for (Kernel kernel : {Kernel::tree_solve, Kernel::tree_again, Kernel::tree_relax, Kernel::inertia}) {
    s.tree_contacts = false;
    CHECK(solves(kernel) == 0);
    s.tree_contacts = true;
    CHECK(solves(kernel) == s.substeps);
  }
  s.tree_contacts = false;
  CHECK(solves(Kernel::remember) == s.substeps);
  s.pivots = false;
  CHECK(solves(Kernel::remember) == 1);
}

TEST_CASE("pivots: the pin holds what hangs on it, and a hinge the moment across its axis") {
  for (const Mode& mode : precisions()) {
    Run run(mode, {0, -gravity, 3});
    hang(run, 0, 0, true);
    run.step(0.01, 5);
    const auto impulse = [&run](const char* name) {
      const PropertyView view = *run.world.view(name);
      return Vec3{view.at(1, 0), view.at(1, 1), view.at(1, 2)};
    };
    const double h = 0.01, m = 2;
    CHECK(length(impulse("pin_impulse") - m * h * Vec3{0, gravity, -3}) <= 1e-5);
    // about x, which is where the weight along z turns it: m a_z times half a length
    CHECK(length(impulse("angle_impulse")) == doctest::Approx(m * 3 * 0.5 * h).epsilon(1e-4));
  }
}

// Between the stop and what follows no step is to be seen: the error is that of the swing, of fourth order.
TEST_CASE("pivots: a hinge's limit stops, or throws back, at the instant at which it is met") {
  for (const double e : {0.0, 0.5, 1.0}) {
    AngleFreedom freedom = AngleFreedom::hinge(-0.5, 2);
    freedom.restitution = e;
    const auto after = [&](Precision precision, double dt) {
      Run run({precision}, down);
      const BodyId rod = hang(run, 0, 1, true, freedom);
      double least = 1, pressed = 0;
      for (long i = 0, steps = std::lround(1.2 / dt); i < steps; i++) {
        run.step(dt);
        const Vec3 p = run.position(rod);
        least = std::min(least, std::atan2(p.x, -p.y));
        pressed += std::fabs(run.world.view("angle_impulse")->at(1, 0));
      }
      CHECK(least >= -0.5 - (precision == Precision::f64 ? 1e-14 : 1e-6));
      // the limit took the momentum about the pin, and gave e of it back
      const double about_pin = run.world.mass_properties(rod)->moments.x + 2 * 0.25;
      const double met = std::sqrt(2 * about_pin * 2 * gravity * 0.5 * (std::cos(0.5) - std::cos(1.0)));
      CHECK(pressed == doctest::Approx((1 + e) * met).epsilon(1e-4));
      return run.position(rod);
    };
    CAPTURE(e);
    const Vec3 fine = after(Precision::f64, 1.0 / 3840);
    CHECK(length(after(Precision::f64, 1.0 / 60) - fine) <= 1e-8);
    CHECK(length(after(Precision::f64, 1.0 / 240) - fine) <= 1e-10);
    CHECK(length(after(Precision::f32, 1.0 / 60) - fine) <= 1e-5);
  }
}

TEST_CASE("pivots: a hinge at its limit is a wall for what presses it there") {
  // From nine places, since the limit answers a blow in the sub-step after it: by then the ball is in by the way of up
  // to one, which is pushed out again.
  constexpr double speed = 2, late = speed / 60 / 4;  // [m/s], [m]
  for (const Mode& mode : precisions())
    for (int place = 0; place < 9; place++) {
      Run run(mode, {}, 4);
      BodyDef rod, ball;
      rod.shapes = {ShapeDef::capsule(0.05, 0.45)};
      rod.mass = 2;
      rod.pose.position = {0, -0.5, 0};
      JointDef joint;
      joint.a = run.world.ground();
      joint.b = run.add(rod);
      const Quat to_z = exponential({0, -std::acos(0.0), 0});
      joint.frame_a = {{}, to_z};
      joint.frame_b = {{0, 0.5, 0}, to_z};
      joint.freedom = AngleFreedom::hinge(0, 2);
      REQUIRE(run.world.create_joint(joint));
      ball.shapes = {ShapeDef::sphere(0.2)};
      ball.mass = 100;
      ball.pose.position = {1 + place * 1e-3, -0.6, 0};
      ball.velocity = {-speed, 0, 0};
      const BodyId heavy = run.add(ball);
      double least = 1, angle = 0;
      for (int i = 0; i < 120; i++) {
        run.step(1.0 / 60);
        least = std::min(least, run.position(heavy).x);
        angle = std::min(angle, run.position(joint.b).x);
      }
      CAPTURE(mode.name());
      CAPTURE(place);
      CHECK(least >= 0.25 - late);
      CHECK(angle >= -late);
      CHECK(std::fabs(run.world.velocity(heavy)->x) <= 0.25 * speed);  // it stopped there
    }
}

TEST_CASE("pivots: hinges and pins side by side have the same bits everywhere") {
  for (Precision precision : {Precision::f32, Precision::f64}) {
    std::uint64_t wanted = 0;
    for (const Mode& mode : everywhere()) {
      if (mode.precision != precision) continue;
      Run run(mode, down);
      for (int i = 0; i < 11; ++i) hang(run, 2.0 * i, 0.3 * i, i % 3 != 0);
      run.step(1.0 / 60, 60);
      if (wanted == 0) wanted = run.world.hash();
      if (precision == Precision::f32 || mode.place == Place::cpu)
        CHECK_MESSAGE(run.world.hash() == wanted, mode.name());
    }
  }
}
