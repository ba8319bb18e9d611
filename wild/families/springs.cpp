// Springs between points, from soft to far stiffer than a sub-step resolves, several on a body and in loops.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>
#include <vector>

#include "wild/families/common.h"
#include "wild/scene.h"
#include "wild/shapes.h"

namespace pcphys::wild {
namespace {

using std::numbers::pi;

/// Of all springs of a scene.
struct Law {
  double softest, stiffest;  // [N/m]
  double damping;            // largest share of the critical damping of the two masses
  double stretch;            // most by which a length at the start differs from the rest length, as a share of it
  bool to_nothing;           // rest lengths are zero
};

Law random_law(Dice& dice) {
  Law law{};
  law.softest = dice.by_ratio(1, 1e9);
  law.stiffest = dice.chance(0.5) ? law.softest : std::max(law.softest, dice.by_ratio(1, 1e9));
  law.damping = dice.chance(0.4) ? 0 : dice.between(0, 2);
  law.stretch = dice.chance(0.4) ? 0 : dice.by_ratio(1e-3, 0.5);
  law.to_nothing = dice.chance(0.07);
  return law;
}

/// Bodies with points that springs hold on to.
struct Web {
  Builder& b;
  Law law;
  struct Knot {
    int body;
    Pose pose;
    double radius, mass;
  };
  std::vector<Knot> knots = {};

  /// Answers with the index of the knot.
  int add(BodyDef def, double radius) {
    const double mass = def.kind == BodyKind::dynamic ? mass_of(def) : 1e30;
    const Pose pose = def.pose;
    knots.push_back({b.add(std::move(def)), pose, radius, mass});
    return int(knots.size()) - 1;
  }
  /// A body of any shape that nothing collides with, of 1 g to 1 t if it is not to be as heavy as others.
  int add(Vec3 place, double radius, double mass, Vec3 velocity = {}) {
    BodyDef def = loose_body(b.dice, radius);
    def.pose.position = place;
    def.mass = mass;
    def.velocity = velocity;
    pass_through(def);
    return add(std::move(def), radius);
  }
  int add_ground() {
    knots.push_back({ground, {}, 0, 1e30});
    return int(knots.size()) - 1;
  }
  /// A point of a body: its centre, or one within it.
  Vec3 point_of(const Knot& knot, bool centred) {
    return centred ? Vec3{} : random_vector(b.dice, 0.1, 1) * knot.radius;
  }

  void join(int i, int k, bool centred) {
    const Vec3 at = point_of(knots[std::size_t(i)], centred);
    join_at(i, k, at, point_of(knots[std::size_t(k)], centred));
  }
  /// Of the anchors each is in its body's frame.
  void join_at(int i, int k, Vec3 at, Vec3 other) {
    const Knot &one = knots[std::size_t(i)], &two = knots[std::size_t(k)];
    SpringDef def;
    def.anchor_a = at;
    def.anchor_b = other;
    const double apart = length(transform(one.pose, at) - transform(two.pose, other));
    const double stretch = b.dice.between(-law.stretch, law.stretch);
    def.rest_length = law.to_nothing ? 0 : apart / (1 + stretch);
    def.stiffness = b.dice.by_ratio(law.softest, law.stiffest * 1.0001);
    const double mass = one.mass * two.mass / (one.mass + two.mass);
    def.damping = law.damping * b.dice.between(0, 2) * std::sqrt(def.stiffness * mass);
    b.add(one.body, two.body, def);
  }
  void join_to_ground(int i, int earth_knot, Vec3 place) {
    join_at(earth_knot, i, place, point_of(knots[std::size_t(i)], b.dice.chance(0.5)));
  }
};

/// Of a scene that may be without gravity and without anything fixed: then its momentum is kept.
bool set_free(Builder& b) {
  const bool free = b.dice.chance(0.45);
  if (free) b.scene.world.gravity = {};
  return free;
}

void play(Builder& b, int body_steps) {
  const double dt = set_pace(b);
  b.steps(affordable_steps(b.dice, b.bodies() + b.springs() / 4, body_steps), dt);
}

/// Bodies in a cloud with springs between any two of them.
void draw_web(Builder& b) {
  Dice& dice = b.dice;
  const bool free = set_free(b);
  Web web{b, random_law(dice)};
  const int bodies = 2 + dice.one_of(29);
  const double size = dice.by_ratio(0.3, 3), ratio = dice.chance(0.4) ? 1 : dice.by_ratio(1, 1e6);
  const double mass = dice.by_ratio(1e-3, 1e3), speed = dice.chance(0.4) ? 0 : dice.by_ratio(0.01, 30);
  for (int i = 0; i < bodies; i++) {
    const Vec3 place = random_vector(dice, 0.1, 1) * size;
    const Vec3 velocity = dice.direction() * speed;
    web.add(place, 0.1 * size, mass * (ratio > 1 ? dice.by_ratio(1 / std::sqrt(ratio), std::sqrt(ratio)) : 1),
            velocity);
  }
  const bool centred = dice.chance(0.3);
  const int springs = bodies - 1 + dice.one_of(2 * bodies);
  for (int i = 0; i < springs; i++) {
    const int one = dice.one_of(bodies), other = (one + 1 + dice.one_of(bodies - 1)) % bodies;
    web.join(one, other, centred);
  }
  const int earth_knot = free ? -1 : web.add_ground();
  const int held = free ? 0 : dice.one_of(5);
  for (int i = 0; i < held; i++) {
    const int knot = dice.one_of(bodies);
    web.join_to_ground(knot, earth_knot, random_vector(dice, 0.5, 2) * size);
  }
  play(b, 5000);
}

/// Equal balls in a cubic grid with springs at rest between all neighbours, dropped, thrown or spun.
void draw_lattice(Builder& b) {
  Dice& dice = b.dice;
  const bool free = set_free(b);
  Web web{b, random_law(dice)};
  if (dice.chance(0.7)) web.law.stretch = 0;
  const int side = dice.chance(0.7) ? 3 : 2 + dice.one_of(3);
  const double pitch = dice.by_ratio(0.05, 0.5), mass = dice.by_ratio(0.01, 10), bottom = dice.between(0.2, 2);
  const Vec3 spin = free ? random_vector(dice, 0.1, 10) : Vec3{};
  const Material material = random_material(dice);
  for (int n = 0; n < side * side * side; n++) {
    BodyDef ball;
    ball.shapes = {ShapeDef::sphere(0.3 * pitch)};
    ball.mass = mass;
    ball.material = material;
    const int i = n / (side * side), j = n / side % side, k = n % side;
    ball.pose.position = Vec3{i * pitch, bottom + j * pitch, k * pitch};
    ball.velocity = cross(spin, ball.pose.position);
    ball.angular_velocity = spin;
    web.add(std::move(ball), 0.3 * pitch);
  }
  for (int n = 0; n < side * side * side; n++)
    for (int m = n + 1; m < side * side * side; m++) {
      const int di = m / (side * side) - n / (side * side), dj = m / side % side - n / side % side,
                dk = m % side - n % side;
      if (std::max({std::abs(di), std::abs(dj), std::abs(dk)}) == 1) web.join(n, m, true);
    }
  if (!free) add_floor(b, material);
  play(b, 6000);
}

/// A row of bodies between springs, dragged by a body that moves as it is told.
void draw_dragged_chain(Builder& b) {
  Dice& dice = b.dice;
  if (dice.chance(0.4)) b.scene.world.gravity = {};
  Web web{b, random_law(dice)};
  const int bodies = 2 + dice.one_of(39);
  const double pitch = dice.by_ratio(0.1, 1), mass = dice.by_ratio(0.01, 10),
               ratio = dice.chance(0.5) ? 1 : dice.by_ratio(1, 1e3);
  const Vec3 along = dice.chance(0.5) ? Vec3{0, -1, 0} : dice.direction();
  const int hand = add_hand(b, {});
  web.knots.push_back({hand, {}, 0, 1e30});
  for (int i = 1; i <= bodies; i++) {
    const double share = ratio > 1 ? dice.by_ratio(1, ratio) : 1;
    web.add(along * (i * pitch), 0.3 * pitch, mass * share);
    web.join(i - 1, i, dice.chance(0.5));
  }
  const double dt = set_pace(b), speed = dice.by_ratio(0.1, 50);
  const int steps = affordable_steps(dice, bodies, 4000);
  lead(b, hand, steps, dt, speed, 0);
}

/// Each body on one or several springs to points of the world.
void draw_hung(Builder& b) {
  Dice& dice = b.dice;
  if (dice.chance(0.3)) b.scene.world.gravity = {};
  Web web{b, random_law(dice)};
  const int bodies = 2 + dice.one_of(14);
  const double ratio = dice.by_ratio(1, 1e6), mass = dice.by_ratio(1e-3, 10);
  const int earth_knot = web.add_ground();
  for (int i = 0; i < bodies; i++) {
    const Vec3 place{2.0 * i, 0, 0};
    const Vec3 velocity = random_vector(dice, 0.01, 10);
    const double radius = dice.by_ratio(0.05, 0.5);
    const int knot = web.add(place, radius, mass * dice.by_ratio(1, ratio), velocity);
    const int springs = 1 + dice.one_of(6);
    for (int k = 0; k < springs; k++) web.join_to_ground(knot, earth_knot, place + random_vector(dice, 0.5, 3));
    if (i > 0 && dice.chance(0.3)) web.join(knot - 1, knot, false);
  }
  play(b, 4000);
}

/// Bodies that collide, in a room, with springs between them.
void draw_in_room(Builder& b) {
  Dice& dice = b.dice;
  const Room room{dice.between(2, 4), dice.between(2, 5), random_material(dice)};
  room.build(b);
  Web web{b, random_law(dice)};
  const int across = 1 + dice.one_of(3), layers = 1 + dice.one_of(3), bodies = across * across * layers + 1;
  const double cell = 0.9 * std::min(2 * room.half / across, room.height / (layers + 1)), ratio = dice.by_ratio(1, 1e4);
  const auto put = [&](int i, int j, int k) {
    const double radius = 0.45 * cell * dice.by_ratio(0.2, 1), middle = 0.5 * (across - 1);
    BodyDef def = loose_body(dice, radius);
    def.mass = mass_of(def) * dice.by_ratio(1, ratio);
    def.pose.position = {(i - middle) * cell, (j + 0.55) * cell, (k - middle) * cell};
    def.velocity = random_vector(dice, 0.01, 5);
    web.add(std::move(def), radius);
  };
  for (int j = 0; j < layers; j++)
    for (int i = 0; i < across * across; i++) put(i / across, j, i % across);
  put(0, layers, 0);
  const int springs = bodies - 1 + dice.one_of(bodies);
  for (int i = 0; i < springs; i++) {
    const int one = dice.one_of(bodies), other = (one + 1 + dice.one_of(bodies - 1)) % bodies;
    web.join(one, other, false);
  }
  play(b, 3000);
}

/// A light body in the middle of many springs to heavier ones.
void draw_star(Builder& b) {
  Dice& dice = b.dice;
  const bool free = set_free(b);
  Web web{b, random_law(dice)};
  const double light = dice.by_ratio(1e-3, 10), ratio = dice.by_ratio(1, 1e6), size = dice.by_ratio(0.2, 2);
  web.add(Vec3{}, 0.2 * size, light, random_vector(dice, 0.01, 10));
  const int rays = 2 + dice.one_of(dice.chance(0.2) ? 59 : 19);
  const bool centred = dice.chance(0.4), linked = dice.chance(0.3);
  for (int i = 0; i < rays; i++) {
    const int end = web.add(dice.direction() * size, 0.1 * size, light * ratio);
    web.join(0, end, centred);
    if (linked && i > 0) web.join(end - 1, end, centred);
  }
  const int earth_knot = free ? -1 : web.add_ground();
  if (!free) web.join_to_ground(1, earth_knot, {0, 2 * size, 0});
  play(b, 4000);
}

/// A ring, which may turn.
void draw_ring(Builder& b) {
  Dice& dice = b.dice;
  const bool free = set_free(b);
  Web web{b, random_law(dice)};
  const int bodies = 3 + dice.one_of(28);
  const double radius = dice.by_ratio(0.2, 3), mass = dice.by_ratio(1e-3, 1e3),
               chord = 2 * radius * std::sin(pi / bodies);
  const double ratio = dice.chance(0.5) ? 1 : dice.by_ratio(1, 1e6);
  const Vec3 spin = dice.chance(0.6) ? random_vector(dice, 0.1, 20) : Vec3{};
  const bool centred = dice.chance(0.5);
  for (int i = 0; i < bodies; i++) {
    const double angle = 2 * pi * i / bodies;
    const Vec3 place = Vec3{std::cos(angle), std::sin(angle), 0} * radius;
    web.add(place, 0.3 * chord, mass * (i % 2 == 0 ? 1 : ratio), cross(spin, place));
    if (i > 0) web.join(i - 1, i, centred);
  }
  web.join(bodies - 1, 0, centred);
  const int earth_knot = free ? -1 : web.add_ground();
  if (!free) web.join_to_ground(0, earth_knot, {2 * radius, radius, 0});
  play(b, 4000);
}

/// Two bodies with many springs from points of the one to points of the other.
void draw_parallel(Builder& b) {
  Dice& dice = b.dice;
  const bool free = set_free(b);
  Web web{b, random_law(dice)};
  const double size = dice.by_ratio(0.1, 1), mass = dice.by_ratio(1e-3, 1e3), ratio = dice.by_ratio(1, 1e6);
  const Vec3 velocity = random_vector(dice, 0.01, 20);
  const double distance =
      dice.chance(0.2) ? 0 : dice.by_ratio(0.1, 10);  // of centres; their springs may begin without a length
  web.add(Vec3{}, size, mass, velocity);
  web.add(Vec3{1, 0, 0} * (distance * size), size, mass * ratio);
  const int springs = 1 + dice.one_of(30);
  for (int i = 0; i < springs; i++) web.join(0, 1, dice.chance(0.1));
  const int earth_knot = free ? -1 : web.add_ground();
  if (!free) web.join_to_ground(1, earth_knot, {0, 2 * size, 0});
  play(b, 2000);
}

constexpr void (*kinds_of_springs[])(Builder&) = {draw_web,     draw_web,  draw_lattice, draw_dragged_chain, draw_hung,
                                                  draw_in_room, draw_star, draw_ring,    draw_parallel};

}  // namespace

void draw_springs(Builder& b) {
  const int kind = b.dice.one_of(int(std::size(kinds_of_springs)));
  kinds_of_springs[kind](b);
}

}  // namespace pcphys::wild
