// Bodies slid, rolled and thrown over what floors are made of: coplanar tiles, stairs, posts, compounds.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "wild/families/common.h"

namespace pcphys::wild {
namespace {

using std::numbers::pi;

/// A row or a square of equal tiles with their tops at y = 0, beginning at x = -1 m: bodies of their own, or one
/// compound.
struct Tiles {
  double length, width;  // of the whole [m]
  double tile;           // of one [m]
  bool compound;
  Material material;

  void build(Builder& b) const {
    constexpr double thick = 0.25;
    const int along = std::max(1, int(std::ceil(length / tile))), across = std::max(1, int(std::ceil(width / tile)));
    BodyDef whole = fixed_box({}, {}, material);
    whole.shapes.clear();
    for (int i = 0; i < along; i++)
      for (int j = 0; j < across; j++) {
        const Vec3 centre{-1 + (i + 0.5) * tile, -thick, (j + 0.5 - 0.5 * across) * tile};
        const Vec3 half{0.5 * tile, thick, 0.5 * tile};
        if (!compound) b.add(fixed_box(centre, half, material));
        ShapeDef shape = ShapeDef::box(half);
        shape.local.position = centre;
        whole.shapes.push_back(shape);
      }
    if (compound) b.add(std::move(whole));
  }
};

/// The outward normal of a face of a hull over which its centre of mass stands, so that it can lie on it.
Vec3 resting_normal(const Hull& hull) {
  Vec3 best{0, -1, 0};
  double nearest = 1e30;
  for (std::size_t i = 0; i < hull.face_count(); i++) {
    const auto face = hull.face(i);
    const Vec3 a = hull.vertices()[face[0]], b = hull.vertices()[face[1]], c = hull.vertices()[face[2]];
    const Vec3 across = cross(b - a, c - a), n = across * (1 / length(across));
    const double distance = dot(n, a);
    if (distance >= nearest) continue;
    nearest = distance;
    best = n;
  }
  return best;
}

/// A pose in which the shape lies still on y = 0, above the origin, turned about the vertical at random.
Pose lying(Dice& dice, const ShapeDef& shape) {
  Quat q;
  if (shape.kind == ShapeKind::capsule) q = axis_angle({0, 0, 1}, 0.5 * pi);
  if (shape.kind == ShapeKind::cylinder && dice.chance(0.5)) q = axis_angle({0, 0, 1}, 0.5 * pi);
  if (shape.kind == ShapeKind::hull) q = turned(resting_normal(shape.convex), {0, -1, 0});
  q = axis_angle({0, 1, 0}, dice.between(0, 2 * pi)) * q;
  return {{0, extent_along(shape, q, {0, -1, 0}), 0}, q};
}

/// What glides over frictionless tiles keeps its speed.
void draw_glide(Builder& b) {
  Dice& dice = b.dice;
  const double dt = set_pace(b), speed = dice.by_ratio(0.3, 20), radius = dice.by_ratio(0.05, 0.6);
  const int steps = 60 + dice.one_of(60);
  Material smooth;
  smooth.static_friction = smooth.kinetic_friction = 0;
  const double way = std::min(speed * dt * steps, 30.0);
  const double tile = std::max(dice.by_ratio(0.3, 3) * radius, way / 50);
  Tiles{way + 3, std::max(4 * radius, tile), tile, dice.chance(0.3), smooth}.build(b);
  BodyDef def;
  def.shapes = {random_shape(dice, radius)};
  def.pose = lying(dice, def.shapes[0]);
  def.pose.position.z = dice.between(-0.3, 0.3) * radius;
  def.material = smooth;
  def.velocity = {speed, 0, 0};
  b.scene.rules.gliding = {b.add(std::move(def))};
  b.scene.rules.rests = true;
  b.steps(std::max(10, int(way / (speed * dt))), dt);
}

/// A body of one random shape, or a compound of two to four.
BodyDef thrown_body(Dice& dice, double radius) {
  BodyDef def = loose_body(dice, radius);
  if (!dice.chance(0.3)) return def;
  const int parts = 2 + dice.one_of(3);
  def.shapes.clear();
  for (int i = 0; i < parts; i++) {
    ShapeDef part = random_shape(dice, 0.6 * radius);
    part.local = {dice.direction() * (0.5 * radius), dice.orientation()};
    def.shapes.push_back(part);
  }
  (void)make_compound(def);
  return def;
}

/// A few bodies thrown over what stands from x = -1 to `length`.
void throw_bodies(Builder& b, double highest, double length, double dt) {
  Dice& dice = b.dice;
  const int count = 1 + dice.one_of(4), steps = 60 + dice.one_of(120);
  double fastest = 0;
  for (int i = 0; i < count; i++) {
    const double radius = dice.by_ratio(0.05, 0.4), speed = dice.by_ratio(0.3, 20);
    BodyDef def = thrown_body(dice, radius);
    def.pose.position = {-0.5 - 1.2 * i, highest + 1.1 * radius + dice.by_ratio(0.01, 1), dice.between(-0.4, 0.4)};
    def.velocity = Vec3{1, dice.between(-0.6, 0.1), dice.between(-0.1, 0.1)} * speed;
    if (dice.chance(0.6)) def.angular_velocity = random_vector(dice, 0.1, 2 * speed / radius);
    fastest = std::max(fastest, speed);
    b.add(std::move(def));
  }
  bound(b, {}, length + 6, fastest, steps * dt);
  b.steps(steps, dt);
}

void draw_thrown(Builder& b) {
  const double dt = set_pace(b), tile = b.dice.by_ratio(0.25, 2);
  const double length = std::min(30 * tile, 12.0);
  Tiles{length, std::min(6 * tile, 4.0), tile, b.dice.chance(0.3), random_material(b.dice)}.build(b);
  throw_bodies(b, 0, length, dt);
}

/// A sphere, capsule or cylinder that rolls as it slides.
void draw_rolled(Builder& b) {
  Dice& dice = b.dice;
  const double dt = set_pace(b), radius = dice.by_ratio(0.05, 0.5), speed = dice.by_ratio(0.3, 10);
  const int steps = 60 + dice.one_of(120);
  const double way = std::min(speed * dt * steps, 30.0), tile = std::max(dice.by_ratio(0.3, 4) * radius, way / 50);
  Material material = random_material(dice);
  material.restitution = 0;
  Tiles{way + 3, std::max(4 * radius, tile), tile, dice.chance(0.3), material}.build(b);
  constexpr ShapeKind round[] = {ShapeKind::sphere, ShapeKind::capsule, ShapeKind::cylinder};
  BodyDef def;
  def.shapes = {random_shape(dice, round[dice.one_of(3)], radius)};
  def.material = material;
  const double thick = def.shapes[0].size.x;
  def.pose = {{0, thick, 0}, axis_angle({1, 0, 0}, 0.5 * pi)};  // the axis lies across the way
  def.velocity = {speed, 0, 0};
  def.angular_velocity = {0, 0, -speed / thick};
  b.add(std::move(def));
  bound(b, {}, way + 3, speed, steps * dt);
  b.steps(std::max(10, int(way / (speed * dt))), dt);
}

void draw_stairs(Builder& b) {
  Dice& dice = b.dice;
  const double dt = set_pace(b), deep = dice.between(0.2, 0.5), high = dice.between(0.1, 0.3);
  const int count = 6 + dice.one_of(14);
  const Material material = random_material(dice);
  for (int i = 0; i < count; i++)
    b.add(fixed_box({(i + 0.5) * deep, -0.5 - i * high, 0}, {0.5 * deep, 0.5, 2}, material));
  b.add(fixed_box({-3, -0.5, 0}, {3, 0.5, 2}, material));
  b.add(fixed_box({count * deep + 10, -0.5 - count * high, 0}, {10, 0.5, 2}, material));
  throw_bodies(b, 0, count * deep, dt);
}

void draw_posts(Builder& b) {
  Dice& dice = b.dice;
  const double dt = set_pace(b), pitch = dice.between(0.3, 1);
  const Material material = random_material(dice);
  b.add(fixed_box({0, -0.5, 0}, {30, 0.5, 5}, material));
  for (int i = 0; i < 8; i++)
    for (int j = -2; j <= 2; j++) {
      BodyDef post = fixed_box({1 + i * pitch, 0.5, (j + 0.5 * (i % 2)) * pitch}, {0.03, 0.5, 0.03}, material);
      if (dice.chance(0.4)) post.shapes = {ShapeDef::capsule(0.04, 0.5)};
      post.pose.orientation = axis_angle({0, 1, 0}, dice.between(0, pi));
      b.add(std::move(post));
    }
  throw_bodies(b, 0, 8 * pitch, dt);
}

}  // namespace

void draw_floor(Builder& b) {
  constexpr void (*kinds[])(Builder&) = {draw_glide, draw_glide, draw_thrown, draw_rolled, draw_stairs, draw_posts};
  kinds[b.dice.one_of(6)](b);
}

}  // namespace pcphys::wild
