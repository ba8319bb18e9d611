// Pins whose a property of the host's own is: the host's alone until a kernel of some stepper names it. Until then
// another value wakes nobody and is in no hash; from then on it is in the hash, whichever steppers come and go;
// snapshots hold it all the same. Role::state is in the hash always, Role::input never.
#include "pcphys/write_kernel.h"
#include "support_sleep.h"

using namespace worldtest;

namespace {

PCPHYS_KERNEL(pushed, (PC_IN(Real) thrust, PC_INOUT(Vec3) force), { force.y = force.y + thrust; })
PCPHYS_KERNEL(aged, (PC_INOUT(int) age), { age = age + 1; })
PCPHYS_KERNEL(warmed, (PC_INOUT(Real) heat), { heat = heat + PC_REAL(1.0); })

}  // namespace

TEST_CASE("the hash holds a property of the host's own once a kernel has named it, snapshots always") {
  World world(WorldDef{.gravity = {}});
  const BodyId body = must(world.create_body(ball({})));
  const std::uint64_t bare = world.hash();
  const auto age = must(world.add_property<std::int32_t>("age", 3));
  const auto score = must(world.add_property<std::int32_t>("score", 0));
  CHECK(world.hash() == bare);
  const std::vector<std::byte> saved = world.snapshot();
  must(world.set(age, body, 5));
  must(world.set(score, body, 7));
  CHECK(world.hash() == bare);
  must(world.restore(saved));
  CHECK(must(world.get(age, body)) == 3);
  CHECK(must(world.get(score, body)) == 0);
  std::uint64_t named = 0;
  {
    Stepper stepper;
    must(stepper.add_kernel(world, {.text = aged::text()}));
    named = world.hash();
    CHECK(named != bare);
    must(world.set(score, body, 7));  // which none names
    CHECK(world.hash() == named);
    must(world.set(age, body, 5));
    CHECK(world.hash() != named);
    must(world.set(age, body, 3));
    CHECK(world.hash() == named);
    must(stepper.remove_kernel(world, "aged"));
    CHECK(world.hash() == named);
  }
  CHECK(world.hash() == named);  // the stepper is gone
  must(world.remove_property("age"));
  CHECK(world.hash() == bare);
  (void)must(world.add_property<std::int32_t>("age", 3));  // another one
  CHECK(world.hash() == bare);
}

TEST_CASE("a kernel that is refused names nothing") {
  World world;
  const BodyId body = must(world.create_body(ball({})));
  const auto age = must(world.add_property<std::int32_t>("age"));
  Stepper stepper;
  must(stepper.add_kernel(world, {.text = aged::text()}));
  (void)must(world.add_property<Real>("heat"));
  const std::uint64_t hash = world.hash();
  CHECK_FALSE(stepper.add_kernel(world, {.text = warmed::text(), .follows = {"nobody"}}));
  CHECK_FALSE(stepper.add_kernel(world, {.text = aged::text()}));
  CHECK(world.hash() == hash);
  must(world.set(age, body, 1));
  CHECK(world.hash() != hash);
}

TEST_CASE("roles that are asked for: state is in the hash always, input never; tables of the host's own alike") {
  World world;
  const BodyId body = must(world.create_body(ball({})));
  const std::uint64_t bare = world.hash();
  const TableId cells = must(world.add_table("cells", 2));
  const auto noted = must(world.add_property<Real>("noted", 0, "1", cells));
  const auto given = must(world.add_property<Real>("thrust", 0, "N", body_table, Role::input));
  must(world.set(noted, RowOf(2), Real(1)));
  must(world.resize(cells, 3));
  CHECK(world.hash() == bare);
  Stepper stepper;
  must(stepper.add_kernel(world, {.text = pushed::text()}));
  const std::uint64_t named = world.hash();
  must(world.set(given, body, Real(2)));
  CHECK(world.hash() == named);
  const auto kept = must(world.add_property<Real>("kept", 0, "1", cells, Role::state));
  const std::uint64_t with = world.hash();
  CHECK(with != named);
  must(world.set(kept, RowOf(1), Real(1)));
  CHECK(world.hash() != with);
}

TEST_CASE("another value wakes nobody unless a kernel reads it, whatever its role") {
  for (const Role role : {Role::host, Role::state, Role::input}) {
    CAPTURE(std::string(name(role)));
    Towers t;
    const auto thrust = must(t.world.add_property<Real>("thrust", 0, "N", body_table, role));
    const auto age = must(t.world.add_property<std::int32_t>("age", 0, "1", body_table, role));
    t.fall_asleep();
    must(t.world.set(thrust, t.cubes[0], Real(1)));
    run(t.world, t.stepper, 1);
    CHECK(t.all_asleep());
    must(t.stepper.add_kernel(t.world, {.text = pushed::text()}));
    t.fall_asleep();
    must(t.world.set(age, t.cubes[0], 1));  // no kernel names it
    run(t.world, t.stepper, 1);
    CHECK(t.all_asleep());
    must(t.world.set(thrust, t.cubes[0], Real(2)));
    run(t.world, t.stepper, 1);
    CHECK_FALSE(t.asleep(0));
    CHECK(t.asleep(3));
  }
}
