// A body passes another with a clearance of 0.1 to 100 mm: what does not touch keeps its velocity.
#include <algorithm>
#include <cmath>

#include "wild/families/common.h"

namespace pcphys::wild {

void draw_passing(Builder& b) {
  Dice& dice = b.dice;
  BodyDef obstacle, flier;
  const double size = dice.by_ratio(0.05, 1), other_size = dice.by_ratio(0.05, 5);
  obstacle.shapes = {random_shape(dice, other_size)};
  flier.shapes = {random_shape(dice, size)};
  obstacle.pose.orientation = dice.chance(0.3) ? Quat{} : dice.orientation();
  flier.pose.orientation = dice.chance(0.3) ? Quat{} : dice.orientation();
  obstacle.kind = dice.chance(0.6) ? BodyKind::fixed : BodyKind::dynamic;
  obstacle.material = random_material(dice);
  flier.material = random_material(dice);

  // The two stand on either side of a plane with this clearance between them, and the flier moves along that plane.
  const Vec3 apart = dice.chance(0.3) ? Vec3{0, 1, 0} : dice.direction();
  const Vec3 along = square_to(dice, apart);
  const double clearance = dice.by_ratio(1e-4, 0.1);
  // A body that spins is as large in all directions as its outer sphere.
  const bool spins = dice.chance(0.4);
  const double flier_extent =
      spins ? outer_radius(flier.shapes[0]) : extent_along(flier.shapes[0], flier.pose.orientation, -apart);
  const double height = extent_along(obstacle.shapes[0], obstacle.pose.orientation, apart) + clearance + flier_extent;
  const double speed = dice.by_ratio(0.1, 300), reach = size + other_size, dt = random_dt(dice);
  const double before = dice.between(0.2, 1) * std::max(reach, 2 * speed * dt);
  flier.pose.position = apart * height + along * -before;
  flier.velocity = along * speed;
  if (spins) flier.angular_velocity = random_vector(dice, 0.1, 100);
  b.scene.world.gravity = {};
  b.scene.settings.substeps = dice.chance(0.7) ? 4 : 1u << dice.one_of(6);
  const int standing = b.add(std::move(obstacle)), passing = b.add(std::move(flier));
  b.scene.rules.untouched = {standing, passing};
  b.scene.rules.single_encounter = true;
  b.steps(std::clamp(int((before + 1.5 * reach) / (speed * dt)), 4, 60), dt);
}

}  // namespace pcphys::wild
