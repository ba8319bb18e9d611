// Joints of all kinds: trees, ropes, loops, nets, hubs, bridges, carts, and joints that contradict each other.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "wild/families/common.h"
#include "wild/scene.h"
#include "wild/shapes.h"

namespace pcphys::wild {
namespace {

using std::numbers::pi;

/// None, that of the Earth, or any other.
void draw_gravity(Builder& b, double none) {
  if (b.dice.chance(none))
    b.scene.world.gravity = {};
  else if (b.dice.chance(0.2))
    b.scene.world.gravity = random_vector(b.dice, 1, 50);
}

void draw_free_tree(Builder& b) {
  Dice& dice = b.dice;
  Tree tree{b, dice.by_ratio(0.05, 1), random_vector(dice, 0.01, 20), random_vector(dice, 0.1, 20)};
  tree.drives = dice.chance(0.3) ? 0.3 : 0;
  tree.collide = dice.chance(0.5);
  tree.branches = dice.chance(0.7);
  if (dice.chance(0.4)) tree.unruly = dice.by_ratio(0.1, 30);
  if (dice.chance(0.8)) b.scene.world.gravity = {};
  tree.grow(2 + dice.one_of(25));
  const double dt = set_pace(b);
  const int steps = affordable_steps(dice, b.bodies(), 4000);
  bound(b, {}, tree.reach, length(tree.velocity) + length(tree.spin) * tree.reach, steps * dt);
  b.steps(steps, dt);
}

void draw_hung_tree(Builder& b) {
  Dice& dice = b.dice;
  draw_gravity(b, 0.1);
  Tree tree{b, dice.by_ratio(0.05, 1), {}, {}};
  tree.drives = dice.chance(0.4) ? dice.between(0.1, 1) : 0;
  tree.collide = dice.chance(0.5);
  tree.branches = dice.chance(0.7);
  const Vec3 pin{0, tree.size, 0};
  const bool held = dice.chance(0.4);
  const int hand = held ? add_hand(b, pin) : ground;
  tree.grow(1 + dice.one_of(25));
  tree.join(hand, held ? Pose{pin, {}} : Pose{}, tree.nodes[0], pin);
  const double dt = set_pace(b);
  const int steps = affordable_steps(dice, b.bodies(), 4000);
  double way = 0;
  const double spin = dice.chance(0.5) ? dice.by_ratio(0.1, 20) : 0;
  if (held)
    way = lead(b, hand, steps, dt, dice.by_ratio(0.1, 20), spin);
  else
    b.steps(steps, dt);
  b.scene.rules.lower = Vec3{-1, -1, -1} * (1 + way + 1.1 * tree.reach);
  b.scene.rules.upper = -b.scene.rules.lower;
}

Rope random_rope(Builder& b) {
  Dice& dice = b.dice;
  Rope rope{.links = dice.chance(0.4) ? 60 + dice.one_of(91) : int(dice.by_ratio(10, 151)),
            .link = 0,
            .mass = dice.by_ratio(0.01, 10),
            .start = {},
            .along = {1, 0, 0}};
  rope.link = dice.by_ratio(1, 40) / rope.links;
  if (dice.chance(0.5)) rope.load = dice.by_ratio(1, 1e4);
  rope.collide = dice.chance(0.3);
  if (dice.chance(0.2)) rope.damping = rope.mass * rope.link * rope.link * dice.by_ratio(0.01, 10);
  rope.swings_freely = dice.chance(0.8);
  return rope;
}

/// Level, and let go: held at an end, at both, or by a hand.
void draw_held_rope(Builder& b) {
  Dice& dice = b.dice;
  Rope rope = random_rope(b);
  const int holder = dice.one_of(4);  // of the start: the ground, the ground at both ends, a hand, the ground
  // Held at both ends it is a loop, which costs much more.
  if (holder == 1 && dice.chance(0.8)) rope.links = std::min(rope.links, 40);
  if (dice.chance(0.2)) rope.along = dice.direction();
  const int hand = holder == 2 ? add_hand(b, {}) : ground;
  rope.build(b);
  b.add(hand, rope.bodies[0], joint_at({}, rope.poses[0], rope.start));
  if (holder == 1) b.add(ground, rope.bodies.back(), joint_at({}, rope.poses.back(), rope.end()));
  b.scene.rules.joints_may_yield = holder == 1;
  const double dt = set_pace(b);
  const int steps = affordable_steps(dice, rope.links, 8000);
  double way = 0;
  if (hand == ground)
    b.steps(steps, dt);
  else
    way = lead(b, hand, steps, dt, dice.by_ratio(0.1, 20), 0);
  bound(b, {}, rope.links * rope.link + way, 0, 0);
}

/// It falls on a floor 2 m below, or over a post that stands there.
void draw_dropped_rope(Builder& b) {
  Dice& dice = b.dice;
  const Material material = random_material(dice);
  add_floor(b, material);
  Rope rope = random_rope(b);
  rope.collide = true;
  const double length = rope.links * rope.link, thick = (rope.load > 0 ? 0.45 : 0.15) * rope.link;
  const double drop = dice.chance(0.5) ? 2 : dice.by_ratio(0.2, 5), top = dice.chance(0.5) ? dice.between(0.2, 2) : 0;
  rope.start = {-dice.between(0.2, 0.8) * length, top + 1.1 * thick + drop, 0};
  if (top > 0) {
    BodyDef post = fixed_box({0, 0.5 * top, 0}, {0.1, 0.5 * top, 0.5}, material);
    if (dice.chance(0.5)) {
      post.pose = {{0, 0.9 * top, 0}, turned({0, 1, 0}, {0, 0, 1})};
      post.shapes = {ShapeDef::cylinder(0.1 * top, 1)};
    }
    b.add(std::move(post));
  }
  rope.build(b);
  const double dt = set_pace(b);
  const int steps = affordable_steps(dice, rope.links, 8000);
  bound(b, {}, length, std::sqrt(2 * earth * rope.start.y), steps * dt);
  b.scene.rules.lower.y = -1;
  b.steps(steps, dt);
}

void draw_spun_rope(Builder& b) {
  Dice& dice = b.dice;
  b.scene.world.gravity = {};
  Rope rope = random_rope(b);
  rope.along = dice.direction();
  rope.spin = random_vector(dice, 0.1, 30);
  rope.build(b);
  const bool held = dice.chance(0.4);
  if (held) b.add(ground, rope.bodies[0], joint_at({}, rope.poses[0], rope.start));
  const double dt = set_pace(b), length = rope.links * rope.link;
  const int steps = affordable_steps(dice, rope.links, 8000);
  bound(b, {}, length, held ? 0 : pcphys::length(rope.spin) * length, steps * dt);
  b.steps(steps, dt);
}

/// A closed chain of links around a circle, upright.
void draw_loop(Builder& b) {
  Dice& dice = b.dice;
  draw_gravity(b, 0.3);
  const int links = 2 + int(dice.by_ratio(1, 40));
  const double radius = dice.by_ratio(0.2, 5), link = 2 * radius * std::sin(pi / links),
               mass = dice.by_ratio(0.01, 100);
  const bool planar = dice.chance(0.4), collide = dice.chance(0.3), heavy = dice.chance(0.3);
  const Vec3 spin = dice.chance(0.5) ? random_vector(dice, 0.1, 20) : Vec3{};
  const auto corner = [&](int i) {
    return Vec3{std::cos(2 * pi * i / links), std::sin(2 * pi * i / links), 0} * radius;
  };
  std::vector<Pose> poses;
  for (int i = 0; i < links; i++) {
    const Vec3 way = corner(i + 1) - corner(i);
    BodyDef def;
    def.pose = {(corner(i) + corner(i + 1)) * 0.5, turned({0, 1, 0}, way * (1 / link))};
    def.shapes = {ShapeDef::capsule(0.08 * link, 0.35 * link)};
    def.mass = mass * (heavy ? dice.by_ratio(1, 1e3) : 1);
    def.velocity = cross(spin, def.pose.position);
    def.angular_velocity = spin;
    if (!collide) pass_through(def);
    poses.push_back(def.pose);
    b.add(std::move(def));
  }
  const int held = dice.one_of(3);  // free, at a corner, at two
  for (int i = 0; i < links; i++) {
    const int next = (i + 1) % links;
    const Pose &here = poses[std::size_t(i)], &there = poses[std::size_t(next)];
    JointDef def = joint_at(here, there, corner(i + 1), turned({1, 0, 0}, {0, 0, 1}));
    if (planar) def.freedom = AngleFreedom::hinge();
    b.add(i, next, def);
  }
  for (int i = 0; i < held; i++) b.add(ground, i, joint_at({}, poses[std::size_t(i)], corner(i)));
  b.scene.rules.joints_may_yield = true;
  const double dt = set_pace(b);
  const int steps = affordable_steps(dice, links, 4000);
  bound(b, {}, 4 * radius, length(spin) * radius, steps * dt);
  b.steps(steps, dt);
}

void draw_net(Builder& b) {
  Dice& dice = b.dice;
  const int roll = dice.one_of(20), most = roll == 0 ? 12 : roll < 5 ? 7 : 4;
  const Net net{2 + dice.one_of(most - 1), 2 + dice.one_of(most - 1), dice.by_ratio(0.1, 1)};
  BodyDef knot;
  knot.shapes = {dice.chance(0.5) ? ShapeDef::sphere(0.3 * net.pitch)
                                  : ShapeDef::box(Vec3{0.45, 0.1, 0.45} * net.pitch)};
  knot.density = dice.by_ratio(50, 20000);
  if (dice.chance(0.6)) pass_through(knot);
  net.build(b, knot);
  const int hung = dice.one_of(4);  // by two corners, by an edge, by all corners, not at all
  if (hung == 0 || hung == 2) net.hang(b, 0, 0);
  if (hung == 0 || hung == 2) net.hang(b, 0, net.columns - 1);
  if (hung == 2) net.hang(b, net.rows - 1, 0);
  if (hung == 2) net.hang(b, net.rows - 1, net.columns - 1);
  for (int j = 0; hung == 1 && j < net.columns; j++) net.hang(b, 0, j);
  if (hung == 3) b.scene.world.gravity = {};
  const int pushed = hung == 3 ? 1 + dice.one_of(3) : 0;
  for (int i = 0; i < pushed; i++) b.call(SetVelocity{dice.one_of(b.bodies()), random_vector(dice, 0.1, 20), {}});
  b.scene.rules.joints_may_yield = true;
  const double dt = set_pace(b);
  const int steps = 40 + dice.one_of(60);
  bound(b, {}, (net.rows + net.columns) * net.pitch, hung == 3 ? 20 : 0, hung == 3 ? steps * dt : 0);
  b.steps(steps, dt);
}

/// A ball with others pinned all around it: on a floor, hung, or free.
void draw_hub(Builder& b) {
  Dice& dice = b.dice;
  const int balls = int(dice.by_ratio(8, 101)), stands = dice.one_of(3);
  const double hub = dice.by_ratio(0.2, 2), root = std::sqrt(double(balls));
  const double ball = std::min(1.2 * hub / (root - 1.26) * dice.between(0.3, 1), hub), apart = hub + 1.03 * ball;
  const Vec3 centre{0, stands == 0 ? apart + 1.05 * ball : 0, 0};
  const Vec3 spin = stands == 0 ? Vec3{} : random_vector(dice, 0.1, 10);
  const Material material = random_material(dice);
  BodyDef middle;
  middle.shapes = {ShapeDef::sphere(hub)};
  middle.density = dice.by_ratio(50, 20000);
  middle.pose.position = centre;
  middle.material = material;
  middle.angular_velocity = spin;
  const int hub_body = b.add(middle);
  const double density = dice.by_ratio(50, 20000);
  const bool at_centre = dice.chance(0.5);  // of the balls, or on the hub's surface
  for (int i = 0; i < balls; i++) {         // of a Fibonacci lattice
    const double y = 1 - (2 * i + 1.0) / balls, around = pi * (3 - std::sqrt(5.0)) * i, level = std::sqrt(1 - y * y);
    const Vec3 d{level * std::cos(around), y, level * std::sin(around)};
    BodyDef def;
    def.shapes = {ShapeDef::sphere(ball)};
    def.density = density;
    def.material = material;
    def.pose.position = centre + d * apart;
    def.velocity = cross(spin, d * apart);
    def.angular_velocity = spin;
    const JointDef joint = joint_at(middle.pose, def.pose, centre + d * (at_centre ? apart : hub));
    b.add(hub_body, b.add(std::move(def)), joint);
  }
  if (stands == 0) add_floor(b, material);
  if (stands == 1) b.add(ground, hub_body, joint_at({}, middle.pose, centre));
  if (stands == 2) b.scene.world.gravity = {};
  const double dt = set_pace(b);
  const int steps = affordable_steps(dice, balls, 4000);
  bound(b, centre, 6 * apart, 0, 0);
  b.steps(steps, dt);
}

void draw_bridge(Builder& b) {
  Dice& dice = b.dice;
  Bridge bridge{.planks = int(dice.by_ratio(10, 61)),
                .span = dice.by_ratio(2, 60),
                .width = dice.by_ratio(0.2, 3),
                .thickness = dice.by_ratio(0.01, 0.2),
                .height = 0,
                .density = dice.by_ratio(50, 10000),
                .two_pins = dice.chance(0.6)};
  bridge.one_end = dice.chance(0.15);
  bridge.build(b);
  if (dice.chance(0.4)) {
    BodyDef load = loose_body(dice, 0.5 * bridge.width);
    load.pose.position = {dice.between(-0.3, 0.3) * bridge.span, bridge.width + dice.between(0.2, 2), 0};
    b.add(std::move(load));
  }
  b.scene.rules.joints_may_yield = bridge.two_pins || !bridge.one_end;
  const double dt = set_pace(b);
  const int steps = affordable_steps(dice, b.bodies(), 2500);
  bound(b, {}, bridge.span + bridge.width, 5, steps * dt);
  b.steps(steps, dt);
}

/// Several joints between two bodies that cannot all hold.
void draw_contradiction(Builder& b) {
  Dice& dice = b.dice;
  draw_gravity(b, 0.4);
  const double size = dice.by_ratio(0.1, 1);
  BodyDef first = loose_body(dice, size);
  BodyDef second = loose_body(dice, size * dice.by_ratio(0.3, 1));
  second.pose.position = dice.direction() * (2.1 * size);
  first.angular_velocity = random_vector(dice, 0.01, 10);
  second.velocity = random_vector(dice, 0.01, 5);
  const Pose here = first.pose, there = second.pose;
  const int a = b.add(std::move(first)), c = b.add(std::move(second));
  const bool hinges = dice.chance(0.6);
  const int joints = 2 + dice.one_of(3);
  for (int i = 0; i < joints; i++) {
    const Vec3 point = there.position * 0.5 + dice.direction() * (0.3 * size);
    JointDef def = joint_at(here, there, point, dice.orientation());
    if (hinges) def.freedom = AngleFreedom::hinge();
    // Pins whose distances differ on the two bodies.
    if (!hinges || dice.chance(0.3)) def.frame_b.position = def.frame_b.position + dice.direction() * (0.2 * size);
    b.add(a, c, def);
  }
  const int held = dice.one_of(3);
  if (held > 0) b.add(ground, a, joint_at({}, here, here.position));
  if (held == 2) b.add(ground, c, joint_at({}, there, there.position));
  b.scene.rules.joints_may_yield = true;
  const double dt = set_pace(b);
  const int steps = 60 + dice.one_of(180);
  bound(b, {}, 4 * size, 5, steps * dt);
  b.steps(steps, dt);
}

/// A tree hung from the ground whose limits are met again and again, by its weight or a spin.
void draw_stops(Builder& b) {
  Dice& dice = b.dice;
  draw_gravity(b, 0.2);
  const double arm = dice.by_ratio(0.1, 2);
  const int links = 1 + dice.one_of(4);
  const Quat axes = turned({1, 0, 0}, {0, 0, 1});
  Pose above;
  int last = ground;
  for (int i = 0; i < links; i++) {
    BodyDef def = loose_body(dice, 0.45 * arm);
    def.pose.position = {(i + 0.5) * arm, 0, 0};
    const double fastest = dice.chance(0.5) ? dice.by_ratio(0.5, 20) : 0;
    def.angular_velocity = {0, 0, dice.between(-1, 1) * fastest};
    def.velocity = cross(def.angular_velocity, def.pose.position);
    JointDef joint = joint_at(above, def.pose, {i * arm, 0, 0}, axes);
    const double lower = -dice.by_ratio(0.01, 2);
    joint.freedom = AngleFreedom::hinge(lower, dice.by_ratio(0.01, 2));
    const double cone = dice.by_ratio(0.02, 1.5);
    if (dice.chance(0.3)) joint.freedom = AngleFreedom::cone_and_twist(cone, 0.7 * cone);
    joint.freedom.restitution = dice.chance(0.2) ? 1 : dice.between(0, 1);
    above = def.pose;
    const int body = b.add(std::move(def));
    b.add(last, body, joint);
    last = body;
  }
  const double dt = set_pace(b);
  bound(b, {}, 2 * links * arm, 0, 0);
  b.steps(60 + dice.one_of(180), dt);
}

/// A chassis on motor-driven wheels, with a load that its motors may be too weak for.
void draw_cart(Builder& b) {
  Dice& dice = b.dice;
  Material grip;
  grip.static_friction = grip.kinetic_friction = dice.between(0.2, 1);
  add_floor(b, grip);
  const double radius = dice.by_ratio(0.1, 1), speed = dice.chance(0.5) ? 12 : dice.by_ratio(1, 60);
  const int axles = 1 + dice.one_of(4);
  BodyDef chassis;
  const double half = radius * (0.2 + 1.3 * axles), over = 2.2 * radius;
  chassis.shapes = {ShapeDef::box({half, 0.4 * radius, radius})};
  chassis.pose.position = {0, over + 0.4 * radius, 0};
  chassis.mass = dice.by_ratio(1, 1e4);
  const double load = *chassis.mass;
  const Pose frame = chassis.pose;
  const int cart = b.add(std::move(chassis));
  Motor motor{-speed, load * earth * radius * dice.by_ratio(1e-3, 10)};
  for (int i = 0; i < axles; i++)
    for (const double side : {-1.0, 1.0}) {
      BodyDef wheel;
      const Vec3 axle{0, 0, side};
      wheel.pose = {{(i - 0.5 * (axles - 1)) * 2.6 * radius, radius, side * 1.4 * radius}, turned({0, 1, 0}, axle)};
      wheel.shapes = {dice.chance(0.7) ? ShapeDef::cylinder(radius, 0.2 * radius) : ShapeDef::sphere(radius)};
      wheel.mass = dice.by_ratio(0.1, 10);
      wheel.material = grip;
      JointDef joint = joint_at(frame, wheel.pose, wheel.pose.position, turned({1, 0, 0}, {0, 0, 1}));
      joint.freedom = AngleFreedom::hinge();
      joint.motor = motor;
      b.add(cart, b.add(std::move(wheel)), joint);
    }
  if (dice.chance(0.3)) b.add(fixed_box({half + 4 * radius, 0, 0}, {radius, dice.between(0.1, 4) * radius, 5}, grip));
  const double dt = set_pace(b);
  // The floor ends 50 m away.
  const int steps = std::clamp(int(30 / (speed * radius * dt)), 20, 60 + dice.one_of(180));
  bound(b, {}, 4 * half, 2 * speed * radius, steps * dt);
  b.scene.rules.lower.y = -1;
  b.steps(steps, dt);
}

/// Trees and ropes, which have the most to vary, twice.
constexpr void (*kinds_of_joints[])(Builder&) = {
    draw_free_tree, draw_hung_tree, draw_held_rope, draw_dropped_rope, draw_spun_rope,
    draw_loop,      draw_net,       draw_hub,       draw_bridge,       draw_contradiction,
    draw_stops,     draw_cart,      draw_free_tree, draw_hung_tree,    draw_held_rope,
};

}  // namespace

void draw_joints(Builder& b) {
  const int kind = b.dice.one_of(int(std::size(kinds_of_joints)));
  kinds_of_joints[kind](b);
}

}  // namespace pcphys::wild
