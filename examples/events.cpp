// Events: marbles drop onto a drum. Each hit is a sound as loud as its impulse; only what moved is drawn again.
#include <cmath>
#include <cstdio>

#include "pcphys/pcphys.h"

using namespace pcphys;

int main() {
  World world;
  BodyDef drum;
  drum.kind = BodyKind::fixed;
  drum.shapes = {ShapeDef::cylinder(2, 0.5)};
  drum.pose.position = {0, -0.5, 0};
  drum.material.restitution = 0.5;
  if (!world.create_body(drum)) return 1;
  for (int i = 0; i < 5; i++) {
    BodyDef marble;
    marble.shapes = {ShapeDef::sphere(0.1)};
    marble.mass = 0.1 * (i + 1);
    marble.material.restitution = 0.5;
    marble.pose.position = {0.5 * i - 1, 1.1 + 0.5 * i, 0};
    if (!world.create_body(marble)) return 1;
  }
  StepSettings settings;
  settings.contact_events = settings.hit_events = settings.body_events = true;
  settings.hit_speed = 2;  // [m/s]
  Stepper stepper(settings);
  std::size_t sounds = 0, touching = 0, drawn = 0;
  for (int step = 1; step <= 240; step++) {
    if (const StepReport& report = stepper.step(world, 1.0 / 60); !report)
      return std::puts(report.error.message.c_str()), 1;
    const StepEvents events = stepper.events();
    for (const ContactHit& hit : events.hits)
      std::printf("%.2f s: body %u sounds at x = %+.2f m, %.2f m/s, %.2f N s\n", step / 60.0, hit.a.index, hit.point.x,
                  hit.speed, hit.impulse);
    sounds += events.hits.size();
    touching += events.begun.size() - events.ended.size();
    drawn += events.moved.size();
  }
  std::printf("%zu sounds, %zu pairs touch now, %zu poses drawn\n", sounds, touching, drawn);
  return sounds >= 5 && touching == 5 && drawn > 0 ? 0 : 1;
}
