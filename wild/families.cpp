#include <string>

#include "wild/scene.h"

namespace pcphys::wild {
namespace {

constexpr Family all[] = {
    {"encounter", "two bodies of any two shapes meet, graze or miss each other, at 0.1 to 300 m/s", draw_encounter},
    {"passing", "a body passes another with a clearance of 0.1 to 100 mm", draw_passing},
    {"floor", "bodies slid, rolled and thrown over coplanar tiles, stairs, posts and compounds", draw_floor},
    {"pile", "mixed shapes, sizes 1:50, masses 1:1e4, dropped, thrown, made overlapping", draw_pile},
    {"tower", "stacks, walls, slender boxes, loads, dominoes, a see-saw", draw_tower},
    {"joints", "random trees, loops, nets, bridges, limits, motors, springs of joints", draw_joints},
    {"springs", "springs between points, stiffness 1 to 1e9 N/m, masses 1:1e6", draw_springs},
    {"ragdolls", "ragdolls dropped, thrown, dragged, in drums, on bridges", draw_ragdolls},
    {"host", "random calls of a host between the steps", draw_host}};

}  // namespace

std::span<const Family> families() { return all; }

Result<const Family*> find_family(std::string_view name) {
  std::string names;
  for (const Family& f : all) {
    if (f.name == name) return &f;
    names += (names.empty() ? "" : ", ") + std::string(f.name);
  }
  return Error{ErrorCode::unknown_name, "There is no family '" + std::string(name) + "'; choose of " + names + "."};
}

Result<Scene> draw(std::string_view family, std::uint64_t seed) {
  const auto found = find_family(family);
  if (!found) return found.error();
  Builder b(family, seed);
  (*found)->draw(b);
  return std::move(b.scene);
}

}  // namespace pcphys::wild
