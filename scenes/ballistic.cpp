// Balls in free fall that no other can meet: what a world costs in which nothing acts between bodies.
#include <algorithm>
#include <cmath>

#include "builder.h"

namespace pcphys::scenes {

void build_ballistic(Builder& builder) {
  constexpr double spacing = 2;  // of the lattice that they start on [m]
  const int count = builder.scene().count, side = std::max(1, int(std::ceil(std::cbrt(double(count)))));
  Random random = builder.random(2023);
  const auto draw = [&random](double most) {
    const double x = random.between(-most, most), y = random.between(-most, most), z = random.between(-most, most);
    return Vec3{x, y, z};
  };
  for (int i = 0; i < count; ++i) {
    BodyDef def;
    def.shapes = {ShapeDef::sphere(random.between(0.1, 0.5))};
    def.shapes[0].filter.mask = 0;  // meets nothing
    def.pose.position = spacing * Vec3{double(i % side), double(i / side % side), double(i / side / side)};
    def.velocity = draw(5);
    def.angular_velocity = draw(10);
    builder.add(def);
  }
}

}  // namespace pcphys::scenes
