// A door on a hinge, which is a joint with one freedom: a ball hits it, and it swings open.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "pcphys/pcphys.h"

using namespace pcphys;

int main() {
  World world;
  BodyDef door, ball;
  door.shapes = {ShapeDef::box({0.45, 1.0, 0.03})};
  door.density = 600;
  door.pose.position = {0, 1.1, 0};
  ball.shapes = {ShapeDef::sphere(0.15)};
  ball.density = 400;
  ball.pose.position = {0.3, 1.3, 1};
  ball.velocity = {0, 0, -6};
  const auto door_id = world.create_body(door), ball_id = world.create_body(ball);
  if (!door_id || !ball_id) return 1;

  JointDef hinge;
  hinge.a = world.ground();
  hinge.b = *door_id;
  const Quat upwards = axis_angle({0, 0, 1}, std::numbers::pi / 2);  // the x axis of the frames is the hinge's
  hinge.frame_a = {{-0.45, 1.1, 0}, upwards};
  hinge.frame_b = {{-0.45, 0, 0}, upwards};
  hinge.freedom = AngleFreedom::hinge(-2.0, 2.0);
  const auto hinge_id = world.create_joint(hinge);
  if (!hinge_id) return 1;

  Stepper stepper;
  double widest = 0, lean = 0, apart = 0;
  for (int step = 0; step < 240; ++step) {
    if (const StepReport& report = stepper.step(world, 1.0 / 60); !report)
      return std::puts(report.error.message.c_str()), 1;
    const Quat q = world.pose(*door_id)->orientation;
    widest = std::max(widest, 2 * std::atan2(std::fabs(q.y), std::fabs(q.w)));
    lean = std::max(lean, std::acos(std::min(1.0, rotate(q, {0, 1, 0}).y)));
    apart = std::max(apart, *world.joint_separation(*hinge_id));
  }
  const double degrees = 180 / std::numbers::pi;
  std::printf("The door opened by %.0f degrees, leant by %.2f degrees, and its hinge gave %.3f mm.\n", degrees * widest,
              degrees * lean, 1000 * apart);
  return widest > 0.5 && widest < 2.2 && lean < 0.05 && apart < 0.01 ? 0 : 1;
}
