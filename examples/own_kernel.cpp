// A property and a force of one's own, on the CPU and on the GPU, with the same bits: rockets that burn fuel.
#include <cstdio>

#include "pcphys/pcphys.h"
#include "pcphys/write_kernel.h"

using namespace pcphys;

PCPHYS_KERNEL(rocket,
              (PC_IN(Quaternion) orientation, PC_INOUT(Real) fuel, PC_INOUT(Vec3) force, PC_PARAM(Real) thrust,
               PC_PARAM(Real) flow, PC_PARAM(Real) h),
              {
                Real wanted = flow * h;
                Real burned = pc_min(fuel, wanted);
                Vec3 up = pc_rotate(orientation, Vec3(PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0)));
                fuel = fuel - burned;
                force = pc_madd(force, up, thrust * pc_div(burned, wanted));
              })

int main() {
  std::uint64_t hashes[2];
  for (const Place place : {Place::cpu, Place::gl}) {
    World world;
    const auto fuel = world.add_property<Real>("fuel", 1.5, "kg");
    BodyDef def;
    def.shapes = {ShapeDef::capsule(0.1, 0.5)};
    def.mass = 10;
    for (int i = 0; i < 100; i++) {
      def.pose.position = {double(i), 1, 0};
      if (!world.create_body(def)) return 1;
    }
    StepSettings settings;
    settings.set_all(place);
    Stepper stepper(settings);
    const Status added = stepper.add_kernel(world, {.text = rocket::text(), .parameters = {{"thrust", 150.0}, {"flow", 0.5}}});
    if (!added) return std::puts(added.error().message.c_str()), 1;
    for (int i = 0; i < 240; i++)
      if (!stepper.step(world, 1.0 / 60)) return 1;
    const BodyId first = world.bodies().front();
    std::printf("%s: height %.3f m, fuel %.3f kg, hash %016llx\n", name(place), world.pose(first)->position.y,
                double(*world.get(*fuel, first)), (unsigned long long)world.hash());
    hashes[int(place)] = world.hash();
  }
  return hashes[0] == hashes[1] ? 0 : 1;
}
