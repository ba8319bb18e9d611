// Free-swinging doors (section 9 of the original): each hangs on a hinge along its left edge and is hit by a
// ball near its right one. The first ball has fixed numbers, the others vary.
#include <numbers>

#include "builder.h"

namespace pcphys::scenes {

void build_door(Builder& builder) {
  const Vec3 half{0.45, 1.0, 0.03};
  const double clearance = 0.02;  // under the door [m]
  builder.set_material(0.5, 0.4);
  builder.add_floor();
  Random random = builder.random(2024);
  const Quat hinge_axes = axis_angle({0, 0, 1}, 0.5 * std::numbers::pi);  // x axis upwards
  for (int i = 0; i < builder.scene().count; ++i) {
    const Vec3 place{2.0 * (i % 40), half.y + clearance, -2.5 * (i / 40)};
    BodyDef door;
    door.shapes = {ShapeDef::box(half)};
    door.density = 600;  // wood
    door.pose.position = place;
    door.angular_drag = 0.1;
    const int body = builder.add(door);

    JointDef hinge;
    hinge.a = builder.world().ground();
    hinge.b = builder.id(body);
    hinge.frame_a = {place + Vec3{-half.x, 0, 0}, hinge_axes};
    hinge.frame_b = {{-half.x, 0, 0}, hinge_axes};
    hinge.freedom = AngleFreedom::hinge();
    builder.add_joint(hinge);

    const double speed = i == 0 ? 6.0 : random.between(3.0, 8.0);
    const double height = i == 0 ? 0.2 : random.between(0.0, 0.4);
    BodyDef ball;
    ball.shapes = {ShapeDef::sphere(0.15)};
    ball.density = 400;
    ball.pose.position = place + Vec3{0.3, height, 1.0};
    ball.velocity = {0, 0, -speed};
    builder.add(ball);
  }
}

}  // namespace pcphys::scenes
