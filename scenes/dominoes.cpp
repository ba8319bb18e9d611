// Dominoes of 1 m along an Archimedean spiral, centre outwards; a ball knocks over the first.
#include <cmath>
#include <numbers>

#include "builder.h"

namespace pcphys::scenes {

void build_dominoes(Builder& builder) {
  const Vec3 half{0.07, 0.5, 0.25};  // x along the row
  const double spacing = 0.45;       // along the row [m]
  const double start_radius = 3.0, turn_width = 2.0;
  const double growth = turn_width / (2 * std::numbers::pi);
  builder.set_material(0.4, 0);
  builder.add_floor();
  double angle = 0;
  for (int i = 0; i < builder.scene().count; ++i) {
    // r = r0 + c a; the row runs along (dr, r da), the local x axis
    const double radius = start_radius + growth * angle;
    const Vec3 outward{std::cos(angle), 0, std::sin(angle)}, around{-std::sin(angle), 0, std::cos(angle)};
    const double run = std::sqrt(radius * radius + growth * growth);
    const Vec3 along = (1 / run) * (growth * outward + radius * around);
    BodyDef def;
    def.shapes = {ShapeDef::box(half)};
    def.density = 500;
    def.pose.position = radius * outward + Vec3{0, half.y, 0};
    def.pose.orientation = axis_angle({0, 1, 0}, std::atan2(-along.z, along.x));
    builder.add(def);
    if (i == 0) {
      BodyDef ball;
      ball.shapes = {ShapeDef::sphere(0.2)};
      ball.pose.position = def.pose.position - 0.6 * along + Vec3{0, 0.25, 0};
      ball.velocity = 3.0 * along;
      builder.add(ball);
    }
    angle += spacing / run;
  }
}

}  // namespace pcphys::scenes
