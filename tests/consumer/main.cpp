// A host that knows only the installed package: headers, link line and the flags of user kernels.
#include <pcphys/pcphys.h>

#include <cstdio>

float spring(float stiffness, float stretch, float rest);

int main() {
  // (1 + 2^-12)^2 - 1 rounds to 2^-11 when product and sum are rounded apart, and to a bit more when fused.
  const float x = 1.0f + 1.0f / 4096.0f;
  if (spring(x, x, -1.0f) != 1.0f / 2048.0f) {
    std::puts("consumer: the user kernel was compiled with fused multiply-adds");
    return 1;
  }
  pcphys::World world;
  pcphys::BodyDef def;
  def.pose.position = {0, 2, 0};
  def.shapes = {pcphys::ShapeDef::sphere(0.25)};
  const auto ball = world.create_body(def);
  if (!ball) {
    std::printf("consumer: %s\n", ball.error().message.c_str());
    return 1;
  }
  pcphys::Stepper stepper;
  for (int i = 0; i < 60; ++i) {
    const pcphys::StepReport& report = stepper.step(world, 1.0 / 60);
    if (!report) {
      std::printf("consumer: %s\n", report.error.message.c_str());
      return 1;
    }
  }
  const double fallen = 2 - (*world.pose(*ball)).position.y;
  std::printf("consumer: pcphys %s, a ball fell %.3f m in 1 s\n", PCPHYS_VERSION, fallen);
  return fallen > 4.8 && fallen < 5.0 ? 0 : 1;
}
