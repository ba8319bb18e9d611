// Parts that families build alike: loose bodies, frames of joints, rooms, bridges, trees, ropes and nets.
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "wild/scene.h"
#include "wild/shapes.h"

namespace pcphys::wild {

/// Of the Earth [m/s^2].
inline constexpr double earth = 9.81;

/// Of any direction, with a length by ratio. Drawn in this order: C++ leaves that of the factors of a product open.
inline Vec3 random_vector(Dice& dice, double shortest, double longest) {
  const Vec3 towards = dice.direction();
  return towards * dice.by_ratio(shortest, longest);
}

/// Any direction that is square to the unit vector `along`.
inline Vec3 square_to(Dice& dice, Vec3 along) {
  while (true) {
    const Vec3 v = cross(along, dice.direction());
    if (length(v) > 0.1) return v * (1 / length(v));
  }
}

/// The shortest rotation from one unit vector to another.
inline Quat turned(Vec3 from, Vec3 to) {
  const Vec3 axis = cross(from, to);
  const double sine = length(axis), cosine = dot(from, to);
  if (sine > 1e-9) return axis_angle(axis * (1 / sine), std::atan2(sine, cosine));
  if (cosine > 0) return {};
  const Vec3 other = std::fabs(from.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 square = cross(from, other);
  return axis_angle(square * (1 / length(square)), std::numbers::pi);
}

/// A frame of the world, as a body at this pose sees it.
inline Pose seen_from(const Pose& body, const Pose& frame) {
  const Quat back = conjugate(body.orientation);
  return {rotate(back, frame.position - body.position), back * frame.orientation};
}

/// A pin at a point of the world between two bodies at these poses; the joint's axes stand as `axes`.
inline JointDef joint_at(const Pose& a, const Pose& b, Vec3 point, Quat axes = {}) {
  JointDef def;
  def.frame_a = seen_from(a, {point, axes});
  def.frame_b = seen_from(b, {point, axes});
  return def;
}

/// A body of random shape within a sphere of `radius`, of random density and pose about the origin.
inline BodyDef loose_body(Dice& dice, double radius) {
  BodyDef def;
  def.shapes = {random_shape(dice, radius)};
  def.pose.orientation = dice.orientation();
  def.density = dice.by_ratio(50, 20000);
  def.material = random_material(dice);
  return def;
}

/// What a dynamic body of one shape weighs [kg].
inline double mass_of(const BodyDef& def) {
  if (def.mass) return *def.mass;
  return mass_properties(def.shapes[0], def.density)->mass;
}

/// Nothing collides with the body.
inline void pass_through(BodyDef& def) {
  for (ShapeDef& shape : def.shapes) shape.filter.mask = 0;
}

inline std::uint32_t random_substeps(Dice& dice) { return dice.chance(0.5) ? 4u : 2u + std::uint32_t(dice.one_of(7)); }

/// Sets the sub-steps and answers with the time step.
inline double set_pace(Builder& b) {
  b.scene.settings.substeps = random_substeps(b.dice);
  return random_dt(b.dice);
}

/// So many steps of scenes that may cost `body_steps`, within 60 to 240.
inline int affordable_steps(Dice& dice, int bodies, int body_steps) {
  const int most = std::clamp(body_steps / bodies, 60, 240);
  return 60 + dice.one_of(most - 59);
}

/// What began within `radius` of `centre` at this speed, and falls, stays in this box.
inline void bound(Builder& b, Vec3 centre, double radius, double speed, double seconds) {
  const double falls = 0.5 * length(b.scene.world.gravity) * seconds * seconds;
  const double reach = 1 + 1.1 * (radius + speed * seconds + falls);
  b.scene.rules.lower = centre - Vec3{reach, reach, reach};
  b.scene.rules.upper = centre + Vec3{reach, reach, reach};
}

inline BodyDef fixed_box(Vec3 centre, Vec3 half_extents, const Material& material) {
  BodyDef def;
  def.kind = BodyKind::fixed;
  def.pose.position = centre;
  def.shapes = {ShapeDef::box(half_extents)};
  def.material = material;
  return def;
}

/// A level floor with its top at y = 0: a plane, or a box of 100 m.
inline int add_floor(Builder& b, const Material& material) {
  if (b.dice.chance(0.6)) return b.add(fixed_box({0, -0.5, 0}, {50, 0.5, 50}, material));
  BodyDef def;
  def.kind = BodyKind::fixed;
  def.shapes = {ShapeDef::plane()};
  def.material = material;
  return b.add(std::move(def));
}

/// A floor at y = 0, four walls at `half` from the middle and a lid at `height` [m], and the bounds that follow.
struct Room {
  double half, height;
  Material material;
  /// All walls have it.
  Filter filter = {};

  void build(Builder& b) const {
    constexpr double thick = 0.5;  // half of it [m]
    const double middle = 0.5 * height, across = half + 2 * thick;
    add(b, {0, -thick, 0}, {across, thick, across});
    add(b, {0, height + thick, 0}, {across, thick, across});
    for (const double side : {-1.0, 1.0}) {
      add(b, {side * (half + thick), middle, 0}, {thick, middle, across});
      add(b, {0, middle, side * (half + thick)}, {half, middle, thick});
    }
    constexpr double margin = 1;
    b.scene.rules.lower = {-half - margin, -margin, -half - margin};
    b.scene.rules.upper = {half + margin, height + margin, half + margin};
  }

 private:
  void add(Builder& b, Vec3 centre, Vec3 half_extents) const {
    BodyDef def = fixed_box(centre, half_extents, material);
    def.shapes[0].filter = filter;
    b.add(std::move(def));
  }
};

/// Planks in a straight row along x, pinned to each other and at both ends to the world.
struct Bridge {
  int planks;
  double span, width, thickness, height;  // [m]; the height is that of the pins
  double density;
  bool two_pins;  // at either side of a gap between planks, or one in its middle
  bool one_end = false;
  Material material = {};

  void build(Builder& b) const {
    const double pitch = span / planks;
    Pose before;
    int last = ground;
    for (int i = 0; i < planks; i++) {
      const Vec3 pin{-0.5 * span + i * pitch, height, 0};
      const Pose here{pin + Vec3{0.5 * pitch, 0, 0}, {}};
      const int plank = b.add(plank_at(here, pitch));
      pin_together(b, last, plank, before, here, pin);
      before = here;
      last = plank;
    }
    if (!one_end) pin_together(b, ground, last, {}, before, {0.5 * span, height, 0});
  }

 private:
  BodyDef plank_at(const Pose& pose, double pitch) const {
    BodyDef def;
    def.pose = pose;
    def.shapes = {ShapeDef::box({0.48 * pitch, 0.5 * thickness, 0.5 * width})};
    def.density = density;
    def.material = material;
    return def;
  }
  void pin_together(Builder& b, int a, int plank, const Pose& pose_a, const Pose& pose, Vec3 pin) const {
    for (const double side : {-0.45, 0.45}) {
      const Vec3 aside{0, 0, two_pins ? side * width : 0};
      b.add(a, plank, joint_at(pose_a, pose, pin + aside));
      if (!two_pins) break;
    }
  }
};

/// Plays `count` steps, while a kinematic body is given another velocity every now and then. Answers how far it may
/// have gone.
inline double lead(Builder& b, int hand, int count, double dt, double speed, double spin) {
  double way = 0;
  for (int left = count; left > 0;) {
    const int now = std::min(left, 5 + b.dice.one_of(40));
    const double pace = b.dice.chance(0.2) ? 0 : b.dice.between(0, speed);
    b.call(SetVelocity{hand, b.dice.direction() * pace, b.dice.direction() * spin});
    b.steps(now, dt);
    way += pace * now * dt;
    left -= now;
  }
  return way;
}

/// A small body that only moves as it is told.
inline int add_hand(Builder& b, Vec3 position) {
  BodyDef def;
  def.kind = BodyKind::kinematic;
  def.pose.position = position;
  def.shapes = {ShapeDef::sphere(0.05)};
  pass_through(def);
  return b.add(std::move(def));
}

/// Limits that hold the pose in which the joint is made.
inline AngleFreedom random_freedom(Dice& dice) {
  const auto angle = [&] { return dice.by_ratio(0.05, 1.4); };
  const auto below = [&] { return dice.chance(0.2) ? 0.0 : -angle(); };
  const double cone = angle(), twist = angle();
  const Vec3 lower{below(), below(), below()}, upper{angle(), angle(), angle()};
  AngleFreedom freedom;
  switch (dice.one_of(6)) {
    case 0: break;
    case 1: freedom = AngleFreedom::cone_and_twist(cone, twist); break;
    case 2: freedom = AngleFreedom::between(lower, upper); break;
    case 3: freedom = AngleFreedom::hinge(); break;
    case 4: freedom = AngleFreedom::hinge(lower.x, upper.x); break;
    default: freedom = AngleFreedom::locked(); break;
  }
  if (dice.chance(0.4)) freedom.restitution = dice.between(0, 1);
  return freedom;
}

inline bool turns(const AngleFreedom& freedom) {
  return freedom.kind != AngleFreedom::Kind::pitch_yaw_roll || freedom.lower != freedom.upper;
}

/// A motor or a spring, from much too weak for the weight to much too strong; `arm` is the weight's [m].
inline void add_drive(Dice& dice, JointDef& def, double mass, double arm) {
  const double couple = mass * earth * arm;
  if (dice.chance(0.5)) {
    const double sense = dice.chance(0.5) ? 1 : -1;
    def.motor.speed = sense * dice.by_ratio(0.1, 50);
    def.motor.torque = couple * dice.by_ratio(0.01, 100);
    return;
  }
  def.spring.stiffness = dice.chance(0.2) ? 0 : couple * dice.by_ratio(0.01, 1e4);
  def.spring.damping = dice.chance(0.4) ? 0 : couple * dice.by_ratio(1e-3, 10);
  const Vec3 axis = dice.direction();
  if (dice.chance(0.5)) def.spring.rest = axis_angle(axis, dice.between(0, 1.5));
}

/// A tree whose bodies stand apart by their outer spheres.
struct Tree {
  struct Node {
    int body;
    Pose pose;
    double radius;
  };
  Builder& b;
  double size;          // of bodies, about [m]
  Vec3 velocity, spin;  // all move as one rigid body about the origin
  double unruly = 0;    // what bodies spin beside [rad/s]
  double drives = 0;    // share of joints that have one
  bool branches = true, collide = false;
  std::vector<Node> nodes = {};
  double reach = 0;  // of all joints together [m]
  double newest_mass = 0;

  Node& add_node(Vec3 position, double radius) {
    BodyDef def = loose_body(b.dice, radius);
    def.pose.position = position;
    def.velocity = velocity + cross(spin, position);
    def.angular_velocity = spin + b.dice.direction() * unruly;
    if (!collide) pass_through(def);
    const Pose pose = def.pose;
    newest_mass = mass_of(def);
    nodes.push_back({b.add(std::move(def)), pose, radius});
    return nodes.back();
  }

  void join(int above, const Pose& pose, const Node& node, Vec3 pin) {
    JointDef def = joint_at(pose, node.pose, pin, b.dice.orientation());
    def.freedom = random_freedom(b.dice);
    if (b.dice.chance(drives) && turns(def.freedom)) add_drive(b.dice, def, newest_mass, node.radius);
    b.add(above, node.body, def);
    reach += 2.2 * node.radius;
  }

  bool is_free(Vec3 position, double radius, std::size_t parent) const {
    for (std::size_t i = 0; i < nodes.size(); i++) {
      const double apart = length(position - nodes[i].pose.position);
      if (i != parent && apart < 1.03 * (radius + nodes[i].radius)) return false;
    }
    return true;
  }

  /// Fewer bodies than asked for where there was no room.
  void grow(int count) {
    add_node({}, size);
    // What finds no room for its sphere is tried elsewhere.
    for (int tries = 0; tries < 10 * count && int(nodes.size()) < count; tries++) {
      const std::size_t parent = branches ? std::size_t(b.dice.one_of(int(nodes.size()))) : nodes.size() - 1;
      const Node from = nodes[parent];
      const double radius = size * b.dice.by_ratio(0.4, 2.5);
      const Vec3 towards = b.dice.direction();
      const Vec3 place = from.pose.position + towards * (1.03 * (from.radius + radius));
      if (!is_free(place, radius, parent)) continue;
      const Node made = add_node(place, radius);
      join(from.body, from.pose, made, from.pose.position + towards * (1.01 * from.radius));
    }
  }
};

/// A row of links, each pinned to the one before.
struct Rope {
  int links;
  double link, mass;  // of one [m], [kg]
  Vec3 start, along;
  double load = 0;  // its last link is a ball of so many times the mass; 0: it is not
  bool collide = false;
  double damping = 0;  // of joints [N m s/rad]
  Vec3 spin = {};      // about the start
  bool swings_freely = true;
  std::vector<int> bodies = {};
  std::vector<Pose> poses = {};

  Vec3 end() const { return start + along * (links * link); }

  void build(Builder& b) {
    const int kind = b.dice.one_of(3);
    for (int i = 0; i < links; i++) {
      BodyDef def;
      def.shapes = {shape(kind, load > 0 && i == links - 1)};
      def.pose = {start + along * ((i + 0.5) * link), turned({0, 1, 0}, along)};
      def.mass = mass * (load > 0 && i == links - 1 ? load : 1);
      def.velocity = cross(spin, def.pose.position - start);
      def.angular_velocity = spin;
      if (!collide) pass_through(def);
      poses.push_back(def.pose);
      bodies.push_back(b.add(std::move(def)));
      if (i > 0) b.add(bodies[std::size_t(i - 1)], bodies.back(), pin(b.dice, std::size_t(i)));
    }
  }

 private:
  ShapeDef shape(int kind, bool last) const {
    if (last) return ShapeDef::sphere(0.45 * link);
    if (kind == 0) return ShapeDef::capsule(0.12 * link, 0.35 * link);
    if (kind == 1) return ShapeDef::box({0.1 * link, 0.47 * link, 0.15 * link});
    return ShapeDef::cylinder(0.1 * link, 0.46 * link);
  }
  JointDef pin(Dice& dice, std::size_t i) const {
    JointDef def = joint_at(poses[i - 1], poses[i], start + along * (double(i) * link), turned({1, 0, 0}, along));
    const double cone = dice.between(0.2, 1);
    if (!swings_freely) def.freedom = AngleFreedom::cone_and_twist(cone, 0.7 * cone);
    def.spring.damping = damping;
    return def;
  }
};

/// Bodies in a level grid, each pinned to its neighbours half way.
struct Net {
  int rows, columns;
  double pitch;

  Vec3 place(int i, int j) const { return {(i - 0.5 * (rows - 1)) * pitch, 0, (j - 0.5 * (columns - 1)) * pitch}; }
  Pose pose(int i, int j) const { return {place(i, j), {}}; }
  int body(int i, int j) const { return i * columns + j; }  // it is built first

  void build(Builder& b, const BodyDef& knot) const {
    for (int i = 0; i < rows; i++)
      for (int j = 0; j < columns; j++) {
        BodyDef def = knot;
        def.pose.position = place(i, j);
        b.add(std::move(def));
        if (i > 0) pin(b, i - 1, j, i, j);
        if (j > 0) pin(b, i, j - 1, i, j);
      }
  }
  void hang(Builder& b, int i, int j) const { b.add(ground, body(i, j), joint_at({}, pose(i, j), place(i, j))); }

 private:
  void pin(Builder& b, int i, int j, int k, int l) const {
    const Vec3 middle = (place(i, j) + place(k, l)) * 0.5;
    b.add(body(i, j), body(k, l), joint_at(pose(i, j), pose(k, l), middle));
  }
};

}  // namespace pcphys::wild
