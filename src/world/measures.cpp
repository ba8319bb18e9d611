// What a world tells of itself: energy and momentum, views, the hash, snapshots.
#include <cstring>
#include <span>
#include <string>

#include "world/state.h"

namespace pcphys {
namespace {

/// FNV-1a, 64 bit. Reals are taken by their bits, with -0 as +0.
class Hash {
 public:
  void bytes(const void* data, std::size_t n) {
    for (std::size_t i = 0; i < n; i++) value_ = (value_ ^ static_cast<const unsigned char*>(data)[i]) * 1099511628211ull;
  }
  template <class Scalar> void reals(const Scalar* x, std::uint32_t n) {
    for (std::uint32_t i = 0; i < n; i++) {
      const Scalar s = x[i] == 0 ? Scalar(0) : x[i];
      bytes(&s, sizeof s);
    }
  }
  void index(std::uint32_t i) { bytes(&i, sizeof i); }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037ull;
};

template <class Scalar> void hash_row(Hash& hash, const Tables& t, Table table, std::uint32_t row) {
  for (const PropertySchema& p : properties())
    if (p.table == table && p.role == Role::state)
      hash.reals(t.data<Scalar>(p.buffer) + std::size_t(row) * schema(p.buffer).reals + p.offset, components(p.type));
}

template <class Scalar> std::uint64_t hash_world(const WorldState& s) {
  Hash hash;
  for (std::uint32_t i = 1; i < s.body_ids.size(); i++) {
    if (!s.body_ids.alive(i)) continue;
    hash.index(i);
    hash_row<Scalar>(hash, s.tables, Table::body, s.body_ids.row(i));
  }
  for (std::uint32_t i = 0; i < s.joint_ids.size(); i++) {
    if (!s.joint_ids.alive(i)) continue;
    hash.index(i);
    hash_row<Scalar>(hash, s.tables, Table::joint, s.joint_ids.row(i));
  }
  for (std::uint32_t row = 1; row < s.contact_rows(); row++) {
    hash.index(s.contacts.keys[row].shape_a);
    hash.index(s.contacts.keys[row].shape_b);
    for (std::uint32_t f : s.contacts.features[row]) hash.index(f);
    hash_row<Scalar>(hash, s.tables, Table::contact, row);
  }
  return hash.value();
}

// ---- snapshots -----------------------------------------------------------------------------------------

constexpr char magic[8] = {'p', 'c', 'p', 'h', 'y', 's', '0', '3'};

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

/// Which objects a world holds: a snapshot fits only where this agrees.
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
  return hash.value();
}

/// The last bytes of a snapshot, over all before: what was cut or changed is told apart.
std::uint64_t checksum(std::span<const std::byte> content) {
  Hash hash;
  hash.bytes(content.data(), content.size());
  return hash.value();
}

void write_table(Writer& w, const Tables& t, Table table, std::uint32_t row) {
  for (const PropertySchema& p : properties())
    if (p.table == table && p.role == Role::state)
      w.put(t.bytes(p.buffer).data() + row * t.row_bytes(p.buffer) + p.offset * t.real_bytes(),
            components(p.type) * t.real_bytes());
}
bool read_table(Reader& r, Tables& t, Table table, std::uint32_t row) {
  for (const PropertySchema& p : properties())
    if (p.table == table && p.role == Role::state)
      if (!r.get(t.bytes(p.buffer).data() + row * t.row_bytes(p.buffer) + p.offset * t.real_bytes(),
                 components(p.type) * t.real_bytes()))
        return false;
  return true;
}
std::size_t state_bytes(const Tables& t, Table table) {
  std::size_t n = 0;
  for (const PropertySchema& p : properties())
    if (p.table == table && p.role == Role::state) n += components(p.type) * t.real_bytes();
  return n;
}

}  // namespace

double World::kinetic_energy() const {
  const WorldState& s = *state_;
  double sum = 0;
  for (std::uint32_t row = 1; row < s.bodies.size(); row++) {
    if (s.bodies[row].kind != BodyKind::dynamic) continue;
    const Vec3 v = s.velocity(row);
    sum += 0.5 * s.tables.get(Buffer::mass, row, 3) * dot(v, v) + 0.5 * dot(s.angular_velocity(row), s.momentum_of_rotation(row));
  }
  return sum;
}

double World::potential_energy() const {
  const WorldState& s = *state_;
  double sum = 0;
  for (std::uint32_t row = 1; row < s.bodies.size(); row++)
    sum -= s.tables.get(Buffer::mass, row, 3) * dot(s.gravity, s.pose(row).position);
  return sum;
}

Vec3 World::momentum() const {
  const WorldState& s = *state_;
  Vec3 sum;
  for (std::uint32_t row = 1; row < s.bodies.size(); row++)
    sum = sum + s.tables.get(Buffer::mass, row, 3) * s.tables.get3(Buffer::motion, row, 0);
  return sum;
}

Vec3 World::angular_momentum() const {
  const WorldState& s = *state_;
  Vec3 sum;
  for (std::uint32_t row = 1; row < s.bodies.size(); row++)
    if (s.bodies[row].kind == BodyKind::dynamic)
      sum = sum + s.tables.get3(Buffer::motion, row, 4) +
            s.tables.get(Buffer::mass, row, 3) * cross(s.pose(row).position, s.tables.get3(Buffer::motion, row, 0));
  return sum;
}

std::size_t World::contact_count() const { return state_->contact_rows() - 1; }

Result<PropertyView> World::view(std::string_view property) const {
  const Tables& t = state_->tables;
  for (const PropertySchema& p : properties()) {
    if (p.name != property) continue;
    return PropertyView{t.bytes(p.buffer).data() + p.offset * t.real_bytes(), t.rows(p.table), t.row_bytes(p.buffer),
                        components(p.type), t.precision()};
  }
  return Error{ErrorCode::unknown_name, "There is no property \"" + std::string(property) + "\"; docs/properties.md lists them."};
}

std::size_t World::memory_bytes() const {
  const WorldState& s = *state_;
  return s.tables.memory_bytes() + s.bodies.capacity() * sizeof(BodyRecord) + s.joints.capacity() * sizeof(JointRecord) +
         s.shapes.capacity() * sizeof(ShapeRecord) +
         s.contacts.keys.capacity() * (sizeof(ContactKey) + sizeof(s.contacts.ends[0]) + sizeof(s.contacts.features[0]));
}

std::uint64_t World::hash() const {
  return precision() == Precision::f32 ? hash_world<float>(*state_) : hash_world<double>(*state_);
}

std::vector<std::byte> World::snapshot() const {
  const WorldState& s = *state_;
  Writer w;
  w.put(magic);
  w.put(object_hash(s));
  w.put(s.last_substep);
  w.put(s.gravity);
  for (std::uint32_t row = 1; row < s.bodies.size(); row++) {
    w.put(s.bodies[row].index);
    write_table(w, s.tables, Table::body, row);
  }
  for (std::uint32_t row = 1; row < s.joints.size(); row++) {
    w.put(s.joints[row].index);
    write_table(w, s.tables, Table::joint, row);
  }
  w.put(s.contact_rows());
  for (std::uint32_t row = 1; row < s.contact_rows(); row++) {
    w.put(s.contacts.keys[row]);
    w.put(s.contacts.features[row]);
    write_table(w, s.tables, Table::contact, row);
  }
  w.put(checksum(w.out));
  return w.out;
}

Status World::restore(std::span<const std::byte> snapshot) {
  WorldState& s = *state_;
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
  double substep = 0;
  Vec3 gravity;
  if (!r.get(head) || std::memcmp(head, magic, sizeof magic) != 0 || !r.get(objects)) return cut;
  if (objects != object_hash(s))
    return Error{ErrorCode::bad_snapshot,
                 "The snapshot is of a world with other objects or another precision; restore it into one with the same bodies "
                 "and joints."};
  if (!r.get(substep) || !r.get(gravity)) return cut;

  // the whole length is checked before anything is written, so that a cut snapshot changes nothing
  const std::size_t fixed_part = (s.bodies.size() - 1) * (4 + state_bytes(s.tables, Table::body)) +
                                 (s.joints.size() - 1) * (4 + state_bytes(s.tables, Table::joint));
  const std::size_t offset = sizeof magic + 8 + 8 + sizeof(Vec3) + fixed_part;
  std::uint32_t contacts = 0;
  if (snapshot.size() < offset + 4) return cut;
  std::memcpy(&contacts, snapshot.data() + offset, 4);
  if (contacts < 1 ||
      snapshot.size() != offset + 4 + (contacts - 1) * (sizeof(ContactKey) + 16 + state_bytes(s.tables, Table::contact)))
    return cut;

  s.last_substep = substep;
  s.gravity = gravity;
  std::uint32_t index = 0;
  for (std::size_t i = 1; i < s.bodies.size(); i++) {
    (void)r.get(index);
    (void)read_table(r, s.tables, Table::body, s.body_ids.row(index));
  }
  for (std::size_t i = 1; i < s.joints.size(); i++) {
    (void)r.get(index);
    (void)read_table(r, s.tables, Table::joint, s.joint_ids.row(index));
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
    (void)read_table(r, s.tables, Table::contact, row);
  }
  for (std::uint32_t row = 1; row < s.bodies.size(); row++) s.follow_mark(row);
  for (std::size_t b = 0; b < table_buffer_count; b++) s.tables.touch(Buffer(b));
  s.contacts_version++;
  return {};
}

}  // namespace pcphys
