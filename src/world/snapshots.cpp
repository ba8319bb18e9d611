// The state of a world as bytes, and back.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pcphys/constants.h"
#include "world/hull.h"
#include "world/state_rows.h"
#include "world/validate.h"

namespace pcphys {
namespace {

constexpr char magic[8] = {'p', 'c', 'p', 'h', 'y', 's', '0', '7'};

class Writer {
 public:
  template <class T> void put(const T& value) { put(&value, sizeof value); }
  void put(const void* data, std::size_t n) {
    const auto* p = static_cast<const std::byte*>(data);
    out.insert(out.end(), p, p + n);
  }
  std::vector<std::byte> out;
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> in) : in_(in) {}
  template <class T> T get() {
    T value;
    std::memcpy(&value, take(sizeof value), sizeof value);
    return value;
  }
  /// The next bytes, which are there.
  const std::byte* take(std::size_t n) {
    const std::byte* p = in_.data();
    in_ = in_.subspan(n);
    return p;
  }
  std::size_t left() const { return in_.size(); }

 private:
  std::span<const std::byte> in_;
};

/// Of contacts also what is no state: hosts are shown it until the next step.
struct Layout {
  explicit Layout(const WorldState& s)
      : bodies(s, Table::body, StateRows::of_snapshots),
        joints(s, Table::joint, StateRows::of_snapshots),
        contacts(s, Table::contact, StateRows::shown) {
    for (const OwnTable& t : s.own.tables) {
      if (!t.used) continue;
      own.emplace_back(StateRows(s, t.table, StateRows::of_snapshots), s.tables.rows(t.table));
      own_bytes += (s.tables.rows(t.table) - 1) * own.back().first.bytes();
    }
    fixed_bytes =
        head_bytes + (s.bodies.size() - 1) * (4 + bodies.bytes()) + (s.joints.size() - 1) * (4 + joints.bytes()) + 4;
    contact_bytes = sizeof(ContactKey) + sizeof(std::array<std::uint32_t, 4>) + contacts.bytes();
  }
  static constexpr std::size_t head_bytes = sizeof magic + 8 + 2 * 8 + sizeof(Vec3);
  StateRows bodies, joints, contacts;
  std::vector<std::pair<StateRows, std::uint32_t>> own;  // of the host's own tables, and how many rows they have
  std::size_t fixed_bytes = 0;                           // up to the number of contact rows
  std::size_t contact_bytes = 0, own_bytes = 0;
};

void hash_shape(Hash& hash, const ShapeRecord& shape) {
  hash.index(shape.body);
  hash.index(std::uint32_t(shape.def.kind));
  hash.bytes(&shape.def.local, sizeof shape.def.local);
  if (shape.def.kind != ShapeKind::hull) return hash.bytes(&shape.def.size, sizeof shape.def.size);
  const std::vector<Vec3>& corners = shape.def.convex.data()->vertices;
  hash.bytes(corners.data(), corners.size() * sizeof(Vec3));
}

/// Which objects and properties of the host's own a world holds, and what stays as it is of them: a snapshot fits only
/// where this agrees.
std::uint64_t object_hash(const WorldState& s) {
  Hash hash;
  hash.index(std::uint32_t(s.tables.precision()));
  for (const IdPool* pool : {&s.body_ids, &s.joint_ids})
    for (std::uint32_t i = 0; i < pool->size(); i++)
      if (pool->alive(i)) {
        hash.index(i);
        hash.index(pool->generation(i));
        if (pool == &s.body_ids) hash.index(std::uint32_t(s.bodies[pool->row(i)].kind));
      }
  for (std::uint32_t row = 1; row < s.joints.size(); row++)
    for (const std::uint32_t of : {s.joints[row].index, s.joints[row].body_a, s.joints[row].body_b}) hash.index(of);
  for (std::uint32_t i = 0; i < s.shapes.size(); i++) {
    if (!s.shapes[i].alive) continue;
    hash.index(i);
    hash_shape(hash, s.shapes[i]);
  }
  for (const OwnProperty& p : s.own.list) {
    if (!p.used || !lasts(p.role)) continue;
    hash.bytes(p.name.data(), p.name.size());
    hash.index(std::uint32_t(p.type));
    hash.index(std::uint32_t(p.table));
  }
  for (const OwnTable& t : s.own.tables) {
    if (!t.used) continue;
    hash.bytes(t.name.data(), t.name.size());
    hash.index(s.tables.rows(t.table));
  }
  return hash.value();
}

/// The last bytes of a snapshot, over all before: what was cut or changed is told apart.
std::uint64_t checksum(std::span<const std::byte> content) {
  Hash hash;
  hash.bytes(content.data(), content.size());
  return hash.value();
}

void write_row(Writer& w, const StateRows& rows, std::uint32_t row) {
  rows.each(row, [&](const Field& f, std::size_t at) { w.put(rows.tables().bytes(f.buffer).data() + at, f.bytes); });
}
void read_row(Reader& r, WorldState& s, const StateRows& rows, std::uint32_t row) {
  rows.each(row, [&](const Field& f, std::size_t at) {
    std::memcpy(s.tables.bytes(f.buffer).data() + at, r.take(f.bytes), f.bytes);
  });
}

/// A row of a snapshot, to be looked at before it is taken.
class Look {
 public:
  Look(const StateRows& rows, const std::byte* bytes) : rows_(rows), bytes_(bytes), real_(rows.tables().real_bytes()) {}

  /// A number of a property of the library's.
  double at(Buffer buffer, std::uint32_t offset) const {
    double value = 0;
    each([&](const Field& f, const std::byte* p) {
      const std::size_t first = f.offset / real_;
      if (f.buffer == buffer && offset >= first && offset < first + f.bytes / real_)
        value = read_number(p + (offset - first) * real_, f.type, real_);
    });
    return value;
  }
  /// Whether all of the library's are.
  bool is_finite() const {
    bool finite = true;
    each([&](const Field& f, const std::byte* p) {
      for (std::size_t at = 0; at < f.bytes && !is_own(f.buffer); at += real_)
        finite = finite && std::isfinite(read_number(p + at, f.type, real_));
    });
    return finite;
  }

 private:
  template <class Do> void each(const Do& what) const {
    const std::byte* p = bytes_;
    rows_.each(0, [&](const Field& f, std::size_t) {
      what(f, p);
      p += f.bytes;
    });
  }
  const StateRows& rows_;
  const std::byte* bytes_;
  std::size_t real_;
};

bool is_flag(double x) { return x == 0 || x == 1; }

/// As who sleeps is, until the host stirs it.
bool is_still(const Look& body) {
  for (std::uint32_t c = 0; c < 3; c++)
    if (body.at(Buffer::motion, c) != 0 || body.at(Buffer::motion, 4 + c) != 0 ||
        body.at(Buffer::velocity_parts, c) != 0)
      return false;
  return true;
}

/// Whether its place is in the range of numbers and its velocities are numbers, however their parts are added up. (Sums
/// of sizes round, so places may reach twice the limit; a force that the host has given may make velocities larger than
/// the next step takes.)
bool in_range(const WorldState& s, std::uint32_t row, const Look& body) {
  double light = 0, place = 0, speed = 0, momentum = 0;
  for (std::uint32_t c = 0; c < 3; c++) {
    light = std::max(light, s.tables.get(Buffer::mass, row, 4 + c));
    place += std::fabs(body.at(Buffer::pose, c)) + std::fabs(body.at(Buffer::pose, 8 + c));
    speed += std::fabs(body.at(Buffer::motion, c)) + std::fabs(body.at(Buffer::velocity_parts, c));
    momentum += std::fabs(body.at(Buffer::motion, 4 + c)) + std::fabs(body.at(Buffer::velocity_parts, 4 + c));
  }
  return place < 2 * constants::largest_state && std::isfinite(speed) && std::isfinite(momentum * std::max(light, 1.0));
}

/// Whether a step could go on from it: as it leaves bodies, which are in the range of numbers, turned by quaternions of
/// unit length, both as they are rounded and with what rounding dropped, and flags. (Impulses may be any numbers: a
/// body that they throw beyond the range is frozen.)
bool is_state(const WorldState& s, std::uint32_t row, const Look& body) {
  if (!body.is_finite()) return false;
  double rounded = 0, whole = 0;
  for (std::uint32_t c = 0; c < 4; c++) {
    const double pose = body.at(Buffer::pose, place::orientation + c);
    const double sum = pose + body.at(Buffer::pose, place::orientation_low + c);
    rounded += pose * pose;
    whole += sum * sum;
  }
  const auto is_unit = [](double square) { return std::fabs(std::sqrt(square) - 1) <= constants::unit_tolerance; };
  const bool stands = s.bodies[row].kind == BodyKind::fixed;
  const double settling = body.at(Buffer::velocity_parts, place::settling), asleep = body.at(Buffer::rest, rest_asleep);
  const double stirred = body.at(Buffer::rest, rest_stirred), quiet = body.at(Buffer::rest, rest_quiet_time);
  const bool single = s.tables.precision() == Precision::f32;
  const auto is_normal = [&](double x) { return x == (single ? double(normal<float>(x)) : normal<double>(x)); };
  const bool freezes = body.at(Buffer::motion, place::phase) == frozen_phase;
  return in_range(s, row, body) && is_unit(rounded) && is_unit(whole) && settling >= 0 &&
         settling <= constants::rounds && quiet >= 0 && is_normal(quiet) && is_flag(asleep) && is_flag(stirred) &&
         !(stands && freezes) && (asleep == 0 || (!stands && !freezes && (stirred > 0 || is_still(body))));
}

/// Of rows that name an object each: every one once.
bool read_indices(Reader& r, const IdPool& ids, std::size_t row_bytes, std::size_t count,
                  const std::function<bool(std::uint32_t, const std::byte*)>& is_good) {
  std::vector<bool> seen(ids.size());
  for (std::size_t i = 0; i < count; i++) {
    const auto index = r.get<std::uint32_t>();
    if (index >= ids.size() || !ids.alive(index) || seen[index]) return false;
    seen[index] = true;
    if (!is_good(ids.row(index), r.take(row_bytes))) return false;
  }
  return true;
}

bool is_contact(const WorldState& s, const ContactKey& key, const Look& contact) {
  if (key.shape_a >= key.shape_b || key.shape_b >= s.shapes.size() || !s.shapes[key.shape_a].alive ||
      !s.shapes[key.shape_b].alive)
    return false;
  const std::uint32_t a = s.shapes[key.shape_a].body, b = s.shapes[key.shape_b].body;
  const auto moves = [&](std::uint32_t body) { return s.bodies[s.body_ids.row(body)].kind == BodyKind::dynamic; };
  if (a == b || !(moves(a) || moves(b))) return false;
  const double points = contact.at(Buffer::contact, place::point_count);
  return points >= 0 && points <= 4 && points == std::floor(points) && contact.is_finite();
}

/// Whether all that stands behind the head is a state of this world. Its length is right.
bool is_content(const WorldState& s, const Layout& layout, Reader r) {
  std::vector<Rest> rests(s.bodies.size(), Rest::any);
  const auto body = [&](std::uint32_t row, const std::byte* bytes) {
    const Look look(layout.bodies, bytes);
    const bool stands = s.bodies[row].kind == BodyKind::fixed || look.at(Buffer::motion, place::phase) == frozen_phase;
    rests[row] = rest_of(stands, look.at(Buffer::rest, rest_stirred) > 0, look.at(Buffer::rest, rest_asleep) > 0);
    return row > 0 && is_state(s, row, look);
  };
  const auto is_closed = [&](std::uint32_t body_a, std::uint32_t body_b) {
    return rest_together(rests[s.body_ids.row(body_a)], rests[s.body_ids.row(body_b)]);
  };
  const auto joint = [&](std::uint32_t row, const std::byte*) {
    return is_closed(s.joints[row].body_a, s.joints[row].body_b);
  };
  if (!read_indices(r, s.body_ids, layout.bodies.bytes(), s.bodies.size() - 1, body) ||
      !read_indices(r, s.joint_ids, layout.joints.bytes(), s.joints.size() - 1, joint))
    return false;
  ContactKey last{};
  for (auto rows = r.get<std::uint32_t>(); rows > 1; rows--) {
    const auto key = r.get<ContactKey>();
    (void)r.take(sizeof(std::array<std::uint32_t, 4>));
    if (key <= last || !is_contact(s, key, Look(layout.contacts, r.take(layout.contacts.bytes()))) ||
        !is_closed(s.shapes[key.shape_a].body, s.shapes[key.shape_b].body))
      return false;
    last = key;
  }
  return true;
}

/// Masses are kept of frozen bodies alone.
void drop_unfrozen(WorldState& s) {
  std::erase_if(s.frozen, [&](const auto& f) { return !s.bodies[s.body_ids.row(f.first)].frozen; });
}

/// Memory for contacts, and for any of the bodies to be frozen: nothing needs more while a snapshot is taken.
void make_room_for(WorldState& s, std::uint32_t contacts) {
  s.tables.reserve(Table::contact, contacts);
  s.contacts.keys.reserve(contacts);
  s.contacts.ends.reserve(contacts);
  s.contacts.features.reserve(contacts);
  for (std::uint32_t row = 1; row < s.bodies.size(); row++)
    if (s.bodies[row].kind != BodyKind::fixed) s.frozen.try_emplace(s.bodies[row].index);
}

void take_content(WorldState& s, const Layout& layout, Reader& r) {
  for (std::size_t i = 1; i < s.bodies.size(); i++)
    read_row(r, s, layout.bodies, s.body_ids.row(r.get<std::uint32_t>()));
  for (std::size_t i = 1; i < s.joints.size(); i++)
    read_row(r, s, layout.joints, s.joint_ids.row(r.get<std::uint32_t>()));
  const auto contacts = r.get<std::uint32_t>();
  s.tables.resize(Table::contact, contacts);
  s.contacts.keys.resize(contacts);
  s.contacts.ends.assign(contacts, {0, 0});
  s.contacts.features.resize(contacts);
  for (std::uint32_t row = 1; row < contacts; row++) {
    s.contacts.keys[row] = r.get<ContactKey>();
    s.contacts.features[row] = r.get<std::array<std::uint32_t, 4>>();
    read_row(r, s, layout.contacts, row);
  }
  for (const auto& [rows, count] : layout.own)
    for (std::uint32_t row = 1; row < count; row++) read_row(r, s, rows, row);
  for (std::uint32_t row = 1; row < s.bodies.size(); row++) s.follow_mark(row);
  drop_unfrozen(s);
  for (std::uint32_t row = 1; row < contacts; row++) s.contacts.ends[row] = s.ends_of(s.contacts.keys[row]);
}

}  // namespace

std::vector<std::byte> World::snapshot() const try {
  const WorldState& s = settled();
  const Layout layout(s);
  Writer w;
  w.out.reserve(layout.fixed_bytes + (s.contact_rows() - 1) * layout.contact_bytes + layout.own_bytes + 8);
  w.put(magic);
  w.put(object_hash(s));
  w.put(s.last_substep);
  w.put(s.soft_substep);
  w.put(s.gravity);
  for (std::uint32_t row = 1; row < s.bodies.size(); row++) {
    w.put(s.bodies[row].index);
    write_row(w, layout.bodies, row);
  }
  for (std::uint32_t row = 1; row < s.joints.size(); row++) {
    w.put(s.joints[row].index);
    write_row(w, layout.joints, row);
  }
  w.put(s.contact_rows());
  for (std::uint32_t row = 1; row < s.contact_rows(); row++) {
    w.put(s.contacts.keys[row]);
    w.put(s.contacts.features[row]);
    write_row(w, layout.contacts, row);
  }
  for (const auto& [rows, count] : layout.own)
    for (std::uint32_t row = 1; row < count; row++) write_row(w, rows, row);
  w.put(checksum(w.out));
  return w.out;
} catch (...) {
  detail::no_memory_for("World::snapshot");
}

Status World::restore(std::span<const std::byte> snapshot) try {
  if (Status ok = changeable(); !ok) return ok;
  WorldState& s = state();
  const Error cut{ErrorCode::bad_snapshot,
                  "These bytes are no whole snapshot; take them from World::snapshot, unchanged."};
  constexpr std::size_t sum_bytes = sizeof(std::uint64_t);
  if (snapshot.size() < Layout::head_bytes + sum_bytes) return cut;
  const std::span<const std::byte> content = snapshot.first(snapshot.size() - sum_bytes);
  if (Reader(snapshot.last(sum_bytes)).get<std::uint64_t>() != checksum(content)) return cut;
  Reader r(content);
  if (std::memcmp(r.take(sizeof magic), magic, sizeof magic) != 0) return cut;
  if (r.get<std::uint64_t>() != object_hash(s))
    return Error{ErrorCode::bad_snapshot,
                 "The snapshot is of a world with other objects, shapes, properties or another precision; restore it "
                 "into one with "
                 "the same bodies, joints, properties and tables."};
  const auto substep = r.get<double>(), soft_substep = r.get<double>();
  const auto gravity = r.get<Vec3>();

  // all of it is looked at before anything is written: bytes that are refused change nothing
  const Layout layout(s);
  if (content.size() < layout.fixed_bytes) return cut;
  const auto contacts = Reader(content.subspan(layout.fixed_bytes - 4)).get<std::uint32_t>();
  if (contacts < 1 || content.size() != layout.fixed_bytes + (contacts - 1) * layout.contact_bytes + layout.own_bytes)
    return cut;
  const auto is_length = [](double h) { return std::isfinite(h) && h >= 0; };
  if (!is_length(substep) || !is_length(soft_substep) || !check_finite(gravity, "gravity") || !is_content(s, layout, r))
    return Error{ErrorCode::bad_snapshot,
                 "These bytes hold numbers that no step leaves; take them from World::snapshot, unchanged."};

  make_room_for(s, contacts);
  s.drops.clear();
  s.last_substep = substep;
  s.soft_substep = soft_substep;
  s.settling = constants::rounds;
  s.gravity = gravity;
  take_content(s, layout, r);
  s.count_rest();
  s.tables.touch_all();
  s.contacts_version++;
  s.restores++;
  return {};
} catch (...) {
  drop_unfrozen(state());  // there was no room for all
  return caught();
}

}  // namespace pcphys
