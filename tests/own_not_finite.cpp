// Pins what happens when a kernel of the host's own writes a number that is none: the step is an error that names the
// kernel and the object, on the CPU, on the GPU and where results stay there, and the world is as it was; once that is
// mended, steps go on. A body that leaves the range of numbers by finite forces is frozen and named, as ever.
#include "pcphys/write_kernel.h"
#include "support_world.h"

using namespace worldtest;

namespace {

PCPHYS_KERNEL(good, (PC_INOUT(Vec3) force),
              { force = pc_madd(force, Vec3(PC_REAL(1.0), PC_REAL(0.0), PC_REAL(0.0)), PC_REAL(0.5)); })
PCPHYS_KERNEL(quotient, (PC_IN(Vec3) home, PC_INOUT(Vec3) force, PC_PARAM(Real) at), {
  precise Real d = home.x - at;
  force.y = force.y + pc_div(d, d);
})
PCPHYS_KERNEL(root, (PC_OUT(Real) fuel, PC_PARAM(Real) of), { fuel = pc_sqrt(of); })
PCPHYS_PAIR_KERNEL(bare_gravity,
                   (PC_SELF(Vec3) position, PC_OTHER(Vec3) position_other, PC_ADD(Vec3) force,
                    PC_PARAM(Real) softening),
                   {
                     Vec3 d = pc_sub(position_other, position);
                     precise Real r2 = pc_dot(d, d) + softening;
                     force = pc_scale(d, pc_div(PC_REAL(1e-3), r2));
                   })
PCPHYS_KERNEL(mean_inverse, (PC_IN(Real) x, PC_SUM(Real) inverse), { inverse = pc_div(PC_REAL(1.0), x); })
PCPHYS_KERNEL(farthest, (PC_IN(Real) x, PC_MIN(Real) nearest, PC_MAX(Vec3) beyond), {
  Real root = pc_sqrt(x);
  nearest = root;
  beyond = Vec3(x, root, x);
})
PCPHYS_KERNEL(shove, (PC_IN(Real) shoved, PC_INOUT(Vec3) force, PC_PARAM(Real) size), {
  precise Real more = size * PC_REAL(1e8);
  force.x = force.x + shoved * more;
})

/// All that a host writes and that lasts: what is scratch, or follows from the rest, is made anew by the next step.
std::vector<double> lasting(const World& world) {
  std::vector<double> numbers{double(world.hash())};
  for (const PropertyInfo& info : world.properties()) {
    if (info.role == Role::derived || info.role == Role::scratch) continue;
    const PropertyView view = must(world.view(info.name));
    for (std::size_t row = 0; row < view.count; row++)
      for (std::uint32_t c = 0; c < view.components; c++) numbers.push_back(view.at(row, c));
  }
  return numbers;
}
void check_named(Stepper& stepper, World& world, const std::string& words) {
  const std::vector<double> before = lasting(world);
  const std::vector<std::byte> snapshot = world.snapshot();
  const Status made = step_status(stepper, world);
  REQUIRE(!made);
  CHECK(made.error().code == ErrorCode::not_finite);
  CHECK_MESSAGE(made.error().message.find(words) != std::string::npos, made.error().message);
  CHECK(lasting(world) == before);
  CHECK(world.snapshot() == snapshot);
}

World three(Precision precision) {
  World world(WorldDef{precision, {}});
  const auto home = must(world.add_property<Vec3>("home", {}, "m", body_table, Role::input));
  for (int i = 0; i < 3; i++)
    must(world.set(home, must(world.create_body(ball({3.0 * i, 5, 0}))), Vec3{3.0 * i, 5, 0}));
  return world;
}
StepSettings at(Place place, bool resident = false) {
  StepSettings settings;
  settings.set_all(place);
  settings.resident = resident;
  return settings;
}
void each_place(const std::function<void(const StepSettings&, Precision)>& check) {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const StepSettings& settings : {at(Place::cpu), at(Place::gl), at(Place::gl, true)})
      check(settings, precision);
}

}  // namespace

TEST_CASE("a force that is no number names kernel and body, in sub-steps and where one kernel makes all of them") {
  each_place([](const StepSettings& settings, Precision precision) {
    for (const bool once : {false, true}) {
      World world = three(precision);
      Stepper stepper(settings);
      must(stepper.add_kernel(world, {.text = good::text(), .once_a_step = once}));
      must(stepper.add_kernel(world, {.text = quotient::text(), .once_a_step = once, .parameters = {{"at", 1.0}}}));
      must(stepper.set_parameter("quotient", {"at", 3.0}));
      const std::string words =
          "The kernel \"quotient\" gave body " + std::to_string(world.bodies()[1].index) + " a \"force\"";
      check_named(stepper, world, words);
      check_named(stepper, world, words);
      must(stepper.set_parameter("quotient", {"at", 2.0}));
      run(world, stepper, 2);
    }
  });
}

TEST_CASE("so does a property of one's own") {
  each_place([](const StepSettings& settings, Precision precision) {
    World world = three(precision);
    const auto fuel = must(world.add_property<Real>("fuel", 1));
    Stepper stepper(settings);
    must(stepper.add_kernel(world, {.text = root::text(), .parameters = {{"of", -4.0}}}));
    check_named(stepper, world, "The kernel \"root\" gave body");
    must(stepper.set_parameter("root", {"of", 4.0}));
    run(world, stepper, 1);
    CHECK(double(must(world.get(fuel, world.bodies()[0]))) == 2);
  });
}

TEST_CASE("and pairs in one place, and totals") {
  each_place([](const StepSettings& settings, Precision precision) {
    World world = three(precision);
    must(world.set_pose(world.bodies()[2], must(world.pose(world.bodies()[1]))));
    for (const BodyId id : world.bodies()) must(world.set_filter(id, {.category = 1, .mask = 0}));
    Stepper stepper(settings);
    must(stepper.add_kernel(world, {.text = bare_gravity::text(), .parameters = {{"softening", 0.0}}}));
    check_named(stepper, world, "The kernel \"bare_gravity\" gave body");
    must(stepper.set_parameter("bare_gravity", {"softening", 0.1}));
    run(world, stepper, 1);
    const TableId table = must(world.add_table("totals", 1));
    const auto inverse = must(world.add_property<Real>("inverse", 0, "1", table));
    const auto x = must(world.add_property<Real>("x", 2, "1"));
    must(stepper.add_kernel(world, {.text = mean_inverse::text()}));
    run(world, stepper, 1);
    CHECK(double(must(world.get(inverse, RowOf(1)))) == 1.5);
    must(world.set(x, world.bodies()[1], Real(0)));
    check_named(stepper, world, "The kernel \"mean_inverse\" gave the total of all rows a \"inverse\"");
  });
}

TEST_CASE("and least and most, whichever row it is") {
  each_place([](const StepSettings& settings, Precision precision) {
    World world = three(precision);
    const TableId table = must(world.add_table("totals", 1));
    const auto nearest = must(world.add_property<Real>("nearest", 0, "1", table));
    const auto beyond = must(world.add_property<Vec3>("beyond", {}, "1", table));
    const auto x = must(world.add_property<Real>("x", 2, "1"));
    Stepper stepper(settings);
    must(stepper.add_kernel(world, {.text = farthest::text()}));
    for (const BodyId body : world.bodies()) {
      must(world.set(x, body, Real(-1)));
      check_named(stepper, world, "The kernel \"farthest\" gave the total of all rows a \"nearest\"");
      must(world.set(x, body, Real(4)));
    }
    must(world.set(x, world.bodies()[1], Real(9)));
    run(world, stepper, 1);
    CHECK(double(must(world.get(nearest, RowOf(1)))) == 2);
    CHECK(must(world.get(beyond, RowOf(1))).y == 3);
  });
}

TEST_CASE("a finite push beyond the range of numbers freezes its body") {
  each_place([](const StepSettings& settings, Precision precision) {
    for (const bool once : {false, true}) {
      World world = three(precision);
      const auto shoved = must(world.add_property<Real>("shoved", 0, "1", body_table, Role::input));
      const BodyId body = world.bodies()[1];
      must(world.set(shoved, body, Real(1)));
      Stepper stepper(settings);
      must(stepper.add_kernel(world, {.text = shove::text(), .once_a_step = once, .parameters = {{"size", 1e15}}}));
      const StepReport& report = stepper.step(world, frame);
      REQUIRE_MESSAGE(bool(report), report.error.message);
      CHECK(report.frozen == std::vector<BodyId>{body});
    }
  });
}

namespace {

PCPHYS_KERNEL(burn, (PC_IN(Real) shoved, PC_INOUT(Real) fuel, PC_INOUT(Vec3) force), {
  precise Real push = shoved * PC_REAL(1e8);
  force.x = force.x + push * PC_REAL(1e15);
  precise Real left = pc_sqrt(fuel);
  fuel = left + PC_REAL(1.0);
})

/// Three bodies in flight, made at the places of settings; nobody asks for anything between steps.
struct Flight {
  World world;
  Stepper stepper;
  Property<Real> shoved = must(world.add_property<Real>("shoved", 0)),
                 fuel = must(world.add_property<Real>("fuel", 1000));
  std::vector<BodyId> bodies;

  Flight(const StepSettings& settings, Precision precision, int steps) : world({precision}), stepper(settings) {
    for (int i = 0; i < 3; i++) {
      BodyDef def = ball({3.0 * i, 5, 0});
      def.velocity = {0.1, 0, 0};
      bodies.push_back(must(world.create_body(def)));
    }
    must(stepper.add_kernel(world, {.text = burn::text(), .once_a_step = true}));
    run(world, stepper, steps);
  }
};

}  // namespace

TEST_CASE("a step in flight that is made again begins where it began, cold and warm, wherever its results are") {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const int steps : {0, 3})
      for (const bool asked : {false, true}) {
        INFO("steps before: " << steps << ", asked for: " << asked);
        Flight host(at(Place::cpu), precision, steps), there(at(Place::gl, true), precision, steps);
        for (Flight* f : {&host, &there}) {
          if (asked) (void)must(f->world.pose(f->bodies[0]));
          must(f->world.set(f->shoved, f->bodies[1], Real(1)));
          const StepReport& report = f->stepper.step(f->world, frame);
          REQUIRE_MESSAGE(bool(report), report.error.message);
          CHECK(report.frozen == std::vector<BodyId>{f->bodies[1]});
        }
        for (std::size_t i = 0; i < 3; i++)
          CHECK(must(there.world.pose(there.bodies[i])) == must(host.world.pose(host.bodies[i])));
        CHECK(there.world.hash() == host.world.hash());
        for (Flight* f : {&host, &there}) run(f->world, f->stepper, 2);
        CHECK(there.world.hash() == host.world.hash());
      }
}

TEST_CASE("and one that is refused leaves what the device alone had as it was") {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const int steps : {0, 3}) {
      Flight host(at(Place::cpu), precision, steps), there(at(Place::gl, true), precision, steps);
      const std::uint64_t hash = host.world.hash();
      for (Flight* f : {&host, &there}) {
        must(f->world.set(f->fuel, f->bodies[1], Real(-4)));
        const Status made = step_status(f->stepper, f->world);
        REQUIRE(!made);
        CHECK(made.error().message.find("The kernel \"burn\" gave body") != std::string::npos);
        must(f->world.set(f->fuel, f->bodies[1], Real(1000)));
      }
      if (steps == 0) CHECK(host.world.hash() == hash);
      CHECK(lasting(there.world) == lasting(host.world));
      for (Flight* f : {&host, &there}) run(f->world, f->stepper, 2);
      CHECK(lasting(there.world) == lasting(host.world));
    }
}

TEST_CASE("without kernels, too, a body that leaves the range where results stay on the device is frozen alone") {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World worlds[2] = {World({precision}), World({precision})};
    std::uint64_t hashes[2];
    for (int k = 0; k < 2; k++) {
      World& world = worlds[k];
      std::vector<BodyId> bodies;
      for (int i = 0; i < 3; i++) {
        BodyDef light = ball({3.0 * i, 5, 0});
        light.mass = 1e-6;
        bodies.push_back(must(world.create_body(light)));
      }
      Stepper stepper(at(k ? Place::gl : Place::cpu, k == 1));
      run(world, stepper, 3);
      (void)must(world.add_force(bodies[1], Wrench{{1e15, 0, 0}, {}}));
      const StepReport& report = stepper.step(world, frame);
      REQUIRE_MESSAGE(bool(report), report.error.message);
      CHECK(report.frozen == std::vector<BodyId>{bodies[1]});
      run(world, stepper, 2);
      hashes[k] = world.hash();
    }
    CHECK(hashes[0] == hashes[1]);
  }
}
