// The hash of a world's state.
#include "world/state_rows.h"

namespace pcphys {
namespace {

std::uint64_t hash_world(const WorldState& s) {
  Hash hash;
  const StateRows all(s, Table::body, StateRows::of_hash), bodies = all.within(Buffer::rest, false),
                                                           rest = all.within(Buffer::rest);
  const StateRows joints(s, Table::joint, StateRows::of_hash), contacts(s, Table::contact, StateRows::of_hash);
  for (std::uint32_t i = 1; i < s.body_ids.size(); i++) {
    if (!s.body_ids.alive(i)) continue;
    hash.index(i);
    bodies.hash(hash, s.body_ids.row(i));
  }
  for (std::uint32_t i = 0; s.rests && i < s.body_ids.size(); i++) {  // with sleep off there is nothing to add
    if (!s.body_ids.alive(i) || s.never_rested(s.body_ids.row(i))) continue;
    hash.index(i);
    rest.hash(hash, s.body_ids.row(i));
  }
  for (std::uint32_t i = 0; i < s.joint_ids.size(); i++) {
    if (!s.joint_ids.alive(i)) continue;
    hash.index(i);
    joints.hash(hash, s.joint_ids.row(i));
  }
  for (std::uint32_t row = 1; row < s.contact_rows(); row++) {
    hash.index(s.contacts.keys[row].shape_a);
    hash.index(s.contacts.keys[row].shape_b);
    for (std::uint32_t f : s.contacts.features[row]) hash.index(f);
    contacts.hash(hash, row);
  }
  for (const OwnTable& t : s.own.tables) {
    if (!t.used) continue;
    const StateRows rows(s, t.table, StateRows::of_hash);
    if (rows.bytes() == 0) continue;  // the host's alone
    hash.bytes(t.name.data(), t.name.size());
    for (std::uint32_t row = 1; row < s.tables.rows(t.table); row++) rows.hash(hash, row);
  }
  return hash.value();
}

}  // namespace

std::uint64_t World::hash() const { return hash_world(settled()); }

}  // namespace pcphys
