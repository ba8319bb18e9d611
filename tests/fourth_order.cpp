// Pins StepSettings::order = 4: chains move in fourth order, over a long run too, under steps that change and in any
// number of sub-steps; the same bits in lanes, threads and on GL, in all mixes; what is not smooth stays at second
// order, with its reason in the plan, and trees may go from the one to the other.
#include <cmath>
#include <functional>

#include "support_world.h"

using namespace worldtest;

namespace {

StepSettings fourth(std::uint32_t substeps = 1) {
  StepSettings s;
  s.order = 4;
  s.substeps = substeps;
  s.refinement = 1;
  s.timings = false;
  return s;
}

struct Swing {
  World world;
  std::vector<BodyId> links;
  explicit Swing(bool free = false, bool pushed = true) : world({Precision::f64, {2, 0, -9.81}}) {
    links = add_chain(world, {}, 3, free);
    if (pushed) (void)must(world.add_force(links[1], Wrench{{0, 3, 0}, {0.05, 0, 0}}));
  }
  /// Where the last link is after a second, in steps of `dt`, or of dt / 2 and 3 dt / 2 in turn.
  Vec3 end(double dt, StepSettings settings, bool changing = false) {
    Stepper stepper(settings);
    const int steps = int(std::lround(1 / dt));
    for (int i = 0; i < steps; i++) run(world, stepper, 1, !changing ? dt : i % 2 == 0 ? 0.5 * dt : 1.5 * dt);
    return world.pose(links.back())->position;
  }
};

std::string reason(const StepPlan& plan, std::string_view what) {
  for (const LeftOut& l : plan.left_out)
    if (l.what.find(what) != std::string::npos) return l.why;
  return "";
}

double energy(const World& world) { return world.kinetic_energy() + world.potential_energy(); }

}  // namespace

TEST_CASE("order 4: errors fall with the fourth power of the step") {
  for (const bool free : {false, true}) {
    const Vec3 exact = Swing(free).end(1.0 / 3840, fourth());
    const auto error = [&](double dt, StepSettings settings, bool changing = false) {
      return length(Swing(free).end(dt, settings, changing) - exact);
    };
    const double coarse = error(1.0 / 120, fourth()), fine = error(1.0 / 240, fourth()),
                 finer = error(1.0 / 480, fourth());
    INFO(free << ": " << coarse << ", " << fine << ", " << finer);
    CHECK(std::log2(coarse / fine) > 3.5);
    CHECK(std::log2(fine / finer) > 3.5);
    CHECK(error(1.0 / 120, fourth(2)) == doctest::Approx(fine).epsilon(1e-3));
    const double changing = error(1.0 / 120, fourth(), true), changing_fine = error(1.0 / 240, fourth(), true);
    CHECK(std::log2(changing / changing_fine) > 3.5);
    StepSettings second = fourth();
    second.order = 2;
    CHECK(error(1.0 / 240, second) > 300 * fine);
  }
}

TEST_CASE("order 4: energy and gaps over 100 s, momenta of a free chain") {
  Swing swing(false, false);
  Stepper stepper(fourth());
  const double start = energy(swing.world);
  double most = 0, gap = 0;
  for (int i = 0; i < 24000; i++) {
    run(swing.world, stepper, 1, 1.0 / 240);
    most = std::max(most, std::fabs(energy(swing.world) - start));
    const Pose a = *swing.world.pose(swing.links[0]), b = *swing.world.pose(swing.links[1]);
    gap = std::max(gap, length(a.position + rotate(a.orientation, {0, 0, -0.2}) - b.position -
                               rotate(b.orientation, {0, 0, 0.2})));
  }
  MESSAGE("energy " << most << " of " << std::fabs(start) << ", gap " << gap);
  CHECK(most < 2e-3 * std::fabs(start));
  CHECK(gap < 1e-14);

  World world({Precision::f64, {}});
  (void)add_chain(world, {}, 4, true);
  const Vec3 p = world.momentum(), l = world.angular_momentum();
  Stepper other(fourth());
  run(world, other, 600, 1.0 / 240);
  MESSAGE("momentum " << length(world.momentum() - p) << ", angular " << length(world.angular_momentum() - l) << " of "
                      << length(l));
  CHECK(length(world.momentum() - p) < 1e-6 * length(l));
  CHECK(length(world.angular_momentum() - l) < 1e-6 * length(l));
}

TEST_CASE("order 4: equal hashes in lanes, threads, on GL and in all mixes") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    INFO("precision " << (precision == Precision::f32 ? "float" : "double"));
    const auto hashes_of = [&](StepSettings settings, int steps) {
      settings.order = 4;
      World world = chains_world(precision);
      Stepper stepper(settings);
      const std::vector<std::uint64_t> all = hash_each_step(world, stepper, steps);
      CHECK(stepper.step(world, frame).fourth_order > 20);
      return all;
    };
    check_same_bits(hashes_of, 40, 8);
  }
}

TEST_CASE("order 4: a snapshot goes on alike") {
  Swing swing;
  Stepper stepper(fourth(4));
  run(swing.world, stepper, 20);
  const std::vector<std::byte> middle = swing.world.snapshot();
  run(swing.world, stepper, 20);
  const std::uint64_t wanted = swing.world.hash();
  must(swing.world.restore(middle));
  Stepper other(fourth(4));
  run(swing.world, other, 20);
  CHECK(swing.world.hash() == wanted);
}

TEST_CASE("order 4: a chain that meets a floor goes on at second order, and back") {
  World world({Precision::f64, {0, 0, -9.81}});
  (void)must(world.create_body(fixed_box({0, 0, -2.5}, {5, 5, 0.5})));
  const std::vector<BodyId> links = add_chain(world, {0, 0, 0}, 4, true, {0.5, 3, 0}, true);
  StepSettings settings = fourth(4);
  settings.refinement = 16;
  Stepper stepper(settings);
  const StepReport& first = stepper.step(world, frame);
  REQUIRE(first);
  CHECK(first.fourth_order == 4);
  CHECK(reason(stepper.plan(), "fourth order") == "");
  bool touched = false;
  for (int i = 0; i < 240; i++) {
    const StepReport& report = stepper.step(world, frame);
    REQUIRE(report);
    CHECK(report.fourth_order == (report.contacts > 0 ? 0 : 4));
    touched |= report.contacts > 0;
    if (report.contacts > 0)
      CHECK(reason(stepper.plan(), "fourth order of what is touched") == "contacts act once a sub-step");
  }
  CHECK(touched);
  for (const BodyId link : links) CHECK(world.pose(link)->position.z > -2.05);
  for (const BodyId link : links) CHECK(length(*world.velocity(link)) < 1);
}

TEST_CASE("order 4: changes between the orders keep the motion") {
  // 40 changes in a second cost what one order or the other does, and not the order of a kick each
  Swing second, mixed;
  StepSettings two = fourth();
  two.order = 2;
  const Vec3 exact = Swing().end(1.0 / 3840, fourth());
  const double error = length(second.end(1.0 / 240, two) - exact);
  Stepper stepper(fourth());
  for (int i = 0; i < 240; i++) {
    StepSettings settings = fourth();
    settings.order = i / 6 % 2 == 0 ? 4 : 2;
    must(stepper.configure(settings));
    run(mixed.world, stepper, 1, 1.0 / 240);
  }
  CHECK(length(mixed.world.pose(mixed.links.back())->position - exact) < error);
}

TEST_CASE("order 4: what stays at second order, and why") {
  struct Kind {
    const char* what;
    std::function<void(World&, std::vector<BodyId>&)> change;
  };
  const Kind kinds[] = {
      {"with drag", [](World& w, std::vector<BodyId>& l) { must(w.set_drag(l[1], 0.1, 0)); }},
      {"joints with angles",
       [](World& w, std::vector<BodyId>& l) {
         JointDef def = pin(l.back(), {0, 0, -0.2}, must(w.create_body(link_at({0, 0, -1.4}))), {0, 0, 0.2});
         def.freedom = AngleFreedom::hinge(-1, 1);
         (void)must(w.create_joint(def));
       }},
      {"loops", [](World& w, std::vector<BodyId>& l) { (void)must(w.create_joint(pin(l[0], {}, l[2], {}))); }},
      {"loaded pins",
       [](World& w, std::vector<BodyId>& l) {
         BodyDef load = link_at({0, 0, -1.4});
         load.density = 1e7;
         (void)must(w.create_joint(pin(l.back(), {0, 0, -0.2}, must(w.create_body(load)), {0, 0, 0.2})));
       }},
  };
  for (const Kind& kind : kinds) {
    INFO(kind.what);
    World world({Precision::f64, {0, 0, -9.81}});
    std::vector<BodyId> links = add_chain(world, {}, 3);
    kind.change(world, links);
    Stepper stepper(fourth());
    const StepReport& report = stepper.step(world, frame);
    REQUIRE(report);
    CHECK(report.fourth_order == 0);
    CHECK(reason(stepper.plan(), kind.what) != "");
    CHECK(reason(must(stepper.plan_for(world, frame)), kind.what) != "");
  }
  World carried({Precision::f64, {0, 0, -9.81}});
  BodyDef cart = link_at({0, 0, 0.2});
  cart.kind = BodyKind::kinematic;
  cart.velocity = {1, 0, 0};
  const BodyId rider = must(carried.create_body(cart)), first = must(carried.create_body(link_at({0, 0, -0.2})));
  (void)must(carried.create_joint(pin(rider, {0, 0, -0.2}, first, {0, 0, 0.2})));
  (void)must(
      carried.create_joint(pin(first, {0, 0, -0.2}, must(carried.create_body(link_at({0, 0, -0.6}))), {0, 0, 0.2})));
  Stepper driver(fourth());
  CHECK(driver.step(carried, frame).fourth_order == 0);
  CHECK(reason(driver.plan(), "what is carried") != "");

  World pendulum({Precision::f64, {0, 0, -9.81}});
  (void)add_chain(pendulum, {}, 1);
  Stepper stepper(fourth());
  CHECK(stepper.step(pendulum, frame).fourth_order == 0);
  CHECK(reason(stepper.plan(), "bodies on one pin") == "their turning about it is of fourth order already");
}

TEST_CASE("order 4: other orders are refused, and so is the original's scheme") {
  Stepper stepper;
  StepSettings settings;
  for (const std::uint32_t order : {0u, 1u, 3u, 5u, 6u}) {
    settings.order = order;
    const Status status = stepper.configure(settings);
    REQUIRE(!status);
    CHECK(status.error().code == ErrorCode::bad_argument);
    CHECK(status.error().message.find("it must be 2, or 4") != std::string::npos);
  }
  settings.order = 4;
  settings.integrator = Integrator::seed;
  CHECK(stepper.configure(settings).error().code == ErrorCode::bad_argument);
}
