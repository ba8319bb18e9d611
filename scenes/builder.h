// Builds a scene: creates objects in a world and writes down what the metrics need.
#pragma once
#include "random.h"
#include "scene.h"

namespace pcphys::scenes {

class Builder {
 public:
  Builder(World& world, Scene& scene, const SceneOptions& options) : world_(world), scene_(scene), options_(options) {}

  Scene& scene() { return scene_; }
  World& world() { return world_; }
  /// The scene's own random numbers, or those of the seed that was asked for.
  Random random(std::uint64_t own_seed) const { return Random(options_.seed.value_or(own_seed)); }

  /// Material of the bodies that follow.
  void set_material(double friction, double restitution) { material_ = {friction, friction, restitution}; }
  void set_material(const Material& material) { material_ = material; }
  const Material& material() const { return material_; }

  /// Index of the new body in the scene; -1 after an error.
  int add(BodyDef def, int group = 0, int bone = 0);
  int add_fixed_box(Vec3 centre, Vec3 half_extents);
  void add_joint(const JointDef& def);
  void add_ragdoll(const RagdollDef& def, const Pose& pose, Vec3 velocity, int group);

  /// A floor of 200 m x 200 m with its top at y = 0.
  void add_floor();
  /// The open-lidded box: floor at y = 0 and four walls, 1 m thick.
  void add_open_box(double inner_width, double wall_height);

  /// Ends the scene with an error, unless there is one already.
  void fail(const Error& error) { (void)failed(error); }
  BodyId id(int body) const { return body < 0 ? BodyId{} : scene_.bodies[std::size_t(body)].id; }
  /// The first error; code none when all went well.
  const Error& error() const { return error_; }

 private:
  bool failed(const Error& error);

  World& world_;
  Scene& scene_;
  const SceneOptions& options_;
  Material material_;
  Error error_;
};

// One function a scene, in the file of its kind.
void build_balls(Builder& builder);
void build_ragdolls(Builder& builder);
void build_pyramid(Builder& builder);
void build_stack(Builder& builder);
void build_heavy(Builder& builder);
void build_chain(Builder& builder);
void build_chainswing(Builder& builder);
void build_door(Builder& builder);
void build_dominoes(Builder& builder);
void build_hulls(Builder& builder);
void build_ballistic(Builder& builder);
void build_magnets(Builder& builder);

}  // namespace pcphys::scenes
