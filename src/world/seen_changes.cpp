#include "world/seen_changes.h"

#include "world/state.h"

namespace pcphys {
namespace {

/// Over numbers in their order. It need not be a good hash: two states of one world are compared.
struct Sum {
  std::uint64_t value = 14695981039346656037ull;
  void add(std::uint64_t x) {
    value = (value ^ x) * 1099511628211ull;
    value ^= value >> 29;
  }
};

/// Objects, kinds and filters.
std::uint64_t sum_structure(const WorldState& s) {
  Sum sum;
  for (const BodyRecord& body : s.bodies)
    for (const std::uint64_t x : {std::uint64_t(body.index), std::uint64_t(body.kind), std::uint64_t(body.frozen)})
      sum.add(x);
  for (const JointRecord& joint : s.joints)
    for (const std::uint32_t x : {joint.index, joint.body_a, joint.body_b}) sum.add(x);
  for (const ShapeRecord& shape : s.shapes)
    for (const std::uint64_t x :
         {std::uint64_t(shape.alive), std::uint64_t(shape.body), std::uint64_t(shape.filter.category),
          std::uint64_t(shape.filter.mask), std::uint64_t(shape.filter.group)})
      sum.add(x);
  std::uint64_t pairs = 0;  // in any order
  for (const auto& [pair, why] : s.no_collide) pairs += pair * 1099511628211ull;
  sum.add(pairs);
  return sum.value;
}

std::uint64_t sum_contacts(const WorldState& s) {
  Sum sum;
  for (const ContactKey& key : s.contacts.keys) sum.add(std::uint64_t(key.shape_a) << 32 | key.shape_b);
  return sum.value;
}

/// Who sleeps and who is stirred, in any order: rows move where others go.
std::uint64_t sum_rest(const WorldState& s) {
  std::uint64_t sum = 0;
  for (std::uint32_t row = 0; row < s.bodies.size() && s.sleepers + s.stirred > 0; row++) {
    const bool sleeps = s.tables.get(Buffer::rest, row, rest_asleep) > 0;
    const bool stirs = s.tables.get(Buffer::rest, row, rest_stirred) > 0;
    sum += (2 * std::uint64_t(sleeps) + std::uint64_t(stirs)) * (s.bodies[row].index + 1) * 1099511628211ull;
  }
  return sum;
}

}  // namespace

const char* find_uncounted(WorldState& s) {
  const SeenChanges before = s.seen;
  SeenChanges& now = s.seen;
  now.walked = true;
  now.structure = {s.structure_version, sum_structure(s)};
  now.contacts = {s.contacts_version, sum_contacts(s)};
  now.rest = {s.rest_version, sum_rest(s)};
  now.joint_changes = s.joint_changes;
  now.removals = s.removals;
  if (!before.walked) return nullptr;
  const auto is_counted = [](const SeenChanges::Counter& before, const SeenChanges::Counter& now) {
    return now.count > before.count || (now.count == before.count && now.sum == before.sum);
  };
  if (!is_counted(before.structure, now.structure))
    return "Objects, kinds or filters have changed, and no version says so";
  if (!is_counted(before.contacts, now.contacts)) return "Contacts have changed, and no version says so";
  if (!is_counted(before.rest, now.rest)) return "Other bodies sleep or are stirred, and no version says so";
  if (now.joint_changes < before.joint_changes || now.removals < before.removals) return "A count of changes went back";
  return nullptr;
}

}  // namespace pcphys
