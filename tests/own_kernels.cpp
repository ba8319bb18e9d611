// Pins kernels of the host's own: forces and properties that they make are those of the same arithmetic done otherwise;
// CPU and GL agree to the bit, in both precisions, for every type and wherever stages run; they run when and in the
// order that they ask for; a kernel that does not fit is refused with its reason, and the world and its motion are as
// without it.
#include <cmath>

#include "pcphys/write_kernel.h"
#include "support_ways.h"
#include "support_world.h"

using namespace worldtest;

namespace {

PCPHYS_KERNEL(weight, (PC_IN(Real) mass, PC_INOUT(Vec3) force, PC_PARAM(Vec3) pull),
              { force = pc_madd(force, pull, mass); })

PCPHYS_KERNEL(tether, (PC_IN(Vec3) position, PC_IN(Vec3) home, PC_INOUT(Vec3) force, PC_PARAM(Real) stiffness), {
  Vec3 away = pc_sub(home, position);
  force = pc_madd(force, away, stiffness);
})

PCPHYS_KERNEL(thruster,
              (PC_IN(Quaternion) orientation, PC_INOUT(Real) fuel, PC_INOUT(Vec3) force, PC_PARAM(Real) thrust,
               PC_PARAM(Real) flow, PC_PARAM(Real) h),
              {
                Real wanted = flow * h;
                Real burned = pc_min(fuel, wanted);
                Real share = pc_div(burned, wanted);
                Vec3 up = pc_rotate(orientation, Vec3(PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0)));
                fuel = fuel - burned;
                force = pc_madd(force, up, thrust * share);
              })

PCPHYS_KERNEL(all_types,
              (PC_INOUT(Real) r, PC_INOUT(Vec3) v, PC_INOUT(Quaternion) q, PC_INOUT(Sym3) s, PC_INOUT(Quad) f,
               PC_INOUT(Mat3) m, PC_INOUT(uint) n, PC_PARAM(Vec3) by),
              {
                r = r + by.x;
                v = pc_cross(v, by);
                q.w = q.w * by.y;
                s.yz = s.yz + s.xx;
                f.s = f.s - f.v.x;
                m.y.z = pc_dot(m.x, m.z);
                n = n + 3u;
              })

PCPHYS_KERNEL(all_numbers,
              (PC_INOUT(float) single, PC_INOUT(double) twice, PC_INOUT(int) whole, PC_INOUT(uint) k,
               PC_PARAM(int) less),
              {
                single = single * single;
                twice = twice + double(single);
                whole = whole - less;
                k = k * 5u;
              })

PCPHYS_KERNEL(count_steps, (PC_INOUT(uint) steps), { steps = steps + 1u; })

PCPHYS_KERNEL(clock_time, (PC_INOUT(Real) time, PC_PARAM(Real) h), { time = time + h; })

SceneWorld with_own(Precision precision) {
  SceneWorld s = scene_world("balls", 40, precision);
  must(s.world.add_property<Real>("fuel", 2.0, "kg", body_table,
                                  Role::state));  // hashes hold it beside worlds without kernels, too
  must(s.world.add_property<Vec3>("home", {0, 3, 0}, "m", body_table, Role::input));
  return s;
}
void add_forces(Stepper& stepper, World& world) {
  must(stepper.add_kernel(world, {.text = tether::text(), .parameters = {{"stiffness", 20.0}}}));
  must(stepper.add_kernel(world, {.text = thruster::text(), .parameters = {{"thrust", 40.0}, {"flow", 1.5}}}));
}

}  // namespace

TEST_CASE("a kernel's force is a force: a weight made by one falls as gravity does") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World fallen(WorldDef{precision, {0, -9.81, 0}}), pulled(WorldDef{precision, {}});
    const BodyId a = must(fallen.create_body(ball({0, 50, 0}))), b = must(pulled.create_body(ball({0, 50, 0})));
    Stepper one, two;
    must(two.add_kernel(pulled, {.text = weight::text(), .parameters = {{"pull", Vec3{0, -9.81, 0}}}}));
    run(fallen, one, 60);
    run(pulled, two, 60);
    const double tolerance = precision == Precision::f32 ? 1e-5 : 1e-12;
    CHECK(must(pulled.pose(b)).position.y == doctest::Approx(must(fallen.pose(a)).position.y).epsilon(tolerance));
    CHECK(must(pulled.velocity(b)).y == doctest::Approx(must(fallen.velocity(a)).y).epsilon(tolerance));
    must(two.set_parameter("weight", {"pull", Vec3{0, 9.81, 0}}));
    run(pulled, two, 60);
    CHECK(std::abs(must(pulled.velocity(b)).y) < (precision == Precision::f32 ? 1e-5 : 1e-11));
  }
}

TEST_CASE("a force of the place, in each sub-step, is of second order") {
  double errors[2];
  for (int fine = 0; fine < 2; fine++) {
    World world(WorldDef{Precision::f64, {}});
    must(world.add_property<Vec3>("home", {}, "m", body_table, Role::input));
    BodyDef def = ball({1, 0, 0});
    def.mass = 2;
    const BodyId b = must(world.create_body(def));
    Stepper stepper;
    must(stepper.add_kernel(world, {.text = tether::text(), .parameters = {{"stiffness", 8.0}}}));  // 2 rad/s
    const int steps = fine ? 120 : 60;
    run(world, stepper, steps, 1.0 / steps);
    errors[fine] = std::abs(must(world.pose(b)).position.x - std::cos(2.0));
  }
  CHECK(errors[0] < 1e-4);
  CHECK(errors[0] / errors[1] == doctest::Approx(4).epsilon(0.1));
}

TEST_CASE("on the GPU to the bit, wherever stages run") {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    std::uint64_t wanted = 0;
    for (const Mix& mix : mixes()) {
      SceneWorld s = with_own(precision);
      Stepper stepper(mix.settings());
      add_forces(stepper, s.world);
      run(s.world, stepper, 60);
      const std::uint64_t hash = s.world.hash();
      if (wanted == 0) wanted = hash;
      CHECK_MESSAGE(hash == wanted, mix.text());
      double burned = 0;
      const PropertyView fuel = must(s.world.view("fuel"));
      for (std::size_t row = 1; row < fuel.count; row++) burned += 2 - fuel.at(row);
      CHECK(burned > 10);
    }
    SceneWorld without = with_own(precision);
    Stepper plain;
    run(without.world, plain, 60);
    CHECK(without.world.hash() != wanted);
  }
}

TEST_CASE("every type is read and written alike on both sides") {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    std::uint64_t hashes[2];
    for (int gl = 0; gl < 2; gl++) {
      World world(WorldDef{precision, {}});
      const TableId table = must(world.add_table("things", 100));
      must(world.add_property<Real>("r", 0.1, "1", table));
      must(world.add_property<Vec3>("v", {1, 2, 3}, "1", table));
      must(world.add_property<Quat>("q", {0.1, 0.2, 0.3, 0.9}, "1", table));
      must(world.add_property<SymMat3>("s", {1, 2, 3, 4, 5, 6}, "1", table));
      must(world.add_property<Vec4>("f", {1, 2, 3, 40}, "1", table));
      must(world.add_property<Mat3>("m", {1, 2, 3, 4, 5, 6, 7, 8, 9}, "1", table));
      must(world.add_property<std::uint32_t>("n", 7, "1", table));
      const auto single = must(world.add_property<float>("single", 0.9f, "1", table));
      const auto twice = must(world.add_property<double>("twice", 0.1, "1", table));
      const auto whole = must(world.add_property<std::int32_t>("whole", 3, "1", table));
      const auto k = must(world.add_property<std::uint32_t>("k", 1, "1", table));
      StepSettings settings;
      if (gl) settings.set_all(Place::gl);
      Stepper stepper(settings);
      must(stepper.add_kernel(world,
                              {.text = all_types::text(), .over = table, .parameters = {{"by", Vec3{0.5, 0.75, 1}}}}));
      must(stepper.add_kernel(world,
                              {.text = all_numbers::text(), .over = table, .parameters = {{"less", std::int32_t(2)}}}));
      run(world, stepper, 3);
      CHECK(must(world.get(must(world.property<std::uint32_t>("n")), RowOf(100))) == 7 + 3 * 3 * 4);
      float square = 0.9f;
      double sum = 0.1;
      for (int i = 0; i < 12; i++) square = square * square, sum = sum + double(square);
      CHECK(must(world.get(single, RowOf(1))) == square);
      CHECK(must(world.get(twice, RowOf(100))) == sum);
      CHECK(must(world.get(whole, RowOf(50))) == 3 - 2 * 12);
      CHECK(must(world.get(k, RowOf(50))) == 244140625u);
      hashes[gl] = world.hash();
    }
    CHECK(hashes[0] == hashes[1]);
  }
}

TEST_CASE("a kernel of GLSL alone, from a string: the bits of the one of both sides, wherever its stage is") {
  require_gl();
  std::vector<std::uint64_t> hashes;
  for (const bool text_alone : {false, true})
    for (const Place place : {Place::cpu, Place::gl}) {
      SceneWorld s = with_own(Precision::f32);
      StepSettings settings;
      settings.set_all(place);
      Stepper stepper(settings);
      const std::string body =
          "{\n  Vec3 away = pc_sub(home, position);\n  force = pc_madd(force, away, stiffness);\n}";
      const KernelText glsl{
          .name = "tether",
          .signature = "(PC_IN(Vec3) position, PC_IN(Vec3) home, PC_INOUT(Vec3) force, PC_PARAM(Real) stiffness)",
          .body = body.c_str(),
          .file = nullptr};  // the library keeps what it needs of them
      must(stepper.add_kernel(s.world,
                              {.text = text_alone ? glsl : tether::text(), .parameters = {{"stiffness", 20.0}}}));
      run(s.world, stepper, 20);
      hashes.push_back(s.world.hash());
    }
  for (const std::uint64_t hash : hashes) CHECK(hash == hashes[0]);
}

TEST_CASE("forces made once a step are held: those of each sub-step begin with them") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    // beside a callback, which is asked once a step for the same force
    World asked(WorldDef{precision, {}}), made(WorldDef{precision, {}});
    for (World* world : {&asked, &made})
      must(world->add_property<Vec3>("home", {1, 2, 3}, "m", body_table, Role::input));
    const BodyId a = must(asked.create_body(ball({0, 5, 0}))), b = must(made.create_body(ball({0, 5, 0})));
    (void)must(asked.add_force(a, [](const World& w, BodyId id) {
      return Wrench{6.0 * (Vec3{1, 2, 3} - must(w.pose(id)).position), {}};
    }));
    (void)must(made.add_force(b, Wrench{{0.5, 0, 0}, {}}));
    (void)must(asked.add_force(a, Wrench{{0.5, 0, 0}, {}}));
    Stepper one, two;
    must(one.add_kernel(asked, {.text = weight::text(), .parameters = {{"pull", Vec3{0, -2, 0}}}}));
    must(two.add_kernel(made, {.text = weight::text(), .parameters = {{"pull", Vec3{0, -2, 0}}}}));
    must(two.add_kernel(made, {.text = tether::text(), .once_a_step = true, .parameters = {{"stiffness", 6.0}}}));
    run(asked, one, 60);
    run(made, two, 60);
    CHECK(length(must(made.pose(b)).position - must(asked.pose(a)).position) <
          (precision == Precision::f32 ? 1e-5 : 1e-13));
    CHECK(length(must(made.velocity(b)) - must(asked.velocity(a))) < (precision == Precision::f32 ? 1e-5 : 1e-12));
    CHECK(length(must(made.velocity(b))) > 1);
  }
}

TEST_CASE(
    "forces once a step and in each sub-step: the same bits everywhere, in any order of adding, and each alone as "
    "ever") {
  require_gl();
  const auto add = [](Stepper& stepper, World& world, bool once) {
    if (once)
      must(stepper.add_kernel(world,
                              {.text = tether::text(), .once_a_step = true, .parameters = {{"stiffness", 20.0}}}));
    else
      must(stepper.add_kernel(world, {.text = thruster::text(), .parameters = {{"thrust", 40.0}, {"flow", 1.5}}}));
  };
  const auto hashes_of = [&](const StepSettings& settings, int steps, Precision precision, std::vector<bool> makers,
                             std::optional<bool> removed) {
    SceneWorld s = with_own(precision);
    Stepper stepper(settings);
    for (const bool once : makers) add(stepper, s.world, once);
    if (removed) must(stepper.remove_kernel(s.world, *removed ? "tether" : "thruster"));
    return hash_each_step(s.world, stepper, steps);
  };
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    check_same_bits(
        [&](const StepSettings& settings, int steps) {
          return hashes_of(settings, steps, precision, {true, false}, {});
        },
        20, 6);
    const auto add_both = [&](Stepper& stepper, World& world) {
      for (const bool once : {true, false}) add(stepper, world, once);
    };
    check_same_ways({[&] { return std::move(with_own(precision).world); }, add_both}, 20, 6);
    const auto both = hashes_of({}, 20, precision, {true, false}, {});
    CHECK(hashes_of({}, 20, precision, {false, true}, {}) == both);
    for (const bool once : {true, false}) {
      const auto alone = hashes_of({}, 20, precision, {once}, {});
      CHECK(alone != both);
      CHECK(hashes_of({}, 20, precision, {true, false}, !once) == alone);
    }
  }
}

TEST_CASE("when: once a step, or in each sub-step") {
  SceneWorld s = scene_world("balls", 5);
  const auto steps = must(s.world.add_property<std::uint32_t>("steps"));
  const BodyId body = s.world.bodies().back();
  for (const bool once : {true, false})
    for (const Stage stage : {Stage::integrate, Stage::joints, Stage::impulses})
      for (const bool after : {false, true}) {
        Stepper stepper;
        must(stepper.add_kernel(s.world,
                                {.text = count_steps::text(), .stage = stage, .after = after, .once_a_step = once}));
        const std::uint32_t before = must(s.world.get(steps, body));
        run(s.world, stepper, 5);
        CHECK(must(s.world.get(steps, body)) - before == (once ? 5 : 5 * stepper.settings().substeps));
      }
}

TEST_CASE("h is the sub-step, and of a kernel that runs once a step the step") {
  require_gl();
  for (const Place place : {Place::cpu, Place::gl})
    for (const bool once : {true, false}) {
      SceneWorld s = scene_world("balls", 5);
      const auto time = must(s.world.add_property<Real>("time", 0, "s"));
      StepSettings settings;
      settings.set_all(place);
      Stepper stepper(settings);
      must(stepper.add_kernel(s.world, {.text = clock_time::text(), .once_a_step = once}));
      run(s.world, stepper, 8);
      for (const BodyId body : s.world.bodies())
        if (must(s.world.kind(body)) == BodyKind::dynamic)
          CHECK(double(must(s.world.get(time, body))) == doctest::Approx(8 * frame).epsilon(1e-6));
    }
}

TEST_CASE("removed, the world moves as without it") {
  SceneWorld a = with_own(Precision::f32), b = with_own(Precision::f32);
  Stepper one, two;
  (void)must(a.world.add_force(a.world.bodies()[1], Wrench{{1, 0, 0}, {}}));
  (void)must(b.world.add_force(b.world.bodies()[1], Wrench{{1, 0, 0}, {}}));
  add_forces(two, b.world);
  must(two.remove_kernel(b.world, "tether"));
  must(two.remove_kernel(b.world, "thruster"));
  run(a.world, one, 30);
  run(b.world, two, 30);
  CHECK(a.world.hash() == b.world.hash());
}

TEST_CASE("forces belong to the world's steps, whichever stepper makes them") {
  // made by one stepper, they are gone for the next; and that one may go first
  SceneWorld a = with_own(Precision::f32), b = with_own(Precision::f32);
  for (World* world : {&a.world, &b.world})
    (void)must(world->add_force(world->bodies()[1], Wrench{{1, 0, 0}, {0, 2, 0}}));
  Stepper with, without, plain;
  add_forces(with, b.world);
  run(a.world, plain, 20);
  run(b.world, without, 20);
  CHECK(a.world.hash() == b.world.hash());
  run(b.world, with, 5);
  CHECK(a.world.hash() != b.world.hash());
  const std::vector<std::byte> then = b.world.snapshot();
  run(b.world, without, 20);
  const std::uint64_t hash = b.world.hash();
  must(with.remove_kernel(b.world, "tether"));
  must(with.remove_kernel(b.world, "thruster"));
  must(b.world.restore(then));
  run(b.world, without, 20);
  CHECK(b.world.hash() == hash);
}

TEST_CASE("a plan that is kept names its kernels when they are gone") {
  SceneWorld s = with_own(Precision::f32);
  Stepper stepper;
  add_forces(stepper, s.world);
  const StepPlan plan = must(stepper.plan_for(s.world, frame));
  must(stepper.remove_kernel(s.world, "tether"));
  must(stepper.remove_kernel(s.world, "thruster"));
  CHECK(to_text(plan).find("thruster") != std::string::npos);
  CHECK(to_text(plan).find("pc_gather_forces") != std::string::npos);
  CHECK(to_text(must(stepper.plan_for(s.world, frame))).find("thruster") == std::string::npos);
}
