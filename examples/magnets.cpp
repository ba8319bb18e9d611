// Forces between all pairs of bodies, on the CPU and on the GPU, with the same bits:
// magnets that pull each other together.
#include <cstdio>

#include "magnet.h"
#include "pcphys/pcphys.h"

using namespace pcphys;

int main() {
  std::uint64_t hashes[2];
  for (const Place place : {Place::cpu, Place::gl}) {
    World world({.gravity = {}});
    const auto pole = world.add_property<Real>("pole", 1, "A m", body_table, Role::input);
    BodyDef def;
    def.shapes = {ShapeDef::sphere(0.05)};
    def.mass = 0.1;
    for (int i = 0; i < 216; i++) {
      def.pose.position = {0.4 * (i % 6), 0.4 * (i / 6 % 6), 0.4 * (i / 36)};
      const auto body = world.create_body(def);
      if (!body || !world.set(*pole, *body, Real(1 + i % 3))) return 1;
    }
    StepSettings settings;
    settings.set_all(place);
    Stepper stepper(settings);
    const Status added =
        stepper.add_kernel(world, {.text = magnet::text(), .parameters = {{"strength", 2e-3}, {"softening", 0.01}}});
    if (!added) return std::puts(added.error().message.c_str()), 1;
    for (int i = 0; i < 60; i++)
      if (const StepReport& made = stepper.step(world, 1.0 / 60); !made)
        return std::puts(made.error.message.c_str()), 1;
    const BodyId corner = world.bodies().front();
    std::printf("%s: a corner has moved to (%.3f, %.3f, %.3f) m, hash %016llx\n", name(place),
                world.pose(corner)->position.x, world.pose(corner)->position.y, world.pose(corner)->position.z,
                (unsigned long long)world.hash());
    hashes[int(place)] = world.hash();
  }
  return hashes[0] == hashes[1] ? 0 : 1;
}
