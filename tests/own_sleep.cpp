// Pins sleeping beside kernels of the host's own: what such a kernel depends on wakes the bodies that it acts on, and
// what it carries on from step to step keeps them awake; what no force follows from, what it makes anew, and a force
// that stays as it is, do not. The same on the CPU and on the GPU, by their hashes.
#include "pcphys/write_kernel.h"
#include "support_sleep.h"

using namespace worldtest;

namespace {

PCPHYS_KERNEL(hover,
              (PC_IN(Real) mass, PC_INOUT(Real) fuel, PC_INOUT(Vec3) force, PC_PARAM(Vec3) gravity, PC_PARAM(Real) h), {
                Real on = pc_select(fuel > PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0));
                precise Real lift = mass * on;
                force = pc_madd(force, gravity, -lift);
                precise Real left = fuel - h;
                fuel = pc_max(left, PC_REAL(0.0));
              })
PCPHYS_KERNEL(push, (PC_INOUT(Vec3) force, PC_PARAM(Vec3) by), { force = pc_add(force, by); })
PCPHYS_KERNEL(push_each, (PC_IN(Vec3) by, PC_INOUT(Vec3) force), { force = pc_add(force, by); })
PCPHYS_KERNEL(push_all, (PC_IN(Vec3) gust, PC_INOUT(Vec3) force), { force = pc_add(force, gust); })
PCPHYS_KERNEL(rise, (PC_INOUT(Vec3) gust), { gust.y = gust.y + PC_REAL(0.25); })
PCPHYS_KERNEL(speed, (PC_IN(Vec3) displacement_rate, PC_OUT(Real) fastness),
              { fastness = pc_length(displacement_rate); })
PCPHYS_KERNEL(grow_old, (PC_INOUT(int) age), { age = age + 1; })
PCPHYS_KERNEL(momentum, (PC_IN(Real) mass, PC_IN(Vec3) displacement_rate, PC_SUM(Vec3) total),
              { total = pc_scale(displacement_rate, mass); })
PCPHYS_KERNEL(hold_on, (PC_IN(Vec3) total, PC_INOUT(Vec3) force), { force = pc_madd(force, total, PC_REAL(-1e-3)); })
PCPHYS_KERNEL(tighten, (PC_INOUT(Real) grip), { grip = grip + PC_REAL(1.0); })
PCPHYS_KERNEL(pull, (PC_A(Vec3) position_a, PC_B(Vec3) position_b, PC_IN(Real) grip, PC_ADD_A(Vec3) force_a), {
  Vec3 way = pc_sub(position_b, position_a);
  force_a = pc_scale(way, grip);
})
PCPHYS_PAIR_KERNEL(
    attract, (PC_SELF(Vec3) position, PC_OTHER(Vec3) position_other, PC_OTHER(Real) charge_other, PC_ADD(Vec3) force), {
      Vec3 d = pc_sub(position_other, position);
      precise Real r2 = pc_dot(d, d) + PC_REAL(1.0);
      force = pc_scale(d, pc_div(charge_other, r2));
    })

PCPHYS_PAIR_KERNEL(count_near, (PC_SELF(Vec3) position, PC_OTHER(Vec3) position_other, PC_SUM(Real) crowd), {
  Vec3 d = pc_sub(position_other, position);
  crowd = pc_select(pc_dot(d, d) < PC_REAL(400.0), PC_REAL(1.0), PC_REAL(0.0));
})

StepSettings sleepy_at(Place place) {
  StepSettings settings = sleepy();
  settings.set_all(place);
  return settings;
}
/// Made of both places; what `act` returns, hashes above all, is the same.
void both_places(const std::function<std::vector<double>(const StepSettings&)>& act) {
  require_gl();
  const std::vector<double> cpu = act(sleepy_at(Place::cpu)), gl = act(sleepy_at(Place::gl));
  CHECK(cpu == gl);
}
std::vector<double> halves(std::uint64_t hash) { return {double(hash >> 32), double(hash & 0xffffffffu)}; }

/// Two towers of three cubes, 10 m apart.
struct Pushed : Towers {
  explicit Pushed(const StepSettings& settings) { stepper = Stepper(settings); }
  bool first_asleep() const { return asleep(0) && asleep(1) && asleep(2); }
  bool other_asleep() const { return asleep(3) && asleep(4) && asleep(5); }
  std::vector<double> hash() const { return halves(world.hash()); }
};

}  // namespace

TEST_CASE("a body that hovers on fuel stays awake while it burns, and falls when there is none") {
  both_places([](const StepSettings& settings) {
    World world;
    const auto fuel = must(world.add_property<Real>("fuel", 1, "s"));
    const BodyId body = must(world.create_body(ball({0, 20, 0})));
    Stepper stepper(settings);
    must(stepper.add_kernel(world, {.text = hover::text()}));
    run(world, stepper, 50);
    CHECK(!must(world.is_asleep(body)));
    CHECK(double(must(world.get(fuel, body))) == doctest::Approx(1 - 50 * frame).epsilon(1e-4));
    CHECK(must(world.pose(body)).position.y == doctest::Approx(20).epsilon(1e-5));
    run(world, stepper, 70);
    CHECK(double(must(world.get(fuel, body))) == 0);
    CHECK(must(world.pose(body)).position.y == doctest::Approx(20 - 0.5 * 9.81).epsilon(0.02));
    return halves(world.hash());
  });
}

TEST_CASE(
    "a force that stays as it is, what is made anew in each step, and what no force follows from keep nobody awake") {
  both_places([](const StepSettings& settings) {
    Pushed t(settings);
    (void)must(t.world.add_property<Real>("fastness"));
    (void)must(t.world.add_property<std::int32_t>("age"));
    const TableId one = must(t.world.add_table("one", 1));
    (void)must(t.world.add_property<Vec3>("total", {}, "kg m/s", one));
    must(t.stepper.add_kernel(t.world, {.text = push::text(), .parameters = {{"by", Vec3{20, 0, 0}}}}));
    must(t.stepper.add_kernel(t.world, {.text = speed::text()}));
    must(t.stepper.add_kernel(t.world, {.text = grow_old::text()}));
    must(t.stepper.add_kernel(t.world, {.text = momentum::text()}));
    must(t.stepper.add_kernel(t.world, {.text = hold_on::text()}));
    t.fall_asleep();
    must(t.stepper.set_parameter("push", {"by", Vec3{20, 0, 0}}));  // as it was
    run(t.world, t.stepper, 60);
    CHECK(t.all_asleep());
    return t.hash();
  });
}

TEST_CASE("a kernel that comes, goes or is given another parameter wakes all; one that is refused, none") {
  both_places([](const StepSettings& settings) {
    Pushed t(settings);
    t.fall_asleep();
    CHECK(!t.stepper.add_kernel(t.world, {.text = push_each::text()}));
    CHECK(t.all_asleep());
    must(t.stepper.add_kernel(t.world, {.text = push::text(), .parameters = {{"by", Vec3{0, 0, 0}}}}));
    for (int i = 0; i < 6; i++) CHECK(!t.asleep(i));
    t.fall_asleep();
    must(t.stepper.set_parameter("push", {"by", Vec3{0, 2e4, 0}}));
    run(t.world, t.stepper, 30);
    for (int i = 0; i < 6; i++) CHECK(must(t.world.pose(t.cubes[std::size_t(i)])).position.y > i % 3 + 0.6);
    must(t.stepper.set_parameter("push", {"by", Vec3{}}));
    t.fall_asleep();
    must(t.stepper.remove_kernel(t.world, "push"));
    for (int i = 0; i < 6; i++) CHECK(!t.asleep(i));
    t.fall_asleep();
    return t.hash();
  });
}

TEST_CASE("kernels that go together, or with their stepper, wake all, and nobody gathers forces for them any more") {
  enum class Way { all, stepper, another_world };
  for (const Way way : {Way::all, Way::stepper, Way::another_world})
    both_places([&](const StepSettings& settings) {
      Pushed t(settings);
      const auto gathers = [&] {
        return std::ranges::any_of(t.stepper.memory(t.world),
                                   [](const BufferUse& use) { return use.name == "pc_given_force"; });
      };
      CHECK(!gathers());
      must(t.stepper.add_kernel(t.world, {.text = push::text(), .parameters = {{"by", Vec3{0, 3000, 0}}}}));
      CHECK(gathers());
      t.fall_asleep();
      World other;
      if (way == Way::all) must(t.stepper.remove_kernels());
      if (way == Way::stepper) t.stepper = Stepper(settings);
      if (way == Way::another_world)
        must(t.stepper.add_kernel(other, {.text = push::text(), .parameters = {{"by", Vec3{}}}}));
      CHECK(t.all_asleep());
      if (way == Way::another_world) must(t.stepper.remove_kernels());
      run(t.world, t.stepper, 1);
      for (int i = 0; i < 6; i++) CHECK(!t.asleep(i));
      CHECK(!gathers());
      CHECK(t.stepper.plan().own.empty());
      t.fall_asleep();
      return t.hash();
    });
}

TEST_CASE("a parameter that changes in each step lets nobody sleep") {
  both_places([](const StepSettings& settings) {
    Pushed t(settings);
    must(t.stepper.add_kernel(t.world, {.text = push::text(), .parameters = {{"by", Vec3{}}}}));
    for (int i = 0; i < 150; i++) {
      must(t.stepper.set_parameter("push", {"by", Vec3{0.01 * i, 0, 0}}));
      CHECK(t.stepper.step(t.world, frame).asleep == 0);
    }
    return t.hash();
  });
}

TEST_CASE(
    "another value of a property of a body wakes its island, of a joint those of its bodies, of a table of one row "
    "all") {
  both_places([](const StepSettings& settings) {
    Pushed t(settings);
    const auto by = must(t.world.add_property<Vec3>("by", {}, "N"));
    const auto grip = must(t.world.add_property<Real>("grip", 0, "N/m", joint_table));
    const TableId air = must(t.world.add_table("air", 1)), notes = must(t.world.add_table("notes", 2));
    const auto gust = must(t.world.add_property<Vec3>("gust", {}, "N", air));
    const auto note = must(t.world.add_property<Real>("note", 0, "1", notes));
    for (const KernelText& text : {push_each::text(), push_all::text()})
      must(t.stepper.add_kernel(t.world, {.text = text}));
    must(t.stepper.add_kernel(t.world, {.text = pull::text(), .over = joint_table}));
    const auto check = [&](bool first, bool other, auto&& act) {
      t.fall_asleep();
      act();
      run(t.world, t.stepper, 1);
      CHECK(t.first_asleep() == !first);
      CHECK(t.other_asleep() == !other);
    };
    check(true, false, [&] { must(t.world.set(by, t.cubes[1], Vec3{0, 1, 0})); });
    check(false, false, [&] { must(t.world.set(by, t.cubes[1], Vec3{0, 1, 0})); });
    check(true, false, [&] { must(t.world.set(by, t.floors[0], Vec3{0, 1, 0})); });
    check(true, false, [&] { must(t.world.set(grip, t.joint, Real(1))); });
    check(true, true, [&] { must(t.world.set(gust, RowOf(1), Vec3{0, 1, 0})); });
    check(false, false, [&] { must(t.world.set(note, RowOf(1), Real(1))); });
    t.fall_asleep();
    must(t.world.set(by, t.cubes[2], Vec3{0, 3e4, 0}));
    run(t.world, t.stepper, 30);
    CHECK(must(t.world.pose(t.cubes[2])).position.y > 2.6);
    return t.hash();
  });
}

TEST_CASE("what kernels carry on in joints and tables keeps awake whom it is of, and wakes who sleeps") {
  both_places([](const StepSettings& settings) {
    Pushed t(settings);
    const auto grip = must(t.world.add_property<Real>("grip", 0, "N/m", joint_table));
    const TableId air = must(t.world.add_table("air", 1));
    const auto gust = must(t.world.add_property<Vec3>("gust", {}, "N", air));
    must(t.stepper.add_kernel(t.world, {.text = pull::text(), .over = joint_table}));
    must(t.stepper.add_kernel(t.world, {.text = push_all::text()}));
    t.fall_asleep();
    must(t.stepper.add_kernel(t.world, {.text = tighten::text(), .over = joint_table, .once_a_step = true}));
    run(t.world, t.stepper, 90);
    CHECK(double(must(t.world.get(grip, t.joint))) == 90);
    CHECK(!t.asleep(0));
    CHECK(t.other_asleep());
    must(t.stepper.remove_kernel(t.world, "tighten"));
    t.fall_asleep();
    must(t.stepper.add_kernel(t.world, {.text = rise::text(), .over = air, .once_a_step = true}));
    run(t.world, t.stepper, 90);
    CHECK(must(t.world.get(gust, RowOf(1))).y == 22.5);
    for (int i = 0; i < 6; i++) CHECK(!t.asleep(i));
    return t.hash();
  });
}

TEST_CASE("bodies that act on each other in pairs sleep together or not at all") {
  both_places([](const StepSettings& settings) {
    Pushed t(settings);
    const auto charge = must(t.world.add_property<Real>("charge", 0, "N m"));
    (void)must(t.world.add_property<Real>("crowd"));
    must(t.stepper.add_kernel(t.world, {.text = count_near::text()}));
    must(t.world.set_can_sleep(t.cubes[0], false));
    run(t.world, t.stepper, 120);
    CHECK(t.other_asleep());  // nothing pulls it
    must(t.stepper.add_kernel(t.world, {.text = attract::text()}));
    run(t.world, t.stepper, 120);
    CHECK(!t.asleep(3));
    must(t.world.set_can_sleep(t.cubes[0], true));
    t.fall_asleep();
    must(t.world.set(charge, t.floors[1], Real(10)));
    run(t.world, t.stepper, 1);
    for (int i = 0; i < 6; i++) CHECK(!t.asleep(i));
    t.fall_asleep();
    (void)must(t.world.create_body(cube({30, 50, 0})));
    run(t.world, t.stepper, 1);
    for (int i = 0; i < 6; i++) CHECK(!t.asleep(i));
    return t.hash();
  });
}
