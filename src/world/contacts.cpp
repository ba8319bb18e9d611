// Contacts as a host sees them.
#include "world/state.h"

namespace pcphys {

std::array<std::uint32_t, 2> WorldState::ends_of(const ContactKey& key) const {
  const std::uint32_t a = body_ids.row(shapes[key.shape_a].body), b = body_ids.row(shapes[key.shape_b].body);
  if (responds(a)) return {a, b};
  return {b, a};
}

void WorldState::drop_contacts(std::uint32_t row, std::uint32_t last_row) {
  std::uint32_t kept = 1;
  for (std::uint32_t i = 1; i < contact_rows(); i++) {
    auto ends = contacts.ends[i];
    if (ends[0] == row || ends[1] == row) continue;
    for (std::uint32_t& end : ends)
      if (end == last_row) end = row;
    if (kept != i) tables.copy_row(Table::contact, i, kept);
    contacts.keys[kept] = contacts.keys[i];
    contacts.features[kept] = contacts.features[i];
    contacts.ends[kept++] = ends;
  }
  tables.resize(Table::contact, kept);
  contacts.keys.resize(kept);
  contacts.features.resize(kept);
  contacts.ends.resize(kept);
}

std::vector<Contact> World::contacts() const {
  const WorldState& s = state();
  const Tables& t = s.tables;
  std::vector<Contact> found;
  found.reserve(s.contact_rows() - 1);
  for (std::uint32_t row = 1; row < s.contact_rows(); row++) {
    const auto [a, b] = s.contacts.ends[row];
    Contact contact{
        s.body_ids.id<BodyId>(s.bodies[a].index), s.body_ids.id<BodyId>(s.bodies[b].index), t.get3(Buffer::contact, row, 0), {}};
    const Vec3 centre = s.pose(a).position;
    for (std::uint32_t i = 0; i < std::uint32_t(t.get(Buffer::contact, row, 3)); i++)
      contact.points.push_back({centre + t.get3(Buffer::contact, row, 4 + 4 * i), t.get(Buffer::contact, row, 7 + 4 * i),
                                t.get(Buffer::contact, row, 20 + i)});
    found.push_back(std::move(contact));
  }
  return found;
}

}  // namespace pcphys
