// A ball falls onto a floor and comes to rest there.
#include <cmath>
#include <cstdio>

#include "pcphys/pcphys.h"

int main() {
  pcphys::World world;
  pcphys::BodyDef floor, ball;
  floor.kind = pcphys::BodyKind::fixed;
  floor.shapes = {pcphys::ShapeDef::plane()};
  ball.shapes = {pcphys::ShapeDef::sphere(0.5)};
  ball.pose.position = {0, 3, 0};
  const auto ground = world.create_body(floor);
  const auto id = world.create_body(ball);
  if (!ground || !id) return 1;
  pcphys::Stepper stepper;
  for (int step = 0; step < 180; ++step)
    if (const auto& report = stepper.step(world, 1.0 / 60); !report) return std::puts(report.error.message.c_str()), 1;
  const double height = world.pose(*id)->position.y;
  std::printf("The ball rests at %.4f m.\n", height);
  return std::fabs(height - 0.5) < 0.01 ? 0 : 1;
}
