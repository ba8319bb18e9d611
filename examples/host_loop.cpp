// A host's loop: physics in fixed steps, drawing whenever a frame is due, poses in between interpolated,
// and an event of the host's own that is told once, when a contact begins.
#include <algorithm>
#include <cstdio>

#include "pcphys/pcphys.h"

using namespace pcphys;

namespace {

constexpr double step_time = 1.0 / 60;

Vec3 between(Vec3 a, Vec3 b, double share) { return (1 - share) * a + share * b; }

}  // namespace

int main() {
  World world;
  BodyDef floor, box;
  floor.kind = BodyKind::fixed;
  floor.shapes = {ShapeDef::plane()};
  box.shapes = {ShapeDef::box({0.5, 0.5, 0.5})};
  box.pose.position = {0, 2, 0};
  if (!world.create_body(floor)) return 1;
  const auto id = world.create_body(box);
  if (!id) return 1;

  Stepper stepper;
  double waiting = 0, lowest_jump = 0;
  std::size_t contacts = 0;
  int frames = 0, steps = 0, begun = 0;
  Vec3 last = box.pose.position, now = last, drawn = last;
  for (double time = 0; time < 2; ++frames) {
    const double frame_time = 0.004 + 0.003 * (frames % 5);  // the host's frames are not regular
    time += frame_time;
    for (waiting += frame_time; waiting >= step_time; waiting -= step_time) {
      if (const StepReport& report = stepper.step(world, step_time); !report)
        return std::puts(report.error.message.c_str()), 1;
      ++steps;
      last = now;
      now = world.pose(*id)->position;
      if (world.contact_count() > contacts) ++begun, std::printf("%.3f s: the box touched the floor\n", time);
      contacts = world.contact_count();
    }
    const Vec3 shown = between(last, now, waiting / step_time);
    lowest_jump = std::min(lowest_jump, shown.y - drawn.y);
    drawn = shown;
  }
  std::printf("%d frames, %d steps, box drawn at %.3f m, largest move in a frame %.3f m\n", frames, steps, drawn.y,
              -lowest_jump);
  // it falls 1.5 m and is at most 5.5 m/s fast: no frame of 16 ms may show a jump larger than that
  return begun >= 1 && drawn.y > 0.48 && drawn.y < 0.52 && lowest_jump > -0.1 ? 0 : 1;
}
