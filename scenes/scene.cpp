#include "scene.h"

#include <array>
#include <cmath>

#include "builder.h"

namespace pcphys::scenes {
namespace {

struct Entry {
  SceneInfo info;
  void (*build)(Builder&);
};

constexpr Entry entries[] = {
    {{"balls", "section 10.1 of the original: COUNT balls of radius 0.1 to 0.5 m fall into an open-lidded box", 60,
      4'000'000},
     build_balls},
    {{"ragdolls", "section 10.2 of the original: COUNT ragdolls of 12 capsules fall into an open-lidded box", 8,
      400'000},
     build_ragdolls},
    {{"pyramid", "a wall of boxes, COUNT in its lowest row", 20, 1'400}, build_pyramid},
    {{"stack", "COUNT boxes on one another, slightly off centre", 10, 100'000}, build_stack},
    {{"chain", "COUNT links that hang still and a load of RATIO times a link, pushed sideways at 1 m/s", 20, 1'000'000},
     build_chain},
    {{"chainswing", "the same chain, let go when it is level", 20, 1'000'000}, build_chainswing},
    {{"heavy", "a box RATIO times as heavy on a light one (always two boxes)", 2, 2}, build_heavy},
    {{"door", "COUNT free-swinging doors, each hit by a ball", 1, 100'000}, build_door},
    {{"dominoes", "COUNT dominoes along a spiral; a ball knocks over the first", 50, 1'000'000}, build_dominoes},
    {{"hulls", "COUNT random convex hulls of 8 to 32 vertices fall into an open-lidded box", 40, 1'000'000},
     build_hulls},
    {{"ballistic", "COUNT spinning balls in free fall that meet nothing", 1'000, 4'000'000}, build_ballistic},
    {{"magnets", "COUNT balls with poles in an open-lidded box: unlike ones pull, like ones push each other", 72,
      100'000, true},
     build_magnets},
};

constexpr auto infos = [] {
  std::array<SceneInfo, std::size(entries)> result{};
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = entries[i].info;
  return result;
}();

std::string names() {
  std::string text;
  for (const SceneInfo& info : infos) text += (text.empty() ? "" : ", ") + std::string(info.name);
  return text;
}

Result<int> checked_count(const SceneInfo& info, const SceneOptions& options) {
  const int count = options.count.value_or(info.default_count);
  if (info.name == "heavy") return info.default_count;
  if (count >= 0 && count <= info.max_count) return count;
  return Error{ErrorCode::bad_argument, "The count of scene " + std::string(info.name) + " is " +
                                            std::to_string(count) + "; give a number from 0 to " +
                                            std::to_string(info.max_count) + "."};
}

/// What the options say of all bodies and joints.
Status adapt(World& world, const Scene& scene, const SceneOptions& options) {
  for (const SceneBody& body : scene.bodies) {
    Material material = *world.material(body.id);
    if (options.friction) material.static_friction = material.kinetic_friction = *options.friction;
    if (options.restitution) material.restitution = *options.restitution;
    Status ok = options.friction || options.restitution ? world.set_material(body.id, material) : Status();
    if (ok && options.drag && body.kind == BodyKind::dynamic)
      ok = world.set_drag(body.id, *options.drag, *options.drag);
    if (!ok) return ok;
  }
  if (!options.joint_damping) return {};
  for (const JointId joint : scene.joints) {
    AngularSpring spring = world.joint(joint)->spring;
    spring.damping = *options.joint_damping;
    if (Status ok = world.set_spring(joint, spring); !ok) return ok;
  }
  return {};
}

}  // namespace

std::span<const SceneInfo> list() { return infos; }

Result<Scene> make(std::string_view name, const SceneOptions& options, World& world) {
  for (const Entry& entry : entries) {
    if (entry.info.name != name) continue;
    auto count = checked_count(entry.info, options);
    if (!count) return count.error();
    if (!(options.ratio > 0 && std::isfinite(options.ratio)))
      return Error{ErrorCode::bad_argument,
                   "The ratio is " + std::to_string(options.ratio) + "; give a finite number above 0."};
    if (auto status = world.set_gravity({0, -9.81, 0}); !status) return status.error();

    Scene scene;
    scene.name = name;
    scene.count = *count;
    scene.ratio = options.ratio;
    Builder builder(world, scene, options);
    entry.build(builder);
    if (builder.error().code != ErrorCode::none) return builder.error();
    if (auto status = adapt(world, scene, options); !status) return status.error();
    return scene;
  }
  return Error{ErrorCode::unknown_name,
               "There is no scene '" + std::string(name) + "'; choose one of " + names() + "."};
}

Status add_kernels(const Scene& scene, World& world, Stepper& stepper) {
  for (const KernelDef& kernel : scene.kernels)
    if (const Status added = stepper.add_kernel(world, kernel); !added) return added;
  return {};
}

}  // namespace pcphys::scenes
