// A wedge as a convex hull: points in any order, one hull for many bodies, and what bad points answer.
#include <cmath>
#include <cstdio>
#include <vector>

#include "pcphys/pcphys.h"

using namespace pcphys;

int main() {
  // A ramp 2 m long, 1 m wide and high. Points inside, on faces or given twice do no harm.
  const std::vector<Vec3> points{{0, 0, 0}, {2, 0, 0}, {0, 1, 0},       {0, 0, 1},
                                 {2, 0, 1}, {0, 1, 1}, {0.5, 0.2, 0.5}, {2, 0, 0}};
  const auto wedge = make_hull(points);
  if (!wedge) return std::puts(wedge.error().message.c_str()), 1;
  std::printf("%zu vertices, %zu faces, %.3f m^3\n", wedge->vertices().size(), wedge->face_count(), wedge->volume());

  World world;
  BodyDef floor;
  floor.kind = BodyKind::fixed;
  floor.shapes = {ShapeDef::plane()};
  BodyDef def;
  def.shapes = {ShapeDef::hull(*wedge)};  // shared: ten bodies hold one hull
  def.density = 600;
  bool ok = bool(world.create_body(floor));
  std::vector<BodyId> ids;
  for (int i = 0; i < 10 && ok; i++) {
    // a body's frame is the hull's own; its frame() puts the points where they were given
    def.pose = {wedge->frame().position + Vec3{0, 0.5 + 1.5 * i, 0.1 * i}, wedge->frame().orientation};
    const auto id = world.create_body(def);
    ok = bool(id);
    if (id) ids.push_back(*id);
  }
  Stepper stepper;
  for (int step = 0; step < 600 && ok; step++) ok = bool(stepper.step(world, 1.0 / 60));
  double lowest = 1e9, fastest = 0;
  for (BodyId id : ids) {
    const Pose pose = *world.pose(id);
    for (const Vec3& v : wedge->vertices()) lowest = std::fmin(lowest, transform(pose, v).y);
    fastest = std::fmax(fastest, length(*world.velocity(id)));
  }
  std::printf("ten wedges of %.0f kg: lowest corner %.4f m, fastest %.4f m/s\n", world.mass_properties(ids[0])->mass,
              lowest, fastest);

  const auto flat = make_hull(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}});
  std::puts(flat.error().message.c_str());
  return ok && wedge->vertices().size() == 6 && wedge->face_count() == 5 && lowest > -0.02 && fastest < 0.05 ? 0 : 1;
}
