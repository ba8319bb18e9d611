// What worlds and steppers take, whether they tell of all of it, and whether they give back what they do not need.
#include <doctest/doctest.h>
#include <malloc.h>

#include <cstdint>
#include <string>
#include <vector>

#include "pcphys/pcphys.h"

using namespace pcphys;

namespace {

struct Kinds {
  const char* name;
  std::int64_t balls, boxes, ragdolls, springs;
  bool sleep;
};
constexpr Kinds kinds[] = {{"balls", 2000, 0, 0, 0, false},
                           {"boxes", 0, 500, 0, 0, false},
                           {"ragdolls", 0, 0, 60, 0, false},
                           {"springs", 0, 0, 0, 800, false},
                           {"all, with events and asleep", 400, 100, 10, 100, true}};

/// In a heap that touches.
World make(const Kinds& k, Precision precision) {
  WorldDef def;
  def.precision = precision;
  World world(def);
  std::int64_t made = 0;
  const auto next = [&] {
    const std::int64_t i = made++;
    return Vec3{0.999 * double(i % 10), 0.5 + 0.999 * double(i / 10 % 10), 0.999 * double(i / 100)};
  };
  const auto body = [&](const ShapeDef& shape) {
    BodyDef body;
    body.shapes = {shape};
    body.pose.position = next();
    return *world.create_body(body);
  };
  for (std::int64_t i = 0; i < k.balls; i++) body(ShapeDef::sphere(0.5));
  for (std::int64_t i = 0; i < k.boxes; i++) body(ShapeDef::box({0.5, 0.5, 0.5}));
  for (std::int64_t i = 0; i < k.ragdolls; i++) REQUIRE(world.create_ragdoll(RagdollDef::human(), {next(), {}}));
  for (std::int64_t i = 0; i < k.springs; i++) {
    SpringDef spring;
    spring.a = body(ShapeDef::sphere(0.2));
    spring.b = body(ShapeDef::sphere(0.2));
    spring.stiffness = 100;
    REQUIRE(world.create_spring(spring));
  }
  return world;
}

StepSettings settings_of(const Kinds& k) {
  StepSettings settings;
  settings.sleep = settings.contact_events = settings.body_events = k.sleep;
  settings.sleep_speed = settings.sleep_spin = 100;
  settings.sleep_time = 0.02;
  return settings;
}

double told(const std::vector<BufferUse>& uses) {
  double sum = 0;
  for (const BufferUse& use : uses) sum += double(use.bytes);
  return sum;
}

}  // namespace

TEST_CASE("memory: 95 % of what a world and its stepper take is told") {
  const auto used = [] { return double(mallinfo2().uordblks + mallinfo2().hblkhd); };
  if (used() == 0) {
    MESSAGE("this program's allocator tells nothing of what it has given");
    return;
  }
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const Kinds& k : kinds) {
      CAPTURE(std::string(k.name));
      const double before = used();
      World world = make(k, precision);
      Stepper stepper(settings_of(k));
      for (int i = 0; i < 6; i++) REQUIRE(stepper.step(world, 1.0 / 60));
      const double gained = used() - before, sum = told(stepper.memory(world));
      CHECK(sum > 0.95 * gained);
      CHECK(sum < 1.02 * gained);
      CHECK(double(world.memory_bytes()) < sum);
    }
}

TEST_CASE("memory: shrink() gives back what was needed by many, and changes no result") {
  for (const Kinds& k : kinds) {
    CAPTURE(std::string(k.name));
    World one = make(k, Precision::f32), two = make(k, Precision::f32);
    Stepper stepper(settings_of(k)), shrinking(settings_of(k));
    std::vector<std::size_t> bytes;
    std::vector<double> all;
    const auto go_on = [&](int steps) {
      for (int i = 0; i < steps; i++) {
        REQUIRE(stepper.step(one, 1.0 / 60));
        REQUIRE(shrinking.step(two, 1.0 / 60));
        REQUIRE(one.hash() == two.hash());
      }
      bytes.push_back(two.memory_bytes());
      all.push_back(told(shrinking.memory(two)));
    };
    go_on(4);
    for (World* world : {&one, &two}) {
      std::vector<BodyId> bodies = world->bodies();
      bodies.resize(bodies.size() - bodies.size() / 20);
      REQUIRE(world->destroy(bodies));
    }
    go_on(2);
    REQUIRE(two.shrink());
    REQUIRE(shrinking.shrink());
    REQUIRE(one.hash() == two.hash());
    go_on(2);
    CHECK(bytes[2] < bytes[0] / 4);
    CHECK(all[2] < all[0] / 4);
    for (World* world : {&one, &two})  // in the places of those that went
      for (int i = 0; i < 50; i++) {
        BodyDef ball;
        ball.shapes = {ShapeDef::sphere(0.5)};
        ball.pose.position = {0.9 * i, 3, 0};
        REQUIRE(world->create_body(ball));
      }
    go_on(10);
  }
}
