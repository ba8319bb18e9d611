// Magnetic balls in the open-lidded box: like poles push each other, unlike ones pull. The force is a kernel, the pole
// a property of the scene's own.
#include "builder.h"
#include "examples/magnet.h"

namespace pcphys::scenes {

void build_magnets(Builder& builder) {
  constexpr double radius = 0.15, spacing = 0.5;  // [m]
  constexpr int side = 6;
  const int count = builder.scene().count;
  World& world = builder.world();
  builder.set_material(0.3, 0.2);
  builder.add_open_box(side * spacing, 1 + spacing * (count / (side * side)) + 20);
  const auto pole = world.add_property<Real>("pole", 0, "A m", body_table, Role::input);
  if (!pole) return builder.fail(pole.error());
  Random random = builder.random(2026);
  for (int i = 0; i < count; ++i) {
    const int layer = i / (side * side), row = i / side % side, column = i % side;
    BodyDef def;
    def.shapes = {ShapeDef::sphere(radius)};
    def.pose.position = spacing * Vec3{column - 0.5 * (side - 1), 0, row - 0.5 * (side - 1)};
    def.pose.position.y = 0.5 + spacing * layer;
    def.velocity = {random.between(-1, 1), 0, random.between(-1, 1)};
    const int body = builder.add(def);
    if (body < 0) return;
    if (const Status ok = world.set(*pole, builder.id(body), Real((row + column + layer) % 2 ? -1 : 1)); !ok)
      return builder.fail(ok.error());
  }
  // (a minus: unlike poles pull)
  builder.scene().kernels.push_back({.text = magnet::text(), .parameters = {{"strength", -60.0}, {"softening", 0.02}}});
}

}  // namespace pcphys::scenes
