// What was built to stand: stacks, walls, slender boxes, loads on small bodies; under steps that change, nudges and
// couples.
#include <algorithm>
#include <cmath>

#include "wild/families/common.h"

namespace pcphys::wild {
namespace {

constexpr double topples = 0.25;  // a body that moved by this share of its size does not stand

BodyDef box_at(Vec3 centre, Vec3 half, double density, const Material& material) {
  BodyDef def;
  def.shapes = {ShapeDef::box(half)};
  def.pose.position = centre;
  def.density = density;
  def.material = material;
  return def;
}

Material rough(Dice& dice) {
  Material m;
  m.static_friction = m.kinetic_friction = dice.between(0.4, 1);
  return m;
}

/// Steps of one length, or of two in turns, or any between 1/144 and 1/30 s.
void step_on(Builder& b, int count, double dt) {
  const int how = b.dice.one_of(3);
  if (how == 0) return b.steps(count, dt);
  for (int i = 0; i < count; i++)
    b.steps(1, how == 1 ? (i % 2 ? 1.0 / 30 : 1.0 / 60) : b.dice.between(1.0 / 144, 1.0 / 30));
}

/// Boxes of one size on each other, a little off the middle.
void draw_stack(Builder& b) {
  Dice& dice = b.dice;
  const int count = 2 + dice.one_of(dice.chance(0.2) ? 29 : 11);
  const double size = dice.by_ratio(0.1, 2), dt = set_pace(b);
  const Vec3 half{0.5 * size, 0.5 * size * dice.between(0.4, 1), 0.5 * size * dice.between(0.7, 1)};
  const Material material = rough(dice);
  add_floor(b, material);
  for (int i = 0; i < count; i++) {
    const Vec3 off{dice.between(-0.02, 0.02) * size, 0, dice.between(-0.02, 0.02) * size};
    b.add(box_at(Vec3{0, (2 * i + 1) * half.y, 0} + off, half, 500, material));
  }
  b.scene.rules.stands_within = topples * size;
  b.scene.rules.rests = true;
  step_on(b, 60 + dice.one_of(180), dt);
}

/// A wall of rows that are each one box shorter.
void draw_pyramid(Builder& b) {
  Dice& dice = b.dice;
  const int rows = 3 + dice.one_of(dice.chance(0.1) ? 22 : 8);
  const double size = dice.by_ratio(0.1, 1), dt = set_pace(b), gap = 1.02;
  const Material material = rough(dice);
  add_floor(b, material);
  const Vec3 half{0.5 * size, 0.5 * size, 0.5 * size};
  for (int i = 0; i < rows; i++)
    for (int j = 0; j < rows - i; j++)
      b.add(box_at({(j - 0.5 * (rows - i - 1)) * gap * size, (i + 0.5) * size, 0}, half, 500, material));
  b.scene.rules.stands_within = topples * size;
  b.scene.rules.rests = true;
  step_on(b, std::clamp(12000 / (rows * rows), 40, 200), dt);
}

/// A slender box that is nudged, or that a couple would tip if it were stronger.
void draw_slender(Builder& b) {
  Dice& dice = b.dice;
  const double height = dice.by_ratio(0.3, 3), width = height * dice.between(0.08, 0.3), dt = set_pace(b);
  const Material material = rough(dice);
  add_floor(b, material);
  BodyDef def = box_at({0, 0.5 * height, 0}, {0.5 * width, 0.5 * height, 0.5 * width}, 700, material);
  const double weight = mass_of(def) * earth;
  const int box = b.add(std::move(def));
  if (dice.chance(0.5))
    b.add(box, Wrench{{}, Vec3{0, 0, 1} * (dice.between(0.05, 0.4) * 0.5 * width * weight)});
  else
    b.call(SetVelocity{box, {}, {0, 0, dice.between(0.05, 0.3) * width / height * std::sqrt(earth / height)}});
  b.scene.rules.stands_within = 0.5 * height;
  b.scene.rules.rests = true;
  b.steps(240, dt);
}

/// Boxes that get heavier upwards, up to a thousandfold.
void draw_loaded(Builder& b) {
  Dice& dice = b.dice;
  const int count = 2 + dice.one_of(5);
  const double size = dice.by_ratio(0.2, 1), dt = set_pace(b), ratio = dice.by_ratio(1, 1000);
  const Material material = rough(dice);
  add_floor(b, material);
  for (int i = 0; i < count; i++) {
    const double density = 200 * std::pow(ratio, double(i) / (count - 1));
    b.add(box_at({0, (i + 0.5) * size, 0}, {0.5 * size, 0.5 * size, 0.5 * size}, density, material));
  }
  b.scene.rules.stands_within = topples * size;
  b.scene.rules.rests = true;
  step_on(b, 60 + dice.one_of(120), dt);
}

/// Dominoes in a row, of which the first is pushed over.
void draw_dominoes(Builder& b) {
  Dice& dice = b.dice;
  const int count = 5 + dice.one_of(25);
  const double height = dice.by_ratio(0.05, 1), thick = height * dice.between(0.08, 0.2), dt = set_pace(b);
  const double pitch = thick + height * dice.between(0.2, 0.7);
  const Material material = rough(dice);
  add_floor(b, material);
  for (int i = 0; i < count; i++)
    b.add(box_at({i * pitch, 0.5 * height, 0}, {0.5 * thick, 0.5 * height, 0.25 * height}, 700, material));
  const int first = b.bodies() - count;
  b.call(SetVelocity{first, {0.5 * std::sqrt(earth * height), 0, 0}, {0, 0, -std::sqrt(earth / height)}});
  b.steps(std::clamp(int(count * std::sqrt(height) / (4 * dt)), 40, 300), dt);
}

/// A plank on a roller, a load on one end, and a weight that falls on the other.
void draw_seesaw(Builder& b) {
  Dice& dice = b.dice;
  const double half = dice.between(0.8, 2), thick = 0.05 * half, radius = dice.between(0.1, 0.3), dt = set_pace(b);
  const Material material = rough(dice);
  add_floor(b, material);
  b.add(fixed_box({0, 0.5 * radius, 0}, {0.04, 0.5 * radius, 0.5}, material));
  b.add(box_at({0, radius + thick, 0}, {half, thick, 0.3}, 500, material));
  const double load = dice.between(0.1, 0.2), weight = dice.between(0.15, 0.4);
  b.add(box_at({-0.85 * half, radius + 2 * thick + load, 0}, {load, load, load}, 300, material));
  b.add(box_at({0.85 * half, radius + 2 * thick + weight + dice.between(0.5, 3), 0}, {weight, weight, weight}, 1500,
               material));
  bound(b, {}, half, 15, 2);
  b.steps(120, dt);
}

}  // namespace

void draw_tower(Builder& b) {
  constexpr void (*kinds[])(Builder&) = {draw_stack,  draw_pyramid,  draw_slender,
                                         draw_loaded, draw_dominoes, draw_seesaw};
  kinds[b.dice.one_of(6)](b);
}

}  // namespace pcphys::wild
