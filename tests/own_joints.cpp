// Pins kernels of the host's own over joints with their bodies: forces that they give to both are those of the closed
// form and of the library's springs; CPU (lanes, threads) and GPU agree to the bit wherever stages run, in octaves,
// with fixed and kinematic ends; everything is read before anything is given; a body sums in the order of its joints'
// ids, wherever rows stand; what stands or sleeps is given nothing.
#include <cmath>

#include "pcphys/write_kernel.h"
#include "support_ways.h"
#include "support_world.h"

using namespace worldtest;

namespace {

/// Hooke's law and a damper between the centres of two bodies.
PCPHYS_KERNEL(spring_damper,
              (PC_A(Vec3) position_a, PC_A(Vec3) displacement_rate_a, PC_B(Vec3) position_b,
               PC_B(Vec3) displacement_rate_b, PC_IN(Real) rest_length, PC_OUT(Real) stretch, PC_ADD_A(Vec3) force_a,
               PC_ADD_B(Vec3) force_b, PC_PARAM(Real) stiffness, PC_PARAM(Real) damping),
              {
                Vec3 way = pc_sub(position_b, position_a);
                Real size = pc_length(way);
                Vec3 along = pc_scale(way, pc_inverse_or_zero(size));
                Real rate = pc_dot(pc_sub(displacement_rate_b, displacement_rate_a), along);
                stretch = size - rest_length;
                force_a = pc_scale(along, stiffness * stretch + damping * rate);
                force_b = pc_negate(force_a);
              })

/// Hooke's law between the points where a joint or spring holds two bodies.
PCPHYS_KERNEL(pull_anchors,
              (PC_A(Vec3) position_a, PC_A(Quaternion) orientation_a, PC_IN(Vec3) anchor_a, PC_B(Vec3) position_b,
               PC_B(Quaternion) orientation_b, PC_IN(Vec3) anchor_b, PC_IN(Real) rest_length, PC_IN(Real) stiffness,
               PC_ADD_A(Vec3) force_a, PC_ADD_A(Vec3) torque_a, PC_ADD_B(Vec3) force_b, PC_ADD_B(Vec3) torque_b),
              {
                Vec3 arm_a = pc_rotate(orientation_a, anchor_a);
                Vec3 arm_b = pc_rotate(orientation_b, anchor_b);
                Vec3 way = pc_sub(pc_add(position_b, arm_b), pc_add(position_a, arm_a));
                Real size = pc_length(way);
                Real pull = stiffness * (size - rest_length);
                force_a = pc_scale(way, pull * pc_inverse_or_zero(size));
                force_b = pc_negate(force_a);
                torque_a = pc_cross(arm_a, force_a);
                torque_b = pc_cross(arm_b, force_b);
              })

/// What is given is what is read.
PCPHYS_KERNEL(conduction,
              (PC_A(Real) heat_of_a, PC_B(Real) heat_of_b, PC_ADD_A(Real) heat_a, PC_ADD_B(Real) heat_b,
               PC_ADD_A(uint) joints_a, PC_ADD_B(uint) joints_b, PC_ADD_B(Mat3) matter_b, PC_PARAM(Real) rate),
              {
                heat_a = rate * (heat_of_b - heat_of_a);
                heat_b = -heat_a;
                joints_a = 1u;
                joints_b = 1u;
                matter_b.x = Vec3(heat_a, heat_of_a, heat_of_b);
                matter_b.y = Vec3(heat_of_b, heat_a, heat_of_a);
                matter_b.z = matter_b.x;
              })

/// A link between two bodies for a kernel's law: a spring of the library without any force.
SpringDef link(BodyId a, BodyId b, double rest_length = 0) {
  SpringDef def;
  def.a = a;
  def.b = b;
  def.rest_length = rest_length;
  return def;
}
BodyId body(World& world, Vec3 at, double mass, BodyKind kind = BodyKind::dynamic) {
  BodyDef def = ball(at, 0.1);
  def.mass = mass;
  def.kind = kind;
  return must(world.create_body(def));
}
void add_heat(World& world) {
  must(world.add_property<Real>("heat", 0, "K"));
  must(world.add_property<std::uint32_t>("joints"));
  must(world.add_property<Mat3>("matter"));
}

/// Chains on pins, one of another octave; springs among them, from the ground, a kinematic body, and between chains.
World linked_chains(Precision precision) {
  World world = chains_world(precision);
  must(world.add_property<Real>("stretch", 0, "m", joint_table));
  must(world.add_property<Real>("stiffness", 3, "N/m", joint_table, Role::input));
  add_heat(world);
  const std::vector<BodyId> bodies = world.bodies();
  BodyDef carrier = ball({1, 2, 0}, 0.1);
  carrier.kind = BodyKind::kinematic;
  carrier.velocity = {0.3, 0, 0.1};
  const BodyId moves = must(world.create_body(carrier));
  for (std::size_t i = 2; i < bodies.size(); i += 5) {
    (void)must(world.create_spring(link(moves, bodies[i], 0.5)));
    (void)must(world.create_spring(link(world.ground(), bodies[i], 1.5)));
  }
  const auto heat = must(world.property<Real>("heat"));
  for (std::size_t i = 0; i < bodies.size(); i++) must(world.set(heat, bodies[i], Real(300 + 7.3 * double(i))));
  return world;
}
void add_all(Stepper& stepper, World& world) {
  must(stepper.add_kernel(world, {.text = spring_damper::text(),
                                  .over = joint_table,
                                  .once_a_step = true,
                                  .parameters = {{"stiffness", 5.0}, {"damping", 0.1}}}));
  must(stepper.add_kernel(world, {.text = pull_anchors::text(), .over = joint_table}));
  must(stepper.add_kernel(
      world,
      {.text = conduction::text(), .over = joint_table, .stage = Stage::impulses, .parameters = {{"rate", 0.01}}}));
}

PCPHYS_KERNEL(take_part, (PC_A(Real) part_of_a, PC_ADD_B(Real) taken_b), { taken_b = part_of_a; })

}  // namespace

TEST_CASE("a spring-damper between two free bodies is the damped oscillator, of second order, and keeps momentum") {
  constexpr double stiffness = 30, mass_a = 2, mass_b = 3, reduced = mass_a * mass_b / (mass_a + mass_b);
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    double errors[2];
    for (int fine = 0; fine < 2; fine++) {
      World world(WorldDef{precision, {}});
      must(world.add_property<Real>("stretch", 0, "m", joint_table));
      const BodyId a = body(world, {}, mass_a), b = body(world, {1.3, 0, 0}, mass_b);
      (void)must(world.create_spring(link(a, b, 1)));
      Stepper stepper;
      must(stepper.add_kernel(world, {.text = spring_damper::text(),
                                      .over = joint_table,
                                      .parameters = {{"stiffness", stiffness}, {"damping", 0.0}}}));
      const int steps = fine ? 120 : 60;
      run(world, stepper, steps, 1.0 / steps);
      const Vec3 at_a = must(world.pose(a)).position, at_b = must(world.pose(b)).position;
      errors[fine] = std::abs(at_b.x - at_a.x - 1 - 0.3 * std::cos(std::sqrt(stiffness / reduced)));
      const double centre = (mass_a * at_a.x + mass_b * at_b.x) / (mass_a + mass_b);
      CHECK(centre == doctest::Approx(0.78).epsilon(precision == Precision::f32 ? 1e-6 : 1e-14));
    }
    CHECK(errors[0] < 1e-3);
    if (precision == Precision::f64) CHECK(errors[0] / errors[1] == doctest::Approx(4).epsilon(0.1));
  }
}

TEST_CASE("its forces and torques are those of the library's spring, to what two methods of second order differ by") {
  const auto moved = [](bool own, int fine) {
    World world(WorldDef{Precision::f64, {0, -9.81, 0}});
    must(world.add_property<Real>("stiffness", own ? 40 : 0, "N/m", joint_table, Role::input));
    std::vector<BodyId> boxes;
    for (int i = 0; i < 3; i++) {
      BodyDef def = ball({1.0 * i, 0.1 * i, 0});
      def.shapes = {ShapeDef::box({0.2, 0.1, 0.15})};
      def.mass = 1 + i;
      boxes.push_back(must(world.create_body(def)));
      SpringDef spring = link(i == 0 ? world.ground() : boxes[std::size_t(i - 1)], boxes.back(), 0.4);
      spring.anchor_a = i == 0 ? Vec3{-0.8, 1, 0} : Vec3{0.2, 0.1, 0};
      spring.anchor_b = {-0.2, 0, 0.1};
      spring.stiffness = own ? 0 : 40;
      (void)must(world.create_spring(spring));
    }
    Stepper stepper;
    if (own) must(stepper.add_kernel(world, {.text = pull_anchors::text(), .over = joint_table}));
    run(world, stepper, 500 * fine, 1e-3 / fine);
    return states(world, boxes);
  };
  double apart[2] = {}, turned[2] = {};
  for (int fine = 1; fine <= 2; fine++) {
    const std::vector<BodyState> kernel = moved(true, fine), library = moved(false, fine);
    for (std::size_t i = 0; i < kernel.size(); i++) {
      apart[fine - 1] += length(kernel[i].pose.position - library[i].pose.position);
      turned[fine - 1] += length(kernel[i].angular_velocity - library[i].angular_velocity);
      CHECK(length(kernel[i].angular_velocity) > 0.1);
    }
  }
  CHECK(apart[0] < 5e-6);
  CHECK(apart[0] / apart[1] == doctest::Approx(4).epsilon(0.1));
  CHECK(turned[0] < 2e-3);
  CHECK(turned[0] / turned[1] == doctest::Approx(4).epsilon(0.1));
}

TEST_CASE("the same bits in lanes, threads, on the GPU and wherever stages run") {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64})
    check_same_bits(
        [&](const StepSettings& settings, int steps) {
          World world = linked_chains(precision);
          Stepper stepper(settings);
          add_all(stepper, world);
          const std::vector<std::uint64_t> hashes = hash_each_step(world, stepper, steps);
          CHECK(stepper.step(world, frame).refined > 0);  // octaves are part of it
          return hashes;
        },
        4, 2);
}

TEST_CASE("the same bits whoever steps") {
  for (const Precision precision : {Precision::f32, Precision::f64})
    check_same_ways({[&] { return linked_chains(precision); }, add_all}, 12, 4);
}

TEST_CASE("each joint of a body that moves gives once, everything is read before, and what stands takes nothing") {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const Place place : {Place::cpu, Place::gl}) {
      World world = linked_chains(precision);
      const auto count = must(world.property<std::uint32_t>("joints"));
      const auto heat = must(world.property<Real>("heat"));
      const std::vector<BodyId> bodies = world.bodies();
      std::vector<double> wanted(bodies.size());
      std::vector<std::uint32_t> ends(bodies.size());
      const auto place_of = [&](BodyId id) { return std::size_t(std::ranges::find(bodies, id) - bodies.begin()); };
      const auto give = [&](BodyId a, BodyId b) {
        const double flow = 0.01 * (double(must(world.get(heat, b))) - double(must(world.get(heat, a))));
        for (const auto& [id, by] : {std::pair(a, flow), std::pair(b, -flow)}) {
          const std::size_t i = place_of(id);
          if (i < bodies.size()) wanted[i] += by, ends[i]++;
        }
      };
      for (const JointId id : world.joints()) give(must(world.joint(id)).a, must(world.joint(id)).b);
      for (const SpringId id : world.springs()) give(must(world.spring(id)).a, must(world.spring(id)).b);
      std::vector<double> before;
      for (const BodyId id : bodies) before.push_back(double(must(world.get(heat, id))));
      StepSettings settings;
      settings.set_all(place);
      Stepper stepper(settings);
      must(stepper.add_kernel(
          world,
          {.text = conduction::text(), .over = joint_table, .once_a_step = true, .parameters = {{"rate", 0.01}}}));
      run(world, stepper, 1);
      for (std::size_t i = 0; i < bodies.size(); i++) {
        const bool moves = must(world.kind(bodies[i])) != BodyKind::fixed;
        CHECK(must(world.get(count, bodies[i])) == (moves ? ends[i] : 0));
        const double now = double(must(world.get(heat, bodies[i])));
        CHECK(now == doctest::Approx(before[i] + (moves ? wanted[i] : 0)).epsilon(1e-6));
      }
    }
}

TEST_CASE("part_of_a is of the property part_of where there is one, else of part") {
  World world(WorldDef{Precision::f64, {}});
  const BodyId a = must(world.create_body(ball({0, 5, 0}))), b = must(world.create_body(ball({3, 5, 0})));
  (void)must(world.create_joint(pin(a, {1.5, 0, 0}, b, {-1.5, 0, 0})));
  const auto part = must(world.add_property<Real>("part", 1)), taken = must(world.add_property<Real>("taken", 0));
  for (const bool both : {false, true}) {
    if (both) must(world.add_property<Real>("part_of", 5));
    Stepper stepper;
    must(stepper.add_kernel(world, {.text = take_part::text(), .over = joint_table, .once_a_step = true}));
    must(world.set(taken, b, Real(0)));
    run(world, stepper, 1);
    CHECK(double(must(world.get(taken, b))) == (both ? 5 : 1));
  }
  CHECK(double(must(world.get(part, a))) == 1);
}

TEST_CASE("the order is that of ids, wherever rows stand") {
  const auto made = [](bool moved) {
    World world(WorldDef{Precision::f32, {}});
    must(world.add_property<Real>("stretch", 0, "m", joint_table));
    const BodyId hub = body(world, {}, 5);
    std::vector<SpringDef> links;
    for (int i = 0; i < 150; i++) {
      const double turn = 0.7 * i;
      const BodyId rim =
          body(world, {(2 + 0.01 * i) * std::cos(turn), (1 + 0.02 * i) * std::sin(turn), 0.03 * i}, 1 + i % 4);
      links.push_back(i % 2 == 0 ? link(hub, rim, 1) : link(rim, hub, 1));
    }
    for (int i = 0; i < 150; i++) (void)must(world.create_spring(links[std::size_t(moved && i == 20 ? 21 : i)]));
    if (moved) {  // the link of index 20 stands in the last row
      const SpringId wrong = world.springs()[20];
      must(world.destroy(wrong));
      CHECK(must(world.create_spring(links[20])).index == wrong.index);
    }
    Stepper stepper;
    must(stepper.add_kernel(
        world,
        {.text = spring_damper::text(), .over = joint_table, .parameters = {{"stiffness", 9.0}, {"damping", 0.5}}}));
    run(world, stepper, 5);
    std::vector<Vec3> places;
    for (const BodyId id : world.bodies()) places.push_back(must(world.pose(id)).position);
    return places;
  };
  CHECK(made(false) == made(true));
}

TEST_CASE("what sleeps is given nothing; objects may come and go") {
  require_gl();
  for (const Place place : {Place::cpu, Place::gl}) {
    World world(WorldDef{Precision::f32, {0, -9.81, 0}});
    add_heat(world);
    (void)must(world.create_body(fixed_box({0, -0.5, 0}, {20, 0.5, 5})));
    const BodyId a = body(world, {0, 0.1, 0}, 1), b = body(world, {1, 0.1, 0}, 1);
    const BodyId c = body(world, {10, 0.1, 0}, 1), high = body(world, {10, 90, 0}, 1);
    (void)must(world.create_spring(link(a, b)));
    const SpringId other = must(world.create_spring(link(c, high)));
    StepSettings settings;
    settings.sleep = true;
    settings.set_all(place);
    Stepper stepper(settings);
    must(stepper.add_kernel(
        world, {.text = conduction::text(), .over = joint_table, .once_a_step = true, .parameters = {{"rate", 0.01}}}));
    run(world, stepper, 100);
    REQUIRE(must(world.is_asleep(a)));
    const auto count = must(world.property<std::uint32_t>("joints"));
    const std::uint32_t slept = must(world.get(count, a)), awake = must(world.get(count, c));
    CHECK(awake == 100);
    CHECK(slept < 100);
    run(world, stepper, 3);
    CHECK(must(world.get(count, a)) == slept);
    CHECK(must(world.get(count, c)) == awake + 3);
    must(world.destroy(other));
    (void)must(world.create_spring(link(b, high)));
    run(world, stepper, 3);
    CHECK(must(world.get(count, c)) == awake + 3);
    CHECK(must(world.get(count, high)) == awake + 6);
    CHECK(must(world.get(count, b)) == must(world.get(count, a)) + 3);
  }
}

TEST_CASE("a spring without stiffness and damping is a link and no work, until it is given some") {
  World world(WorldDef{Precision::f64, {0, -9.81, 0}}), without(WorldDef{Precision::f64, {0, -9.81, 0}});
  std::vector<BodyId> ends, others;
  for (World* w : {&world, &without}) {
    std::vector<BodyId>& made = w == &world ? ends : others;
    made = add_chain(*w, {}, 3);
    made.push_back(body(*w, {2, 0, 0}, 1));
  }
  const SpringId spring = must(world.create_spring(link(ends[1], ends[3], 0.5)));
  Stepper one, two;
  run(world, one, 20);
  run(without, two, 20);
  CHECK(states(world, ends) == states(without, others));
  CHECK(to_text(one.plan()) == to_text(two.plan()));
  must(world.set_spring(spring, 0.5, 40, 0));
  run(world, one, 20);
  run(without, two, 20);
  CHECK(states(world, ends) != states(without, others));
  CHECK(to_text(one.plan()).find("joint_drives") != std::string::npos);
  must(world.set_spring(spring, 0.5, 0, 0));
  run(world, one, 1);
  CHECK(to_text(one.plan()).find("joint_drives") == std::string::npos);
}
