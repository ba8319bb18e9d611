// Pins the one list of everything that is stored (properties.inl) and the one list of kernels: properties lie
// inside their buffer's row and on no other, names are unique, every kernel binds at most eight buffers and each
// of them once, what a kernel needs is on the lists, and the padding rows stay nothing while steps are made.
#include <map>
#include <set>

#include "support_world.h"
#include "world/schema.h"
#include "world/state.h"

using namespace worldtest;

namespace {
/// The table whose rows a domain visits.
Table own_table(Domain domain) {
  if (one_by_one(domain)) return Table::body;
  const bool joints = domain == Domain::joint || domain == Domain::free_joint || domain == Domain::tree_joint;
  return joints || of_trees(domain) || domain == Domain::net ? Table::joint : Table::contact;
}
}  // namespace

TEST_CASE("properties lie inside their buffer's row, aligned, and overlap nowhere") {
  std::map<Buffer, std::vector<std::string_view>> rows;
  std::set<std::string_view> names;
  for (const PropertySchema& p : properties()) {
    INFO(std::string(p.name));
    CHECK(names.insert(p.name).second);
    CHECK(p.table < Table::count);
    CHECK(p.buffer < Buffer::table_buffers);
    CHECK(schema(p.buffer).table == p.table);
    CHECK(p.offset + components(p.type) <= schema(p.buffer).reals);
    if (p.type != PropertyType::real) CHECK(p.offset % 4 == 0);  // GLSL reads rows four reals at a time
    CHECK_FALSE(p.unit.empty());
    auto& row = rows[p.buffer];
    row.resize(schema(p.buffer).reals);
    for (std::uint32_t k = p.offset; k < p.offset + components(p.type); k++) {
      CHECK_MESSAGE(row[k].empty(), "shares a place with " << std::string(row[k]));
      row[k] = p.name;
    }
  }
  CHECK(rows.size() == table_buffer_count);  // no buffer without a property
}

TEST_CASE("buffers: rows are whole quads, names are unique, index lists hold no reals") {
  std::set<std::string_view> names;
  for (std::size_t b = 0; b < buffer_count; b++) {
    const BufferSchema& s = schema(Buffer(b));
    INFO(std::string(s.name));
    CHECK(names.insert(s.name).second);
    if (b < table_buffer_count) CHECK(s.reals > 0);
    if (b < table_buffer_count) CHECK(s.reals % 4 == 0);
  }
}

TEST_CASE("kernels bind at most eight buffers, each once, of their own domain or of bodies") {
  std::set<std::string_view> names;
  for (std::size_t k = 0; k < kernel_count; k++) {
    const KernelSchema& s = schema(Kernel(k));
    INFO(std::string(s.name));
    CHECK(names.insert(s.name).second);
    CHECK(s.accesses.size() >= (s.domain == Domain::row ? 1 : 2));
    CHECK(s.accesses.size() <= 8);
    std::set<Buffer> bound;
    bool writes = false, reaches = false;  // reaches: what is not its own
    for (const Access& a : s.accesses) {
      INFO(std::string(schema(a.buffer).name));
      CHECK(bound.insert(a.buffer).second);
      writes |= a.write;
      const Table table = schema(a.buffer).table, own = own_table(s.domain);
      const bool of_tree = of_trees(s.domain) || s.domain == Domain::tree_contact || s.domain == Domain::tree_joint;
      const bool of_node = table == Table::node && of_tree;
      reaches |= table == Table::body || table == Table::node;
      CHECK((table == own || table == Table::body || of_node || (table == Table::touch && own == Table::contact)));
      // the host makes the lists
      if (schema(a.buffer).reals == 0 && a.buffer != Buffer::island_labels) CHECK_FALSE(a.write);
    }
    CHECK(writes);
    if (s.domain == Domain::body) CHECK(bound.contains(Buffer::bodies));
    if (s.domain == Domain::joint || s.domain == Domain::free_joint)
      CHECK((bound.contains(Buffer::joint_ends) || bound.contains(Buffer::joint_order)));
    if (of_trees(s.domain)) {
      CHECK(bound.contains(Buffer::tree_blocks));
      CHECK((!reaches || bound.contains(Buffer::tree_ends) || bound.contains(Buffer::tree_order)));
    }
    if (s.domain == Domain::net) CHECK(bound.contains(Buffer::nets));
    if (s.domain == Domain::tree_joint) CHECK(bound.contains(Buffer::joint_paths));
    if (s.domain == Domain::tree_contact) CHECK(bound.contains(Buffer::contact_paths));
    if (s.domain == Domain::contact || s.domain == Domain::free_contact)
      CHECK((bound.contains(Buffer::contact_ends) || bound.contains(Buffer::contact_order)));
  }
}

TEST_CASE("what kernels change is state or scratch: inputs are the host's alone") {
  std::set<Buffer> written;
  for (std::size_t k = 0; k < kernel_count; k++)
    for (const Access& a : schema(Kernel(k)).accesses)
      if (a.write && a.buffer < Buffer::table_buffers) written.insert(a.buffer);
  for (const PropertySchema& p : properties())
    if (written.contains(p.buffer)) {
      INFO(std::string(p.name));
      CHECK(p.role != Role::input);
    }
}

TEST_CASE("new rows hold the initial values") {
  Tables tables(Precision::f64);
  tables.resize(Table::body, 3);
  tables.resize(Table::joint, 3);
  for (const PropertySchema& p : properties())
    for (std::uint32_t row = 0; row < tables.rows(p.table); row++)
      for (std::uint32_t c = 0; c < components(p.type); c++) {
        INFO(std::string(p.name));
        const double wanted = p.type == PropertyType::quat && c < 3 ? 0 : p.initial;
        CHECK(tables.get(p.buffer, row, p.offset + c) == wanted);
      }
  // a row that is used again does not remember
  tables.set(Buffer::motion, 2, 0, 5);
  tables.set(Buffer::pose, 2, 7, 5);
  tables.resize(Table::body, 2);
  tables.resize(Table::body, 3);
  CHECK(tables.get(Buffer::motion, 2, 0) == 0);
  CHECK(tables.get(Buffer::pose, 2, 7) == 1);
}

TEST_CASE("row 0 of every table does nothing, and stays so, on every mix of places and lanes") {
  require_gl();
  std::vector<StepSettings> all;
  for (std::uint32_t width : {1u, 4u, 8u}) all.push_back(lanes(width));
  for (const Mix& mix : mixes()) all.push_back(mix.settings());
  for (const char* name : {"ragdolls", "door"}) {
    SceneWorld s = scene_world(name, 1);
    const Tables& tables = s.world.state().tables;
    const auto row_0 = [&](Buffer buffer) {
      return std::vector<std::byte>(tables.bytes(buffer).data(),
                                    tables.bytes(buffer).data() + tables.row_bytes(buffer));
    };
    std::vector<std::vector<std::byte>> before;
    for (std::size_t b = 0; b < table_buffer_count; b++) before.push_back(row_0(Buffer(b)));
    for (const StepSettings& settings : all) {
      Stepper stepper(settings);
      run(s.world, stepper, 5);
      for (std::size_t b = 0; b < table_buffer_count; b++) {
        if (schema(Buffer(b)).table == Table::contact) continue;  // made anew in every step; looked at below
        if (Buffer(b) == Buffer::drag_terms) continue;            // as well, of no drag
        bool same = row_0(Buffer(b)) == before[b];
        if (!same && (Buffer(b) == Buffer::inertia || Buffer(b) == Buffer::delta ||
                      Buffer(b) == Buffer::joint_impulse)) {  // -0 is nothing too
          same = true;
          for (std::uint32_t k = 0; k < schema(Buffer(b)).reals; k++) same &= tables.get(Buffer(b), 0, k) == 0;
        }
        std::string values;
        for (std::uint32_t k = 0; k < schema(Buffer(b)).reals; k++)
          values += " " + std::to_string(tables.get(Buffer(b), 0, k));
        INFO(std::string(name) << ", " << std::string(schema(Buffer(b)).name) << ":" << values);
        CHECK(same);
      }
      if (s.world.contact_count() > 0)
        for (std::uint32_t k : {3u, 20u, 21u, 22u, 23u, 24u, 25u, 26u, 27u})
          CHECK(tables.get(Buffer::contact, 0, k) == 0);
    }
  }
}
