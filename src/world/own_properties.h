// The host's own properties and tables: names, types, and where they stand in Tables.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pcphys/result.h"
#include "world/tables.h"

namespace pcphys {

/// Of names that the library gives to kernels and columns beside the host's own; no name of the host's begins so.
inline constexpr std::string_view own_prefix = "pc_";

struct OwnProperty {
  std::string name, unit;
  PropertyType type = PropertyType::real;
  Role role = Role::state;
  Table table{};
  Buffer buffer{};
  std::uint32_t generation = 0;
  bool used = false;
  bool named = false;  // by a kernel of some stepper: what comes of steps may follow from it
};
struct OwnTable {
  std::string name;
  Table table{};
  std::uint32_t generation = 0;
  bool used = false;
};

struct OwnProperties {
  /// In the first free place; which.
  std::uint32_t add(OwnProperty property);
  /// Whether a kernel has named the property that stands there; and that one has.
  bool named(Buffer buffer) const;
  void name(Buffer buffer);
  /// Of a table, the library's or the host's own.
  std::string_view table_name(Table table) const;
  /// Of a buffer, and of its table; a list is of none.
  std::pair<std::string_view, std::string_view> names(Buffer buffer) const;
  std::vector<OwnProperty> list;  // property k has the handle properties().size() + k
  std::vector<OwnTable> tables;   // table k has the id own_tables_from + k
};
inline constexpr std::uint32_t own_tables_from = 2;  // after bodies and joints

/// Of a property, table or kernel: names stand in the text of kernels, in C++ and GLSL.
Status check_name(std::string_view name, const char* what);
/// That there is such a name already; `by`: whose, or nothing.
Error taken(std::string_view name, const char* what, std::string_view by);

/// Where a property's numbers stand in a row, the library's or the host's own.
struct Field {
  Buffer buffer{};
  std::uint32_t offset = 0, bytes = 0;  // in the row
  PropertyType type = PropertyType::real;
};
/// Fields of a role, the library's first, in the order of the lists.
std::vector<Field> fields(const Tables& tables, const OwnProperties& own, Table table, Role role);
/// Whether snapshots hold it.
constexpr bool lasts(Role role) { return role == Role::state || role == Role::host; }

/// Bytes of a number of that type.
std::size_t number_bytes(PropertyType type, std::size_t real_bytes);
/// Of a row that holds one value and nothing else: vectors and matrices fill whole quads, as kernels read them.
std::size_t own_row_bytes(PropertyType type, std::size_t real_bytes);
double read_number(const std::byte* p, PropertyType type, std::size_t real_bytes);
void write_number(std::byte* p, PropertyType type, std::size_t real_bytes, double value);

}  // namespace pcphys
