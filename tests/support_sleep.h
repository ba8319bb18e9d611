// What tests of sleeping share: towers that fall asleep.
#pragma once
#include <vector>

#include "support_world.h"

namespace worldtest {

inline StepSettings sleepy(StepSettings s = {}) {
  s.sleep = true;
  s.timings = false;
  return s;
}

inline BodyDef cube(Vec3 position, double half = 0.5) {
  BodyDef def;
  def.pose.position = position;
  def.shapes = {ShapeDef::box({half, half, half})};
  return def;
}

/// Towers of three cubes on a floor of their own, 10 m apart along x, and a joint between the two upper ones of the
/// first.
struct Towers {
  World world;
  std::vector<BodyId> floors, cubes;
  JointId joint;
  Stepper stepper{sleepy()};

  explicit Towers(int count = 2, Precision precision = Precision::f32) : world({precision}) {
    for (int k = 0; k < count; k++) {
      floors.push_back(must(world.create_body(fixed_box({10.0 * k, -0.5, 0}, {2, 0.5, 2}))));
      for (int i = 0; i < 3; i++) cubes.push_back(must(world.create_body(cube({10.0 * k, 0.5 + i, 0}))));
    }
    JointDef hold = pin(cubes[1], {0.3, 0.5, 0}, cubes[2], {0.3, -0.5, 0});
    hold.collide = true;
    joint = must(world.create_joint(hold));
  }
  bool asleep(int cube) const { return must(world.is_asleep(cubes[std::size_t(cube)])); }
  bool all_asleep() const {
    for (std::size_t i = 0; i < cubes.size(); i++)
      if (!asleep(int(i))) return false;
    return true;
  }
  /// Until everything sleeps; after how many steps.
  int fall_asleep(int most = 600) {
    for (int i = 1; i <= most; i++) {
      run(world, stepper, 1);
      if (all_asleep()) return i;
    }
    FAIL("still awake after " << most << " steps");
    return most;
  }
};

}  // namespace worldtest
