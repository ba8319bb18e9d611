// Tables of the host's own.
#include <algorithm>
#include <new>
#include <string>
#include <utility>

#include "world/state.h"
#include "world/validate.h"

namespace pcphys {

namespace {
constexpr std::uint32_t most_rows = 1u << 28;

Status check_rows(std::string_view table, std::uint32_t rows) {
  if (rows <= most_rows) return {};
  return Error{ErrorCode::bad_argument, "The table \"" + std::string(table) + "\" cannot have " + std::to_string(rows) +
                                            " rows; give no more than " + std::to_string(most_rows) + "."};
}

/// With the rows as before where there is no memory for more.
Status resize_own(WorldState& s, const OwnTable& table, std::uint32_t rows) {
  if (Status ok = check_rows(table.name, rows); !ok) return ok;
  const std::uint32_t before = s.tables.rows(table.table);
  try {
    s.tables.resize(table.table, rows + 1);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::buffer_full, "There is no memory for " + std::to_string(rows) + " rows of the table \"" +
                                             table.name + "\"; it has " + std::to_string(before - 1) + " as before."};
  }
  if (before == 2 && rows != 1) s.removals++;  // kernels may read or total its one row
  return {};
}
}  // namespace

Result<TableId> World::add_table(std::string_view name, std::uint32_t rows) try {
  if (Status ok = changeable(); !ok) return ok.error();
  WorldState& s = state();
  if (Status ok = check_name(name, "table"); !ok) return ok.error();
  if (Status ok = check_rows(name, rows); !ok) return ok.error();
  bool there = false;
  for (std::size_t t = 0; t < table_count; t++) there |= pcphys::name(Table(t)) == name;
  for (const OwnTable& t : s.own.tables) there |= t.used && t.name == name;
  if (there) return taken(name, "table", "");
  std::uint32_t k = 0;
  while (k < s.own.tables.size() && s.own.tables[k].used) k++;
  OwnTable added{std::string(name), {}, 1, true};
  make_room(s.own.tables);
  added.table = s.tables.add_table();
  if (k == s.own.tables.size()) s.own.tables.emplace_back();
  OwnTable& t = s.own.tables[k];
  added.generation = t.generation + 1;
  t = std::move(added);
  s.tables.resize(t.table, rows + 1);  // which has no columns yet
  return TableId{own_tables_from + k, t.generation, s.id_world()};
} catch (...) {
  return caught();
}

namespace {
Result<OwnTable*> own_table(WorldState& s, TableId id, const char* what) {
  if (id == body_table || id == joint_table)
    return Error{ErrorCode::bad_argument, std::string("Only a table of the host's own can be ") + what +
                                              "; bodies and joints come and go by create_* and destroy."};
  if (const Result<Table> found = s.table_of(id); !found) return found.error();
  return &s.own.tables[id.index - own_tables_from];
}
}  // namespace

Status World::resize(TableId table, std::uint32_t rows) try {
  if (Status ok = changeable(); !ok) return ok;
  const Result<OwnTable*> found = own_table(state(), table, "resized");
  if (!found) return found.error();
  return resize_own(state(), **found, rows);
} catch (...) {
  return caught();
}

Result<std::uint32_t> World::rows(TableId table) const try {
  const Result<Table> found = state().table_of(table);
  if (!found) return found.error();
  return state().tables.rows(*found) - 1;
} catch (...) {
  return caught();
}

Status World::remove(TableId table) try {
  if (Status ok = changeable(); !ok) return ok;
  WorldState& s = state();
  const Result<OwnTable*> found = own_table(s, table, "removed");
  if (!found) return found.error();
  for (OwnProperty& p : s.own.list)
    if (p.used && p.table == (*found)->table) p.used = false;
  s.tables.remove_table((*found)->table);
  s.removals++;
  (*found)->used = false;
  return {};
} catch (...) {
  return caught();
}

}  // namespace pcphys
