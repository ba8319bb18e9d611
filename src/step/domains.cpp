#include "step/domains.h"

#include <algorithm>
#include <array>

namespace pcphys {
namespace {

bool of_contacts(Domain domain) {
  return domain == Domain::contact || domain == Domain::free_contact || domain == Domain::tree_contact;
}
bool of_joints(Domain domain) {
  return domain == Domain::joint || domain == Domain::free_joint || domain == Domain::tree_joint;
}

}  // namespace

std::vector<std::uint32_t>* list_of(Buffer buffer, Schedule& schedule) {
  switch (buffer) {
    case Buffer::bodies: return &schedule.bodies;
    case Buffer::joint_ends: return &schedule.joints.ends();
    case Buffer::joint_order: return &schedule.joints.order();
    case Buffer::joint_paths: return &schedule.joints.paths();
    case Buffer::tree_blocks: return &schedule.trees.lists().blocks;
    case Buffer::tree_parents: return &schedule.trees.lists().parents;
    case Buffer::tree_ends: return &schedule.trees.lists().ends;
    case Buffer::tree_order: return &schedule.trees.lists().order;
    case Buffer::contact_paths: return &schedule.contacts.paths();
    case Buffer::contact_ends: return &schedule.contacts.ends();
    case Buffer::contact_order: return &schedule.contacts.order();
    case Buffer::nets: return &schedule.nets.list();
    case Buffer::bodies_by_id: return &schedule.own.bodies;
    case Buffer::moving_by_id: return &schedule.own.moving;
    case Buffer::joints_by_id: return &schedule.own.joints;
    case Buffer::joined: return &schedule.own.joined;
    case Buffer::body_joints: return &schedule.own.body_joints;
    case Buffer::near_first: return &schedule.own.near.first;
    case Buffer::near_rows: return &schedule.own.near.rows;
    case Buffer::island_ends: return &schedule.islands.ends();
    case Buffer::island_labels: return &schedule.islands.labels_to_fill();
    default: return nullptr;
  }
}

bool needs_colours(Kernel kernel) {
  static const std::array<bool, kernel_count> known = [] {
    std::array<bool, kernel_count> needs{};
    for (std::size_t k = 0; k < kernel_count; k++)
      for (const Access& a : schema(Kernel(k)).accesses)
        needs[k] |= a.write && a.buffer < Buffer::table_buffers && schema(a.buffer).table == Table::body;
    return needs;
  }();
  return known[std::size_t(kernel)];
}

std::uint32_t side_by_side(Domain domain, const Schedule& schedule) {
  if (domain == Domain::body) return schedule.moving;
  if (of_trees(domain)) return schedule.trees.side_by_side();
  if (domain == Domain::net) return schedule.nets.side_by_side();
  return (of_joints(domain) ? schedule.joints : schedule.contacts).side_by_side();
}
void pack(Domain domain, std::uint32_t lanes, Schedule& schedule) {
  if (of_joints(domain)) schedule.joints.pack(lanes);
  if (of_contacts(domain)) schedule.contacts.pack(lanes);
  if (of_trees(domain)) schedule.trees.pack(lanes);
  if (domain == Domain::net) schedule.nets.pack(lanes);
}
std::span<const Range> ranges_of(Domain domain, const Schedule& schedule, unsigned octave) {
  if (domain == Domain::body) return schedule.ranges(octave);
  if (domain == Domain::row) return schedule.islands.rows();
  if (domain == Domain::edge) return schedule.islands.edges();
  if (domain == Domain::joint) return schedule.joints.ranges(octave);
  if (domain == Domain::free_joint) return schedule.joints.free_ranges(octave);
  if (domain == Domain::tree_joint) return schedule.joints.tree_ranges(octave);
  if (of_trees(domain)) return schedule.trees.ranges(octave);
  if (domain == Domain::net) return schedule.nets.ranges(octave);
  if (domain == Domain::free_contact) return schedule.contacts.free_ranges(octave);
  if (domain == Domain::tree_contact) return schedule.contacts.tree_ranges(octave);
  return schedule.contacts.ranges(octave);
}
std::size_t slots_of(Buffer buffer, Domain domain, const Schedule& schedule) {
  if (buffer == Buffer::contact_reach) return schedule.contacts.reach_slots();
  if (of_trees(domain)) return schedule.trees.slots();
  if (domain == Domain::net) return schedule.nets.slots();
  return (of_joints(domain) ? schedule.joints : schedule.contacts).slots();
}
std::uint64_t version_of(Buffer buffer, const WorldState& state, const Schedule& schedule) {
  if (of_table(buffer)) return state.tables.version(buffer) + 1;
  if (buffer == Buffer::bodies) return schedule.bodies_version + 1;
  if (buffer == Buffer::joint_ends || buffer == Buffer::joint_order || buffer == Buffer::joint_paths)
    return schedule.joints.version() + 1;
  if (buffer == Buffer::contact_ends || buffer == Buffer::contact_order || buffer == Buffer::contact_paths)
    return schedule.contacts.version() + 1;
  if (buffer == Buffer::bodies_by_id || buffer == Buffer::moving_by_id || buffer == Buffer::joints_by_id ||
      buffer == Buffer::joined || buffer == Buffer::body_joints)
    return schedule.own.version + 1;
  if (buffer == Buffer::near_first || buffer == Buffer::near_rows) return schedule.own.near.version + 1;
  if (buffer == Buffer::island_ends) return schedule.islands.version() + 1;
  if (buffer == Buffer::nets) return schedule.nets.version() + 1;
  return schedule.trees.version() + 1;
}

}  // namespace pcphys
