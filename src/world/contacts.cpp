// Contacts as a host sees them.
#include <algorithm>

#include "world/state.h"

namespace pcphys {

std::array<std::uint32_t, 2> WorldState::ends_of(const ContactKey& key) const {
  const std::uint32_t a = body_ids.row(shapes[key.shape_a].body), b = body_ids.row(shapes[key.shape_b].body);
  if (responds(a)) return {a, b};
  return {b, a};
}

void WorldState::settle_contacts() {
  if (!drops.any()) return;
  std::uint32_t rows_before = 0;
  for (const auto& ends : contacts.ends) rows_before = std::max({rows_before, ends[0] + 1, ends[1] + 1});
  const std::vector<std::uint32_t> now = drops.rows_now(rows_before);
  drops.clear();
  const auto is_there = [](std::uint32_t row) { return row != ContactDrops::gone; };
  std::uint32_t kept = 1;
  for (std::uint32_t i = 1; i < contact_rows(); i++) {
    const std::array<std::uint32_t, 2> ends{now[contacts.ends[i][0]], now[contacts.ends[i][1]]};
    if (!is_there(ends[0]) || !is_there(ends[1])) {
      for (const std::uint32_t row : ends)
        if (is_there(row)) stir_moving(row);
      continue;
    }
    if (kept != i) tables.copy_row(Table::contact, i, kept);
    contacts.keys[kept] = contacts.keys[i];
    contacts.features[kept] = contacts.features[i];
    contacts.ends[kept++] = ends;
  }
  tables.resize(Table::contact, kept);
  contacts.keys.resize(kept);
  contacts.features.resize(kept);
  contacts.ends.resize(kept);
  contacts_version++;
}

const WorldState& World::settled(const char* call) const try {
  (void)state(call);
  state_->settle_contacts();
  return *state_;
} catch (...) {
  detail::no_memory_for(call);
}

std::vector<Contact> World::contacts() const try {
  const WorldState& s = settled();
  const Tables& t = s.tables;
  std::vector<Contact> found;
  found.reserve(s.contact_rows() - 1);
  for (std::uint32_t row = 1; row < s.contact_rows(); row++) {
    const auto [a, b] = s.contacts.ends[row];
    Contact contact{s.body_ids.id<BodyId>(s.bodies[a].index),
                    s.body_ids.id<BodyId>(s.bodies[b].index),
                    t.get3(Buffer::contact, row, 0),
                    {}};
    const Vec3 centre = s.pose(a).position;
    for (std::uint32_t i = 0; i < std::uint32_t(t.get(Buffer::contact, row, 3)); i++)
      contact.points.push_back({centre + t.get3(Buffer::contact, row, 4 + 4 * i),
                                t.get(Buffer::contact, row, 7 + 4 * i), t.get(Buffer::contact, row, 20 + i)});
    found.push_back(std::move(contact));
  }
  return found;
} catch (...) {
  detail::no_memory_for("World::contacts");
}

}  // namespace pcphys
