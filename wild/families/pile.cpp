// Piles of mixed shapes, sizes up to 1:50 and masses up to 1:1e4: dropped, thrown, or made where others are already.
#include <algorithm>
#include <cmath>

#include "wild/families/common.h"

namespace pcphys::wild {
namespace {

struct Mix {
  double smallest, largest;   // radii [m]
  double lightest, heaviest;  // densities [kg/m^3]
  Material material;
};

Mix random_mix(Dice& dice) {
  const double largest = dice.by_ratio(0.1, 1), lightest = dice.by_ratio(50, 1000);
  const double sizes = dice.chance(0.3) ? 1 : dice.by_ratio(1, 50),
               densities = dice.chance(0.5) ? 1 : dice.by_ratio(1, 100);
  return {largest / sizes, largest, lightest, lightest * densities, random_material(dice)};
}

/// Masses within 1:1e4 of the heaviest that could come.
BodyDef mixed_body(Dice& dice, const Mix& mix) {
  const double radius = mix.smallest < mix.largest ? dice.by_ratio(mix.smallest, mix.largest) : mix.largest;
  BodyDef def = loose_body(dice, radius);
  def.density = mix.lightest < mix.heaviest ? dice.by_ratio(mix.lightest, mix.heaviest) : mix.lightest;
  def.material = mix.material;
  const double heaviest = mix.heaviest * 4 * mix.largest * mix.largest * mix.largest;
  const double own = mass_of(def);
  if (own < 1e-4 * heaviest) def.density *= 1e-4 * heaviest / own;
  return def;
}

void draw_dropped(Builder& b, int count, const Mix& mix, double half, double dt) {
  Dice& dice = b.dice;
  double height = 0;
  const double speed = dice.chance(0.4) ? dice.by_ratio(0.5, 20) : 0;
  for (int i = 0; i < count; i++) {
    BodyDef def = mixed_body(dice, mix);
    const double radius = outer_radius(def.shapes[0]), room = std::max(half - radius, 0.0);
    def.pose.position = {dice.between(-room, room), height + radius, dice.between(-room, room)};
    height += 0.8 * radius + (dice.chance(0.5) ? radius : 0);
    def.velocity = dice.direction() * speed;
    b.add(std::move(def));
  }
  Room{half, height + 6 * mix.largest, mix.material}.build(b);
  b.scene.rules.overlaps = true;
  b.steps(affordable_steps(dice, count, 6000), dt);
}

/// All of them in a small place at once.
void draw_spawned(Builder& b, int count, const Mix& mix, double half, double dt) {
  Dice& dice = b.dice;
  const double cube = dice.by_ratio(0.5, 3) * mix.largest * std::cbrt(double(count));
  for (int i = 0; i < count; i++) {
    BodyDef def = mixed_body(dice, mix);
    const double radius = outer_radius(def.shapes[0]), room = std::max(std::min(cube, half) - radius, 0.0);
    def.pose.position = {dice.between(-room, room), radius + dice.between(0, cube), dice.between(-room, room)};
    b.add(std::move(def));
  }
  // In so narrow a room a push may throw, but never further than it is wide and its speed allows.
  Room{half, 3 * cube + 8 * mix.largest, mix.material}.build(b);
  b.scene.rules.overlaps = true;
  b.steps(affordable_steps(dice, count, 6000), dt);
}

}  // namespace

void draw_pile(Builder& b) {
  Dice& dice = b.dice;
  const double dt = set_pace(b);
  const int count = dice.chance(0.1) ? 60 + dice.one_of(140) : 3 + dice.one_of(50);
  const Mix mix = random_mix(dice);
  const double half = mix.largest * (1.5 + dice.between(0, 1.5) * std::cbrt(double(count)));
  if (dice.chance(0.7))
    draw_dropped(b, count, mix, half, dt);
  else
    draw_spawned(b, count, mix, half, dt);
  b.scene.rules.rests = true;
}

}  // namespace pcphys::wild
