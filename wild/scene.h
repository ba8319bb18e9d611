// A wild scene: random, and legal. It is a list of calls of the public API, so that it can be played on any backend,
// built in another engine, made smaller while it still breaks, and printed as a program.
#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pcphys/result.h"
#include "pcphys/step.h"
#include "pcphys/types.h"
#include "pcphys/world.h"
#include "wild/dice.h"

namespace pcphys::wild {

/// Bodies, joints, springs and forces have the number that the call which makes them gives them. Numbers are never used
/// twice, and stay when other calls are taken out.
inline constexpr int ground = -1;

struct MakeBody {
  int body;
  BodyDef def;
};
/// `def.a` and `def.b` are of the bodies a and b.
struct MakeJoint {
  int joint, a, b;
  JointDef def;
};
struct MakeSpring {
  int spring, a, b;
  SpringDef def;
};
/// Bones and joints have the numbers from the first ones on.
struct MakeRagdoll {
  int first_body, first_joint;
  RagdollDef def;
  Pose pose;
  Vec3 velocity;
};
enum class Object : std::uint8_t { body, joint, spring, force };
struct Destroy {
  Object object;
  int number;
};
struct SetPose {
  int body;
  Pose pose;
};
struct SetVelocity {
  int body;
  Vec3 velocity, angular_velocity;
};
struct SetMass {
  int body;
  MassProperties mass;
};
struct SetMaterial {
  int body;
  Material material;
};
struct SetDrag {
  int body;
  double linear, angular;
};
struct SetFilter {
  int body;
  Filter filter;
};
struct SetCollide {
  int a, b;
  bool collide;
};
struct SetMotor {
  int joint;
  Motor motor;
};
struct SetJointSpring {
  int joint;
  AngularSpring spring;
};
struct SetSpring {
  int spring;
  double rest_length, stiffness, damping;
};
struct SetGravity {
  Vec3 gravity;
};
struct AddForce {
  int force, body;
  Wrench wrench;
};
struct SetCanSleep {
  int body;
  bool can_sleep;
};
struct Wake {
  int body;
};
/// Settings from the next step on; where stages run is the player's choice.
struct Configure {
  StepSettings settings;
};
/// Takes a snapshot; the next Restore gives it back, if the objects are the same.
struct Save {};
struct Restore {};
struct Steps {
  int count;
  double dt;
};

using Call = std::variant<MakeBody, MakeJoint, MakeSpring, MakeRagdoll, Destroy, SetPose, SetVelocity, SetMass,
                          SetMaterial, SetDrag, SetFilter, SetCollide, SetMotor, SetJointSpring, SetSpring, SetGravity,
                          AddForce, SetCanSleep, Wake, Configure, Save, Restore, Steps>;

/// What a scene is judged by, besides what holds in all of them.
struct Rules {
  /// Two bodies meet once: their energy may not rise by more than rounding.
  bool single_encounter = false;
  /// Bodies that never touch anything on their way: their velocity is that of free flight.
  std::vector<int> untouched;
  /// Bodies on a level, frictionless floor of tiles: their speed along it is kept.
  std::vector<int> gliding;
  /// Something that comes to rest: at the end overlaps are those of resting contacts.
  bool rests = false;
  /// Overlaps that the scene begins with, or that the host makes, are no fault.
  bool overlaps = false;
  /// Loops, nets and hands that drag: gaps of joints and excess of limits are measured, not judged.
  bool joints_may_yield = false;
  /// Towers that were built to stand: bodies stay within this of where they began [m]; 0: they need not.
  double stands_within = 0;
  /// A body whose centre leaves this box is lost [m].
  Vec3 lower{-1e30, -1e30, -1e30}, upper{1e30, 1e30, 1e30};
};

struct Scene {
  std::string family;
  std::uint64_t seed = 0;
  WorldDef world;  // the precision is the player's choice
  StepSettings settings;
  std::vector<Call> calls;
  Rules rules;
};

/// A scene while it is drawn.
class Builder {
 public:
  Builder(std::string_view family, std::uint64_t seed) : dice(family, seed) {
    scene.family = family;
    scene.seed = seed;
  }
  Dice dice;
  Scene scene;

  int add(BodyDef def) {
    scene.calls.push_back(MakeBody{bodies_, std::move(def)});
    return bodies_++;
  }
  int add(int a, int b, JointDef def) {
    scene.calls.push_back(MakeJoint{joints_, a, b, std::move(def)});
    return joints_++;
  }
  int add(int a, int b, SpringDef def) {
    scene.calls.push_back(MakeSpring{springs_, a, b, def});
    return springs_++;
  }
  int add(int body, Wrench wrench) {
    scene.calls.push_back(AddForce{forces_, body, wrench});
    return forces_++;
  }
  /// The number of the first bone.
  int add(RagdollDef def, Pose pose, Vec3 velocity) {
    const int first = bodies_, bones = int(def.bones.size());
    scene.calls.push_back(MakeRagdoll{first, joints_, std::move(def), pose, velocity});
    bodies_ += bones;
    joints_ += bones - 1;
    return first;
  }
  template <class C> void call(C one) { scene.calls.push_back(std::move(one)); }
  void steps(int count, double dt) { scene.calls.push_back(Steps{count, dt}); }

  int bodies() const { return bodies_; }
  int joints() const { return joints_; }
  int springs() const { return springs_; }
  int forces() const { return forces_; }

 private:
  int bodies_ = 0, joints_ = 0, springs_ = 0, forces_ = 0;
};

struct Family {
  std::string_view name;
  std::string_view description;
  void (*draw)(Builder&);
};

/// All of them, in the order in which tables show them.
std::span<const Family> families();

/// Errors: unknown_name, with all names that there are.
Result<const Family*> find_family(std::string_view name);

/// A function of family and seed alone. Errors: unknown_name.
Result<Scene> draw(std::string_view family, std::uint64_t seed);

// One function a family, in the file of its name.
void draw_encounter(Builder& b);
void draw_passing(Builder& b);
void draw_floor(Builder& b);
void draw_pile(Builder& b);
void draw_tower(Builder& b);
void draw_joints(Builder& b);
void draw_springs(Builder& b);
void draw_ragdolls(Builder& b);
void draw_host(Builder& b);

}  // namespace pcphys::wild
