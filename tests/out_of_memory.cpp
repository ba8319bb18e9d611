// Pins that a call for which there is no memory is ErrorCode::buffer_full, wherever in it the memory ends, and leaves
// the world as it was: made again with memory, it gives what it gives in a world that never lacked any, and so do the
// steps that follow.
#include <functional>
#include <span>
#include <vector>

#include "support_memory.h"
#include "support_world.h"

using namespace worldtest;
using memorytest::Scarce;

namespace {

template <class T> ErrorCode code(const Result<T>& result) { return result ? ErrorCode::none : result.error().code; }

/// A world that is made by the same calls each time.
struct Host {
  World world;
  Stepper stepper;
  std::vector<BodyId> balls;
  BodyId hand;
  JointId joint;
  SpringId spring;
  ForceId force;
  TableId table;
  std::vector<std::byte> saved;

  explicit Host(bool sleep) {
    StepSettings settings;
    settings.sleep = sleep;
    must(stepper.configure(settings));
    (void)must(world.create_body(fixed_box({0, -0.5, 0}, {8, 0.5, 8})));
    for (int i = 0; i < 6; i++) balls.push_back(must(world.create_body(ball({0.9 * i, 0.45, 0}))));
    BodyDef def;
    def.kind = BodyKind::kinematic;
    hand = must(world.create_body(def));
    joint = must(world.create_joint(pin(balls[0], {0.45, 0, 0}, balls[1], {-0.45, 0, 0})));
    SpringDef pull;
    pull.a = balls[2];
    pull.b = balls[3];
    pull.stiffness = 10;
    spring = must(world.create_spring(pull));
    force = must(world.add_force(balls[4], Wrench{{1, 0, 0}, {}}));
    table = must(world.add_table("rooms", 2));
    run(world, stepper, 5);
    saved = world.snapshot();
    run(world, stepper, 5);
  }
};

using Act = std::function<ErrorCode(Host&)>;

/// How often it was refused for want of memory before it was made.
int refusals(Host& host, const Act& act) {
  for (int refused = 0;; refused++) {
    REQUIRE(refused < 5000);
    const std::uint64_t before = host.world.hash();
    const std::size_t contacts = host.world.contact_count();
    ErrorCode answer;
    {
      const Scarce memory(refused);
      answer = act(host);
    }
    if (answer == ErrorCode::none) return refused;
    CAPTURE(refused);
    REQUIRE(answer == ErrorCode::buffer_full);
    REQUIRE(host.world.hash() == before);
    REQUIRE(host.world.contact_count() == contacts);
  }
}

std::vector<std::pair<const char*, Act>> acts() {
  const auto step = [](Host& h) { return h.stepper.step(h.world, frame).error.code; };
  return {
      {"create_body", [def = ball({0, 3, 0})](Host& h) { return code(h.world.create_body(def)); }},
      {"step", step},
      {"create_joint",
       [](Host& h) {
         return code(h.world.create_joint(pin(h.balls[4], {}, h.balls[5], {-0.9, 0, 0})));
       }},
      {"create_spring",
       [](Host& h) {
         SpringDef def;
         def.a = h.balls[0];
         def.b = h.balls[4];
         def.stiffness = 5;
         return code(h.world.create_spring(def));
       }},
      {"step", step},
      {"grab",
       [](Host& h) {
         return code(h.world.grab(h.hand, h.balls[2], {1.8, 0.45, 0}));
       }},
      {"create_ragdoll",
       [human = RagdollDef::human()](Host& h) {
         return code(h.world.create_ragdoll(human, {{3, 1, 0}, {}}));
       }},
      {"step", step},
      {"set_collide", [](Host& h) { return code(h.world.set_collide(h.balls[2], h.balls[3], false)); }},
      {"set_pose",
       [](Host& h) {
         return code(h.world.set_pose(h.balls[5], {{5, 2, 0}, {}}));
       }},
      {"set_mass_properties",
       [](Host& h) {
         return code(h.world.set_mass_properties(h.balls[5], {3, {1, 1, 1}}));
       }},
      {"add_force",
       [](Host& h) {
         return code(h.world.add_force(h.balls[3], Wrench{{0, 1, 0}, {}}));
       }},
      {"callback",
       [](Host& h) { return code(h.world.add_force(h.balls[2], [](const World&, BodyId) { return Wrench{}; })); }},
      {"remove force", [](Host& h) { return code(h.world.remove(h.force)); }},
      {"add_property",
       [](Host& h) {
         return code(h.world.add_property<Vec3>("a_property_of_the_hosts_own", {1, 2, 3}));
       }},
      {"add_table", [](Host& h) { return code(h.world.add_table("another_table_of_the_hosts_own", 9)); }},
      {"resize", [](Host& h) { return code(h.world.resize(h.table, 50)); }},
      {"step", step},
      {"set_gravity",
       [](Host& h) {
         return code(h.world.set_gravity({0, -3, 0}));
       }},
      {"step", step},
      {"destroy body", [](Host& h) { return code(h.world.destroy(h.balls[3])); }},
      {"destroy joint", [](Host& h) { return code(h.world.destroy(h.joint)); }},
      {"step", step},
      {"destroy bodies", [](Host& h) { return code(h.world.destroy(std::span(h.balls).first(2))); }},
      {"step", step},
      {"plan_for", [](Host& h) { return code(h.stepper.plan_for(h.world, frame)); }},
      {"remove_property", [](Host& h) { return code(h.world.remove_property("a_property_of_the_hosts_own")); }},
      {"step", step},
  };
}

}  // namespace

TEST_CASE("out of memory: each call is refused or made whole") {
  for (const bool sleep : {false, true}) {
    CAPTURE(sleep);
    Host scarce(sleep), rich(sleep);
    int sum = 0;
    for (const auto& named : acts()) {
      const auto& act = named.second;
      CAPTURE(std::string(named.first));
      sum += refusals(scarce, act);
      REQUIRE(act(rich) == ErrorCode::none);
      REQUIRE(scarce.world.hash() == rich.world.hash());
      REQUIRE(scarce.world.body_count() == rich.world.body_count());
    }
    CHECK(sum > 200);
    run(scarce.world, scarce.stepper, 60);
    run(rich.world, rich.stepper, 60);
    CHECK(scarce.world.hash() == rich.world.hash());
  }
}

TEST_CASE("out of memory: restore, and a first step") {
  Host scarce(false), rich(false);
  CHECK(refusals(scarce, [](Host& h) { return code(h.world.restore(h.saved)); }) > 0);
  must(rich.world.restore(rich.saved));
  CHECK(scarce.world.hash() == rich.world.hash());
  scarce.stepper = Stepper();
  CHECK(refusals(scarce, [](Host& h) { return h.stepper.step(h.world, frame).error.code; }) > 50);
  rich.stepper = Stepper();
  run(rich.world, rich.stepper, 1);
  CHECK(scarce.world.hash() == rich.world.hash());
}

TEST_CASE("out of memory: hulls") {
  const Vec3 corners[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0.5}};
  int refused = 0;
  for (;; refused++) {
    REQUIRE(refused < 5000);
    const Scarce memory(refused);
    const Result<Hull> hull = make_hull(corners);
    if (hull) break;
    if (hull.error().code != ErrorCode::buffer_full) FAIL("refused for another reason");
  }
  CHECK(refused > 5);
}
