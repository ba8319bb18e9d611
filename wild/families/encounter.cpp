// Two bodies of any two shapes meet, graze or miss each other; one of them may stand or be driven.
#include <algorithm>
#include <cmath>

#include "wild/families/common.h"

namespace pcphys::wild {
namespace {

/// Speeds of surfaces that turn, from slow to as fast as the body flies.
Vec3 random_spin(Dice& dice, double speed, double radius) {
  if (dice.chance(0.3)) return {};
  const double fastest = std::min(speed / radius, 300.0);
  return random_vector(dice, 1e-3 * fastest, fastest);
}

}  // namespace

void draw_encounter(Builder& b) {
  Dice& dice = b.dice;
  const double size = dice.by_ratio(0.02, 2), other_size = size * dice.by_ratio(0.1, 10);
  BodyDef target = loose_body(dice, other_size), flier = loose_body(dice, size);
  const double speed = dice.by_ratio(0.1, 300);
  const Vec3 towards = dice.direction();
  // It passes the other's centre at this distance: half of the draws meet, and many graze.
  const double radii = size + other_size, miss = radii * std::sqrt(dice.between(0, 1.1));
  const double dt = random_dt(dice),
               gap = dice.chance(0.5) ? dice.between(0, speed * dt) : dice.between(0, 0.5 * radii);
  flier.pose.position = towards * -(radii + gap) + square_to(dice, towards) * miss;
  flier.velocity = towards * speed;
  flier.angular_velocity = random_spin(dice, speed, size);

  const int role = dice.one_of(4);  // of the other: stands, is driven, or is as free
  target.kind = role == 0 ? BodyKind::fixed : role == 1 ? BodyKind::kinematic : BodyKind::dynamic;
  if (role == 1) {
    target.velocity = random_vector(dice, 0.01 * speed, 0.5 * speed);
    if (dice.chance(0.5)) target.angular_velocity = random_spin(dice, speed, other_size);
    flier.velocity = flier.velocity + target.velocity;
  }
  if (role == 3) target.angular_velocity = random_spin(dice, speed, other_size);
  if (dice.chance(0.5)) b.scene.world.gravity = {};
  b.scene.settings.substeps = dice.chance(0.7) ? 4 : 1u << dice.one_of(6);
  b.scene.rules.single_encounter = true;
  b.add(std::move(target));
  b.add(std::move(flier));
  const double seconds = (3 * radii + gap) / speed;
  b.steps(std::clamp(int(seconds / dt), 8, 40), dt);
}

}  // namespace pcphys::wild
