// A property and a force of one's own, on the CPU and on the GPU, with the same bits: a rocket that burns fuel.
#include <cstdio>

#include "pcphys/pcphys.h"
#include "pcphys/write_kernel.h"

using namespace pcphys;

PCPHYS_KERNEL(rocket,
              (PC_IN(Quaternion) orientation, PC_INOUT(Real) fuel, PC_INOUT(Vec3) force, PC_PARAM(Real) exhaust_speed,
               PC_PARAM(Real) flow, PC_PARAM(Real) h),
              {
                Real wanted = flow * h;
                Real burned = pc_min(fuel, wanted);
                Vec3 up = pc_rotate(orientation, Vec3(PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0)));
                fuel = fuel - burned;
                force = pc_madd(force, up, pc_div(burned, h) * exhaust_speed);
              })

int main() {
  std::uint64_t hashes[2];
  for (const Place place : {Place::cpu, Place::gl}) {
    World world;
    const auto fuel = world.add_property<Real>("fuel", 1.5, "kg");
    BodyDef def;
    def.shapes = {ShapeDef::capsule(0.1, 0.5)};
    def.mass = 10;
    const auto body = world.create_body(def);
    Stepper stepper({.integrate = place, .joints = place, .impulses = place});
    // In m/s and kg/s.
    const KernelDef kernel = {.text = rocket::text(), .parameters = {{"exhaust_speed", 300.0}, {"flow", 0.5}}};
    if (const Status added = stepper.add_kernel(world, kernel); !added)
      return std::puts(added.error().message.c_str()), 1;
    for (int i = 0; i < 240; i++)
      if (const StepReport& report = stepper.step(world, 1.0 / 60); !report)
        return std::puts(report.error.message.c_str()), 1;
    hashes[int(place)] = world.hash();
    std::printf("%s: height %.3f m, fuel %.3f kg, hash %016llx\n", name(place), world.pose(*body)->position.y,
                double(*world.get(*fuel, *body)), (unsigned long long)hashes[int(place)]);
  }
  return hashes[0] == hashes[1] ? 0 : 1;
}
