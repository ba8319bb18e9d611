// Named scenes, shared by the command, the examples, the tests and the benchmarks. Y is up, SI units.
// balls, ragdolls, pyramid, stack, chain, chainswing and heavy have the numbers of the programs that
// measured the peer engines (tests/data/scenes.csv), so that figures can be put side by side.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pcphys/kernel.h"
#include "pcphys/result.h"
#include "pcphys/step.h"
#include "pcphys/types.h"
#include "pcphys/world.h"

namespace pcphys::scenes {

struct SceneOptions {
  std::optional<int> count;           // what it counts is in the scene's description
  double ratio = 100;                 // mass ratio of chain, chainswing and heavy
  std::optional<std::uint64_t> seed;  // of the random draws; the scene's own when absent
  // of all bodies; the scene's own when absent
  std::optional<double> friction;  // static and kinetic
  std::optional<double> restitution;
  std::optional<double> drag;           // linear and angular, of bodies that move [1/s]
  std::optional<double> joint_damping;  // of all joints [N m s/rad]
};

/// What metrics need to know of a body.
struct SceneBody {
  BodyId id;
  BodyKind kind = BodyKind::dynamic;
  ShapeDef shape;
  Pose start;
  int group = 0;  // ragdoll or chain, from 1; 0: none
  int bone = 0;   // index within the group
};

/// A box that was put on another one, or on the floor y = 0.
struct Support {
  int upper = 0;
  int lower = -1;  // -1: the floor
};

/// A built scene: the objects in the order of their creation, and what it was meant to look like.
struct Scene {
  std::string name;
  int count = 0;
  double ratio = 1;
  std::vector<SceneBody> bodies;  // fixed ones too
  std::vector<JointId> joints;
  std::vector<Support> supports;
  std::vector<KernelDef> kernels;  // of the scene's own: what its bodies do to each other; see add_kernels
  double inner_width = 0;          // of the open-lidded box; 0: there is none [m]
  double wall_height = 0;          // [m]
  std::optional<double> floor;     // height of the ground, where there is one [m]
};

struct SceneInfo {
  std::string_view name;
  std::string_view description;
  int default_count, max_count;
  bool own_kernels = false;  // has kernels of its own, which other engines do not run
};

std::span<const SceneInfo> list();

/// Builds a scene into an empty world, and sets the world's gravity to (0, -9.81, 0).
/// Errors: unknown_name; bad_argument for a count or ratio outside its range.
Result<Scene> make(std::string_view name, const SceneOptions& options, World& world);

/// Adds the scene's own kernels to a stepper of its world. Errors: those of Stepper::add_kernel.
Status add_kernels(const Scene& scene, World& world, Stepper& stepper);

}  // namespace pcphys::scenes
