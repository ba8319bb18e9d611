// Pins that motion does not depend on how the world is turned: the same scene, turned by some rotation with its
// gravity, moves as before but for rounding, in double precision. It has caught Gershgorin's bound on a pin's stiffness
// and the smallest response of a contact along tangents that the world's axes chose (4e-3 for a box on a floor, 1e-2
// for a pile).
#include <algorithm>
#include <functional>
#include <random>

#include "support_trees.h"

using namespace trees;

namespace {

/// Makes bodies and joints of a scene in a world that is turned.
struct Turned {
  Run run;
  Quat turn;

  explicit Turned(Quat by) : run({}, rotate(by, {0, -gravity, 0}), 4), turn(by) {}

  BodyId add(BodyDef def) {
    def.pose = {rotate(turn, def.pose.position), turn * def.pose.orientation};
    def.velocity = rotate(turn, def.velocity);
    def.angular_velocity = rotate(turn, def.angular_velocity);
    return run.add(def);
  }
  void pin(BodyId a, BodyId b, Vec3 place, const AngleFreedom& freedom = {}) {
    join(run, a, b, rotate(turn, place), freedom, turn);
  }
  /// Of all bodies, as the scene that is not turned has them.
  std::vector<Pose> poses() const {
    std::vector<Pose> all;
    const Quat back = conjugate(turn);
    for (const BodyId body : run.world.bodies())
      all.push_back({rotate(back, run.position(body)), back * run.orientation(body)});
    return all;
  }
};

BodyDef shaped(const ShapeDef& shape, Vec3 position, Quat orientation = {}) {
  BodyDef def;
  def.shapes = {shape};
  def.pose = {position, orientation};
  def.density = 1000;
  return def;
}

void add_floor(Turned& t) {
  BodyDef floor = shaped(ShapeDef::box({5, 0.5, 5}), {0, -0.5, 0});
  floor.kind = BodyKind::fixed;
  t.add(floor);
}

/// Falls on a corner, topples and slides.
void make_box(Turned& t) {
  add_floor(t);
  BodyDef box = shaped(ShapeDef::box({0.3, 0.2, 0.5}), {0, 0.42, 0}, axis_angle({0.6, 0, 0.8}, 0.6));
  box.velocity = {1, -1, 0.4};
  box.angular_velocity = {0, 1, 0};
  t.add(box);
}

/// Stands on each other askew, so that no two overlaps are equal, which rounding would choose from. Without cylinders
/// and hulls, whose closest points are found step by step from a direction of the world's, to 1e-5 of their size.
void make_pile(Turned& t) {
  add_floor(t);
  t.add(shaped(ShapeDef::box({0.5, 0.2, 0.4}), {0, 0.199, 0}, axis_angle({0, 1, 0}, 0.3)));
  t.add(shaped(ShapeDef::box({0.3, 0.25, 0.3}), {0.1, 0.648, 0.05}, axis_angle({0, 1, 0}, 1.1)));
  t.add(shaped(ShapeDef::sphere(0.2), {0.15, 1.098, 0.05}));
  BodyDef thrown = shaped(ShapeDef::sphere(0.15), {-1.2, 0.8, 0.1});
  thrown.velocity = {4, 0, 0};
  t.add(thrown);
  t.add(shaped(ShapeDef::capsule(0.1, 0.3), {1, 0.25, -0.5}, axis_angle({0, 0, 1}, 1.2)));
  t.add(shaped(ShapeDef::box({0.2, 0.1, 0.15}), {-1.3, 0.25, -1.1}, axis_angle({0, 0.6, 0.8}, 0.5)));
}

/// Hangs askew, with branches, and swings.
void make_tree(Turned& t) {
  std::vector<BodyId> bodies;
  const auto add = [&](Vec3 half, double mass, Vec3 place, double about) {
    BodyDef def = rod(half, mass, place, axis_angle({0.6, 0, 0.8}, about));
    def.angular_velocity = {0.5, 1, -0.3};
    bodies.push_back(t.add(def));
  };
  add({0.3, 0.05, 0.07}, 1, {0.3, 0, 0.02}, 0);
  add({0.3, 0.04, 0.09}, 3, {0.9, 0.1, 0}, 0.2);
  add({0.05, 0.3, 0.06}, 20, {0.6, -0.35, 0.1}, 0.1);
  add({0.25, 0.06, 0.05}, 0.5, {1.4, 0.2, 0.1}, -0.3);
  t.pin(t.run.world.ground(), bodies[0], {0, 0, 0});
  t.pin(bodies[0], bodies[1], {0.6, 0.05, 0});
  t.pin(bodies[0], bodies[2], {0.6, -0.05, 0}, AngleFreedom::cone_and_twist(0.4, 0.3));
  t.pin(bodies[1], bodies[3], {1.15, 0.15, 0}, AngleFreedom::hinge(-0.2, 0.3));
}

/// How far the bodies of the scene are from where they are in the one that is not turned, as a share of a metre or a
/// radian.
double differ(const std::function<void(Turned&)>& make, Quat turn) {
  Turned upright({}), turned(turn);
  make(upright);
  make(turned);
  upright.run.step(frame, 18);
  turned.run.step(frame, 18);
  const std::vector<Pose> here = upright.poses(), there = turned.poses();
  double most = 0;
  for (std::size_t i = 0; i < here.size(); i++) {
    most = std::max(most, length(here[i].position - there[i].position));
    most = std::max(most, angle_between(here[i].orientation, there[i].orientation));
  }
  return most;
}

}  // namespace

TEST_CASE("turned worlds: a box on a floor, a pile and a joint tree move as in the one that is not turned") {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 6; i++) {
    const Quat any{normal(random), normal(random), normal(random), normal(random)};
    const double scale = 1 / std::sqrt(any.x * any.x + any.y * any.y + any.z * any.z + any.w * any.w);
    const Quat turn{any.x * scale, any.y * scale, any.z * scale, any.w * scale};
    const double box = differ(make_box, turn), pile = differ(make_pile, turn), tree = differ(make_tree, turn);
    MESSAGE("turned worlds, differences: box " << box << ", pile " << pile << ", tree " << tree);
    CHECK(box <= 1e-9);
    CHECK(pile <= 1e-9);
    CHECK(tree <= 1e-9);
  }
}
