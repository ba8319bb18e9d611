// Ragdolls: dropped, thrown, in a drum that turns, on a bridge, pulled by a hand or a force, under a heavy box.
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
/// A sphere about the middle of the human's height that holds all of it [m].
constexpr double middle = 0.95, outer = 1.08;
constexpr int bones = 12;

/// All ragdolls of a scene are alike.
RagdollDef random_human(Dice& dice) {
  RagdollDef human = RagdollDef::human();
  human.density = dice.by_ratio(50, 20000);
  human.set_damping(dice.chance(0.2) ? 0 : dice.between(0, 3));
  human.material = random_material(dice);
  return human;
}

double weight_of(const RagdollDef& human) {
  double mass = 0;
  for (const BoneDef& bone : human.bones) mass += mass_properties(bone.shape, human.density)->mass;
  return mass * earth;
}

/// The first bone of a ragdoll whose middle is at `centre`.
int add_human(Builder& b, const RagdollDef& human, Vec3 centre, Quat turn, Vec3 velocity) {
  return b.add(human, Pose{centre - rotate(turn, {0, middle, 0}), turn}, velocity);
}

/// One to twelve, fewer more often.
int random_count(Dice& dice) { return int(dice.by_ratio(1, 13)); }

/// A room of cells that hold a ragdoll each, whatever its pose.
struct Cells {
  int across, layers;
  double lowest;  // of the cells [m]

  static Cells of(int count, double lowest) {
    const int across = std::max(1, int(std::ceil(std::sqrt(count / 2.0))));
    return {across, (count + across * across - 1) / (across * across), lowest};
  }
  Vec3 centre(int i) const {
    const int layer = i / (across * across), cell = i % (across * across);
    const double side = 0.5 * (across - 1);
    return {(cell % across - side) * 2 * outer, lowest + (2 * layer + 1) * outer, (cell / across - side) * 2 * outer};
  }
  double half() const { return across * outer; }
  double top() const { return lowest + 2 * layers * outer; }
};

/// Rest is asked for where joints and contacts take energy out, after some seconds.
bool comes_to_rest(const RagdollDef& human, double seconds) {
  const Material& m = human.material;
  const double damping = human.bones[1].damping * 1000 / human.density;  // as it acts at the density of water
  return seconds >= 4 && damping > 0.3 && m.kinetic_friction > 0.2 && m.restitution < 0.3;
}

int steps_of(Builder& b, int ragdolls) { return affordable_steps(b.dice, bones * ragdolls, 9000); }

void draw_dropped(Builder& b) {
  Dice& dice = b.dice;
  const RagdollDef human = random_human(dice);
  const int count = random_count(dice);
  const Cells cells = Cells::of(count, dice.between(0.01, 2));
  Room{cells.half() + dice.between(0.1, 2), cells.top() + 1, human.material}.build(b);
  const bool upright = dice.chance(0.3);
  for (int i = 0; i < count; i++) {
    const Quat turn = dice.orientation();
    add_human(b, human, cells.centre(i), upright ? Quat{} : turn, random_vector(dice, 0.01, 2));
  }
  const double dt = set_pace(b);
  const bool until_rest = count <= 3 && dt > 0.01 && dice.chance(0.6);
  const int steps = until_rest ? int(5 / dt) : steps_of(b, count);
  b.scene.rules.rests = comes_to_rest(human, steps * dt) && cells.layers < 3;
  b.steps(steps, dt);
}

void draw_thrown(Builder& b) {
  Dice& dice = b.dice;
  const RagdollDef human = random_human(dice);
  const int count = 1 + dice.one_of(4);
  const Cells cells = Cells::of(count, dice.between(0.01, 2));
  Room{cells.half() + dice.between(0.1, 5), cells.top() + 2, human.material}.build(b);
  for (int i = 0; i < count; i++) {
    const Quat turn = dice.orientation();
    add_human(b, human, cells.centre(i), turn, random_vector(dice, 1, 60));
  }
  const double dt = set_pace(b);
  b.steps(steps_of(b, count), dt);
}

/// A closed drum about the z axis, of boxes, that turns.
int add_drum(Builder& b, double radius, double half_length, const Material& material) {
  constexpr double thick = 0.2;  // half of it [m]
  const int staves = 6 + b.dice.one_of(9);
  BodyDef drum;
  drum.kind = BodyKind::kinematic;
  drum.pose.position = {0, radius + 1, 0};
  drum.material = material;
  const double stave = (radius + 2 * thick) * std::tan(pi / staves);
  for (int i = 0; i < staves; i++) {
    ShapeDef wall = ShapeDef::box({thick, stave, half_length + 2 * thick});
    const Quat turn = axis_angle({0, 0, 1}, 2 * pi * i / staves);
    wall.local = {rotate(turn, {radius + thick, 0, 0}), turn};
    drum.shapes.push_back(wall);
  }
  for (const double side : {-1.0, 1.0}) {
    ShapeDef end = ShapeDef::box({radius + thick, radius + thick, thick});
    end.local.position = {0, 0, side * (half_length + thick)};
    drum.shapes.push_back(end);
  }
  const double rate = b.dice.by_ratio(0.1, 3);
  drum.angular_velocity = {0, 0, b.dice.chance(0.5) ? rate : -rate};
  return b.add(std::move(drum));
}

void draw_drum(Builder& b) {
  Dice& dice = b.dice;
  const RagdollDef human = random_human(dice);
  const int count = 1 + dice.one_of(5);
  const double radius = dice.between(1.3, 3), spacing = 0.6, half_length = 0.5 * spacing * count + dice.between(0.2, 1);
  const int drum = add_drum(b, radius, half_length, human.material);
  for (int i = 0; i < count; i++) {
    const Vec3 centre{0, radius + 1, (i - 0.5 * (count - 1)) * spacing};
    add_human(b, human, centre, axis_angle({0, 0, 1}, dice.between(0, 2 * pi)), {});
  }
  b.scene.rules.lower = {-radius - 1, -0.5, -half_length - 0.5};
  b.scene.rules.upper = {radius + 1, 2 * radius + 2.5, half_length + 0.5};
  const double dt = set_pace(b);
  const int steps = steps_of(b, count);
  b.steps(steps / 2, dt);
  if (dice.chance(0.3)) b.call(SetVelocity{drum, {}, {0, 0, dice.between(-3, 3)}});
  b.steps(steps - steps / 2, dt);
}

void draw_on_bridge(Builder& b) {
  Dice& dice = b.dice;
  const RagdollDef human = random_human(dice);
  const int count = 1 + dice.one_of(4);
  Bridge bridge{.planks = 4 + dice.one_of(11),
                .span = 2.2 * outer * count + dice.between(0.2, 3),
                .width = dice.between(0.5, 2.5),
                .thickness = dice.between(0.03, 0.2),
                .height = dice.between(0.5, 3),
                .density = dice.by_ratio(100, 8000),
                .two_pins = dice.chance(0.8)};
  bridge.material = random_material(dice);
  const double lowest = bridge.height + bridge.thickness + dice.between(0, 1.5);
  Room{0.5 * bridge.span + 1.5, lowest + 2 * outer + 2, human.material}.build(b);
  bridge.build(b);
  for (int i = 0; i < count; i++) {
    const Vec3 centre{(i - 0.5 * (count - 1)) * 2.2 * outer, lowest + outer, 0};
    const Quat turn = dice.orientation();
    add_human(b, human, centre, turn, random_vector(dice, 0.01, 3));
  }
  b.scene.rules.joints_may_yield = true;
  const double dt = set_pace(b);
  b.steps(affordable_steps(dice, b.bodies(), 4500), dt);
}

/// A kinematic hand holds a bone, moves for a while and then stands.
void draw_by_hand(Builder& b) {
  Dice& dice = b.dice;
  const RagdollDef human = random_human(dice);
  const int count = 1 + dice.one_of(3), held = dice.one_of(count), bone = dice.one_of(bones);
  const bool walled = dice.chance(0.6);
  const Cells cells = Cells::of(count, dice.between(0.01, 1));
  const Quat turn = dice.orientation();
  const double speed = dice.by_ratio(0.5, 10), dt = set_pace(b);
  const int moving = std::clamp(int(dice.between(0.2, 1) / dt), 10, 120), still = 20 + dice.one_of(100);
  const Vec3 velocity = (dice.chance(0.5) ? Vec3{0, 1, 0} : dice.direction()) * speed;
  // Only the floor is near enough for the hand to drag what it holds against it, or through.
  const double way = speed * moving * dt;
  if (walled) Room{cells.half() + way + 2, cells.top() + way + 2, human.material}.build(b);
  int first = 0;
  for (int i = 0; i < count; i++) {
    const int bone_0 = add_human(b, human, cells.centre(i), i == held ? turn : Quat{}, {});
    if (i == held) first = bone_0;
  }
  const BoneDef& caught = human.bones[std::size_t(bone)];
  const Pose frame{cells.centre(held) - rotate(turn, {0, middle, 0}), turn};
  const Pose stands{transform(frame, caught.pose.position), turn * caught.pose.orientation};
  const int hand = add_hand(b, stands.position);
  b.add(hand, first + bone, joint_at({stands.position, {}}, stands, stands.position));
  b.scene.rules.joints_may_yield = walled;
  if (!walled) bound(b, {}, cells.half() + cells.top() + way + 2 * outer, 1, (moving + still) * dt);
  if (walled) b.scene.rules.lower.y = -0.5 - way - 2 * outer;
  b.call(SetVelocity{hand, velocity, {}});
  b.steps(moving, dt);
  b.call(SetVelocity{hand, {}, {}});
  b.steps(still, dt);
}

void draw_pulled(Builder& b) {
  Dice& dice = b.dice;
  const RagdollDef human = random_human(dice);
  const int count = 1 + dice.one_of(3);
  const Cells cells = Cells::of(count, 0.01);
  Room{cells.half() + dice.between(0.5, 4), cells.top() + dice.between(0.5, 3), human.material}.build(b);
  int first = 0;
  for (int i = 0; i < count; i++) {
    const Quat turn = dice.orientation();
    first = add_human(b, human, cells.centre(i), turn, {});
  }
  // Up to a hundred times the weight of the lightest human.
  const Vec3 force = random_vector(dice, 10, std::min(1e4, 100 * weight_of(human)));
  const double dt = set_pace(b);
  const int steps = steps_of(b, count), pulled = first + dice.one_of(bones);
  const int pull = b.add(pulled, Wrench{force, {}});
  b.steps(steps / 2, dt);
  if (dice.chance(0.5)) b.call(Destroy{Object::force, pull});
  b.steps(steps - steps / 2, dt);
}

/// A box of 50 kg to 100 t falls on ragdolls.
void draw_crushed(Builder& b) {
  Dice& dice = b.dice;
  const RagdollDef human = random_human(dice);
  const int count = 1 + dice.one_of(3);
  const Cells cells = Cells::of(count, 0.01);
  const double drop = dice.between(0.1, 3);
  BodyDef box;
  const Vec3 half{dice.between(0.2, 1), dice.between(0.2, 0.6), dice.between(0.2, 1)};
  box.shapes = {ShapeDef::box(half)};
  box.mass = dice.by_ratio(50, 1e5);
  box.material = random_material(dice);
  const double tallest = length(half);
  box.pose = {{0, cells.top() + drop + tallest, 0}, dice.chance(0.5) ? Quat{} : dice.orientation()};
  Room{cells.half() + tallest + dice.between(0.1, 2), cells.top() + drop + 2 * tallest + 0.5, human.material}.build(b);
  for (int i = 0; i < count; i++) {
    const Quat turn = dice.orientation();
    add_human(b, human, cells.centre(i), turn, {});
  }
  const double dt = set_pace(b);
  const int steps = steps_of(b, count);
  // Those are given time to lie down.
  b.steps(steps / 3, dt);
  b.add(std::move(box));
  b.steps(steps - steps / 3, dt);
}

constexpr void (*kinds_of_ragdolls[])(Builder&) = {draw_dropped, draw_thrown, draw_drum,   draw_on_bridge,
                                                   draw_by_hand, draw_pulled, draw_crushed};

}  // namespace

void draw_ragdolls(Builder& b) {
  const int kind = b.dice.one_of(int(std::size(kinds_of_ragdolls)));
  kinds_of_ragdolls[kind](b);
}

}  // namespace pcphys::wild
