// A motor with a limited torque runs a wheel up and brakes it; a weight hangs on a very stiff spring.
#include <cmath>
#include <cstdio>

#include "pcphys/pcphys.h"

using namespace pcphys;

int main() {
  World world;
  BodyDef wheel, weight;
  wheel.shapes = {ShapeDef::cylinder(0.2, 0.05)};
  wheel.pose.position = {0, 1, 0};
  weight.shapes = {ShapeDef::sphere(0.1)};
  weight.mass = 2.0;
  weight.pose.position = {1, 1, 0};
  const auto wheel_id = world.create_body(wheel), weight_id = world.create_body(weight);
  if (!wheel_id || !weight_id) return 1;

  JointDef axle;  // about the frames' x axis, here the cylinder's
  axle.a = world.ground();
  axle.b = *wheel_id;
  const Quat along_y = axis_angle({0, 0, 1}, std::acos(-1.0) / 2);
  axle.frame_a = {{0, 1, 0}, along_y};
  axle.frame_b = {{0, 0, 0}, along_y};
  axle.freedom = AngleFreedom::hinge();
  axle.motor = {10, 1};  // 10 rad/s, with at most 1 N m
  const auto axle_id = world.create_joint(axle);

  SpringDef spring;
  spring.a = world.ground();
  spring.b = *weight_id;
  spring.anchor_a = {1, 2, 0};
  spring.rest_length = 1;
  spring.stiffness = 1e6;  // far stiffer than a step of 1/60 s can follow
  const auto spring_id = world.create_spring(spring);
  if (!axle_id || !spring_id) return 1;

  Stepper stepper;
  double full_speed = 0;
  for (int step = 1; step <= 240; ++step) {
    if (const StepReport& report = stepper.step(world, 1.0 / 60); !report)
      return std::puts(report.error.message.c_str()), 1;
    if (full_speed == 0 && world.angular_velocity(*wheel_id)->y > 9.99) full_speed = step / 60.0;
    if (step == 180)
      if (const Status braked = world.set_motor(*axle_id, {0, 50}); !braked) return 1;  // a brake now
  }
  const double expected = 10 * world.mass_properties(*wheel_id)->moments.y / 1,
               sag = 1 - world.pose(*weight_id)->position.y;
  std::printf(
      "The wheel ran at 10 rad/s after %.2f s (%.2f expected), stands now at %.4f rad/s; the weight hangs %.1f um "
      "low.\n",
      full_speed, expected, world.angular_velocity(*wheel_id)->y, 1e6 * sag);
  return std::fabs(full_speed - expected) < 0.04 && std::fabs(world.angular_velocity(*wheel_id)->y) < 1e-3 &&
                 std::fabs(sag - 2 * 9.81 / 1e6) < 1e-6
             ? 0
             : 1;
}
