// The state of a world as bytes: its hash, and snapshots.
#include <array>
#include <cstring>
#include <span>
#include <string>

#include "pcphys/constants.h"
#include "world/state.h"

namespace pcphys {
namespace {

/// FNV-1a, 64 bit. Reals are taken by their bits, with -0 as +0.
class Hash {
 public:
  void bytes(const void* data, std::size_t n) {
    for (std::size_t i = 0; i < n; i++) value_ = (value_ ^ static_cast<const unsigned char*>(data)[i]) * 1099511628211ull;
  }
  template <class Scalar> void reals(const std::byte* p, std::size_t n) {
    for (std::size_t i = 0; i < n; i += sizeof(Scalar)) {
      Scalar x;
      std::memcpy(&x, p + i, sizeof x);
      if (x == 0) x = 0;
      bytes(&x, sizeof x);
    }
  }
  void index(std::uint32_t i) { bytes(&i, sizeof i); }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037ull;
};

/// What of a table is state, and where it stands.
class StateRows {
 public:
  StateRows(const WorldState& s, Table table) : tables_(s.tables), fields_(fields(s.tables, s.own, table, Role::state)) {
    for (const Field& f : fields_) bytes_ += f.bytes;
  }
  /// Those in the buffer alone, or all others.
  StateRows within(Buffer buffer, bool within = true) const {
    StateRows part = *this;
    std::erase_if(part.fields_, [&](const Field& f) { return (f.buffer == buffer) != within; });
    return part;
  }
  std::size_t bytes() const { return bytes_; }  // of a row
  const Tables& tables() const { return tables_; }
  /// what(field, where it begins in the buffer)
  template <class Do> void each(std::uint32_t row, Do&& what) const {
    for (const Field& f : fields_) what(f, row * tables_.row_bytes(f.buffer) + f.offset);
  }
  void hash(Hash& hash, std::uint32_t row) const {
    each(row, [&](const Field& f, std::size_t at) {
      const std::byte* p = tables_.bytes(f.buffer).data() + at;
      if (f.type == PropertyType::int32 || f.type == PropertyType::uint32)
        hash.bytes(p, f.bytes);
      else if (number_bytes(f.type, tables_.real_bytes()) == 4)
        hash.reals<float>(p, f.bytes);
      else
        hash.reals<double>(p, f.bytes);
    });
  }

 private:
  const Tables& tables_;
  std::vector<Field> fields_;
  std::size_t bytes_ = 0;
};

std::uint64_t hash_world(const WorldState& s) {
  Hash hash;
  const StateRows all(s, Table::body), bodies = all.within(Buffer::rest, false), rest = all.within(Buffer::rest);
  const StateRows joints(s, Table::joint), contacts(s, Table::contact);
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
    const StateRows rows(s, t.table);
    hash.bytes(t.name.data(), t.name.size());
    for (std::uint32_t row = 1; row < s.tables.rows(t.table); row++) rows.hash(hash, row);
  }
  return hash.value();
}

// ---- snapshots -----------------------------------------------------------------------------------------

constexpr char magic[8] = {'p', 'c', 'p', 'h', 'y', 's', '0', '6'};

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
  template <class T> bool get(T& value) { return get(&value, sizeof value); }
  bool get(void* data, std::size_t n) {
    if (in_.size() < n) return false;
    if (n) std::memcpy(data, in_.data(), n);
    in_ = in_.subspan(n);
    return true;
  }
  bool done() const { return in_.empty(); }

 private:
  std::span<const std::byte> in_;
};

/// Which objects and properties of the host's own a world holds: a snapshot fits only where this agrees.
std::uint64_t object_hash(const WorldState& s) {
  Hash hash;
  hash.index(std::uint32_t(s.tables.precision()));
  for (const IdPool* pool : {&s.body_ids, &s.joint_ids})
    for (std::uint32_t i = 0; i < pool->size(); i++)
      if (pool->alive(i)) {
        hash.index(i);
        hash.index(pool->generation(i));
      }
  hash.index(std::uint32_t(s.shapes.size()));
  for (const OwnProperty& p : s.own.list) {
    if (!p.used || p.role != Role::state) continue;
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
  rows.each(row, [&](const Field& f, std::size_t at) { (void)r.get(s.tables.bytes(f.buffer).data() + at, f.bytes); });
}

}  // namespace

std::uint64_t World::hash() const { return hash_world(state()); }

std::vector<std::byte> World::snapshot() const {
  const WorldState& s = state();
  const StateRows bodies(s, Table::body), joints(s, Table::joint), contacts(s, Table::contact);
  Writer w;
  w.put(magic);
  w.put(object_hash(s));
  w.put(s.last_substep);
  w.put(s.soft_substep);
  w.put(s.gravity);
  for (std::uint32_t row = 1; row < s.bodies.size(); row++) {
    w.put(s.bodies[row].index);
    write_row(w, bodies, row);
  }
  for (std::uint32_t row = 1; row < s.joints.size(); row++) {
    w.put(s.joints[row].index);
    write_row(w, joints, row);
  }
  w.put(s.contact_rows());
  for (std::uint32_t row = 1; row < s.contact_rows(); row++) {
    w.put(s.contacts.keys[row]);
    w.put(s.contacts.features[row]);
    write_row(w, contacts, row);
  }
  for (const OwnTable& t : s.own.tables) {
    if (!t.used) continue;
    const StateRows rows(s, t.table);
    for (std::uint32_t row = 1; row < s.tables.rows(t.table); row++) write_row(w, rows, row);
  }
  w.put(checksum(w.out));
  return w.out;
}

Status World::restore(std::span<const std::byte> snapshot) {
  if (Status ok = changeable(); !ok) return ok;
  WorldState& s = state();
  const Error cut{ErrorCode::bad_snapshot, "These bytes are no whole snapshot; take them from World::snapshot, unchanged."};
  std::uint64_t sum = 0;
  if (snapshot.size() < sizeof sum) return cut;
  const std::size_t content = snapshot.size() - sizeof sum;
  std::memcpy(&sum, snapshot.data() + content, sizeof sum);
  snapshot = snapshot.first(content);
  if (sum != checksum(snapshot)) return cut;
  Reader r(snapshot);
  char head[8];
  std::uint64_t objects = 0;
  double substep = 0, soft_substep = 0;
  Vec3 gravity;
  if (!r.get(head) || std::memcmp(head, magic, sizeof magic) != 0 || !r.get(objects)) return cut;
  if (objects != object_hash(s))
    return Error{ErrorCode::bad_snapshot,
                 "The snapshot is of a world with other objects, properties or another precision; restore it into one with the "
                 "same bodies, joints, properties and tables."};
  if (!r.get(substep) || !r.get(soft_substep) || !r.get(gravity)) return cut;

  // the whole length is checked before anything is written, so that a cut snapshot changes nothing
  const StateRows body_rows(s, Table::body), joint_rows(s, Table::joint), contact_rows(s, Table::contact);
  const std::size_t fixed_part =
      (s.bodies.size() - 1) * (4 + body_rows.bytes()) + (s.joints.size() - 1) * (4 + joint_rows.bytes());
  std::size_t own_part = 0;
  for (const OwnTable& t : s.own.tables)
    if (t.used) own_part += (s.tables.rows(t.table) - 1) * StateRows(s, t.table).bytes();
  const std::size_t offset = sizeof magic + 8 + 2 * 8 + sizeof(Vec3) + fixed_part;
  std::uint32_t contacts = 0;
  if (snapshot.size() < offset + 4) return cut;
  std::memcpy(&contacts, snapshot.data() + offset, 4);
  if (contacts < 1 ||
      snapshot.size() != offset + 4 + (contacts - 1) * (sizeof(ContactKey) + 16 + contact_rows.bytes()) + own_part)
    return cut;

  s.last_substep = substep;
  s.soft_substep = soft_substep;
  s.settling = constants::rounds;
  s.gravity = gravity;
  std::uint32_t index = 0;
  for (std::size_t i = 1; i < s.bodies.size(); i++) {
    (void)r.get(index);
    read_row(r, s, body_rows, s.body_ids.row(index));
  }
  for (std::size_t i = 1; i < s.joints.size(); i++) {
    (void)r.get(index);
    read_row(r, s, joint_rows, s.joint_ids.row(index));
  }
  (void)r.get(contacts);
  s.tables.resize(Table::contact, contacts);
  s.contacts.keys.resize(contacts);
  s.contacts.ends.assign(contacts, {0, 0});
  s.contacts.features.resize(contacts);
  for (std::uint32_t row = 1; row < contacts; row++) {
    (void)r.get(s.contacts.keys[row]);
    s.contacts.ends[row] = s.ends_of(s.contacts.keys[row]);
    (void)r.get(s.contacts.features[row]);
    read_row(r, s, contact_rows, row);
  }
  for (const OwnTable& t : s.own.tables) {
    if (!t.used) continue;
    const StateRows rows(s, t.table);
    for (std::uint32_t row = 1; row < s.tables.rows(t.table); row++) read_row(r, s, rows, row);
  }
  for (std::uint32_t row = 1; row < s.bodies.size(); row++) s.follow_mark(row);
  s.count_rest();
  s.tables.touch_all();
  s.contacts_version++;
  return {};
}

}  // namespace pcphys
