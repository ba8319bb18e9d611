// Properties by name and by handle: the library's, and those that a host adds.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "world/state.h"
#include "world/validate.h"

namespace pcphys {
namespace {

std::string quoted(std::string_view text) { return "\"" + std::string(text) + "\""; }

/// What is known of a property, whoever brought it.
struct Found {
  PropertyInfo info;
  Table table{};
  Buffer buffer{};
  std::uint32_t offset = 0;  // bytes in the row
  Id<struct AnyPropertyTag> id;
};

Found listed(const WorldState& s, std::uint32_t k) {
  const PropertySchema& p = properties()[k];
  return {{p.name, p.unit, name(p.table), p.type, p.role, false},
          p.table,
          p.buffer,
          std::uint32_t(p.offset * s.tables.real_bytes()),
          {k, 1, s.id_world()}};
}
Found own(const WorldState& s, std::uint32_t k) {
  const OwnProperty& p = s.own.list[k];
  return {{p.name, p.unit, s.own.table_name(p.table), p.type, p.role, !p.name.starts_with(own_prefix)},
          p.table,
          p.buffer,
          0,
          {std::uint32_t(pcphys::properties().size()) + k, p.generation, s.id_world()}};
}
template <class Do> void each_property(const WorldState& s, Do&& what) {
  for (std::uint32_t k = 0; k < properties().size(); k++) what(listed(s, k));
  for (std::uint32_t k = 0; k < s.own.list.size(); k++)
    if (s.own.list[k].used) what(own(s, k));
}
bool by_name(const WorldState& s, std::string_view name, Found& found) {
  bool any = false;
  each_property(s, [&](const Found& f) {
    if (f.info.name == name) found = f, any = true;
  });
  return any;
}
template <class Id> bool by_id(const WorldState& s, Id id, Found& found) {
  const std::uint32_t listed_count = std::uint32_t(properties().size());
  if (id.world != s.id_world()) return false;
  if (id.index < listed_count) {
    found = listed(s, id.index);
    return id.generation == 1;
  }
  const std::uint32_t k = id.index - listed_count;
  if (k >= s.own.list.size() || !s.own.list[k].used || s.own.list[k].generation != id.generation) return false;
  found = own(s, k);
  return true;
}
Error unknown(std::string_view name) {
  return {ErrorCode::unknown_name, "There is no property " + quoted(name) +
                                       "; docs/properties.md lists those of the library, World::properties all."};
}

/// Words of C++ and GLSL, and types of kernels, that a property could be called;
/// of GLSL's samplers and images see check_name.
constexpr std::string_view reserved_words[] = {"Mask",        "Mat3",         "Quad",
                                               "Quaternion",  "Real",         "Sym3",
                                               "Vec3",        "active",       "alignas",
                                               "alignof",     "and",          "and_eq",
                                               "asm",         "atomic_uint",  "attribute",
                                               "auto",        "bitand",       "bitor",
                                               "bool",        "break",        "buffer",
                                               "bvec2",       "bvec3",        "bvec4",
                                               "case",        "cast",         "catch",
                                               "centroid",    "char",         "char16_t",
                                               "char32_t",    "char8_t",      "class",
                                               "co_await",    "co_return",    "co_yield",
                                               "coherent",    "common",       "compl",
                                               "concept",     "const",        "const_cast",
                                               "consteval",   "constexpr",    "constinit",
                                               "continue",    "decltype",     "default",
                                               "delete",      "discard",      "dmat2",
                                               "dmat2x2",     "dmat2x3",      "dmat2x4",
                                               "dmat3",       "dmat3x2",      "dmat3x3",
                                               "dmat3x4",     "dmat4",        "dmat4x2",
                                               "dmat4x3",     "dmat4x4",      "do",
                                               "double",      "dvec2",        "dvec3",
                                               "dvec4",       "dynamic_cast", "else",
                                               "enum",        "explicit",     "export",
                                               "extern",      "external",     "false",
                                               "filter",      "fixed",        "flat",
                                               "float",       "for",          "friend",
                                               "fvec2",       "fvec3",        "fvec4",
                                               "goto",        "half",         "highp",
                                               "hvec2",       "hvec3",        "hvec4",
                                               "if",          "in",           "inline",
                                               "inout",       "input",        "int",
                                               "invariant",   "ivec2",        "ivec3",
                                               "ivec4",       "layout",       "long",
                                               "lowp",        "main",         "mat2",
                                               "mat2x2",      "mat2x3",       "mat2x4",
                                               "mat3",        "mat3x2",       "mat3x3",
                                               "mat3x4",      "mat4",         "mat4x2",
                                               "mat4x3",      "mat4x4",       "mediump",
                                               "mutable",     "namespace",    "new",
                                               "noexcept",    "noinline",     "noperspective",
                                               "not",         "not_eq",       "nullptr",
                                               "operator",    "or",           "or_eq",
                                               "out",         "output",       "partition",
                                               "patch",       "precise",      "precision",
                                               "private",     "protected",    "public",
                                               "readonly",    "register",     "reinterpret_cast",
                                               "requires",    "resource",     "restrict",
                                               "return",      "sample",       "shared",
                                               "short",       "signed",       "sizeof",
                                               "smooth",      "static",       "static_assert",
                                               "static_cast", "struct",       "subroutine",
                                               "superp",      "switch",       "template",
                                               "this",        "thread_local", "throw",
                                               "true",        "try",          "typedef",
                                               "typeid",      "typename",     "uint",
                                               "uniform",     "union",        "unsigned",
                                               "using",       "uvec2",        "uvec3",
                                               "uvec4",       "varying",      "vec2",
                                               "vec3",        "vec4",         "virtual",
                                               "void",        "volatile",     "wchar_t",
                                               "while",       "writeonly",    "xor",
                                               "xor_eq"};

}  // namespace

Status check_name(std::string_view name, const char* what) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  bool fits = !name.empty() && letter(name[0]) && name.find("__") == name.npos && name.size() <= 64;
  for (const char c : name) fits &= letter(c) || (c >= '0' && c <= '9') || c == '_';
  for (const std::string_view reserved :
       {std::string_view("gl_"), own_prefix, std::string_view("PC_"), std::string_view("io_")})
    fits &= !name.starts_with(reserved);
  if (!fits)
    return Error{ErrorCode::bad_argument,
                 "The name of a " + std::string(what) + " is " + quoted(name) +
                     "; it must begin with a letter, hold up to 64 letters, digits and single underscores, "
                     "and not begin with gl_, pc_ or io_."};
  bool reserved = std::ranges::find(reserved_words, name) != std::end(reserved_words);
  for (const std::string_view kind : {"sampler", "isampler", "usampler", "image", "iimage", "uimage"})
    for (const std::string_view of : {"1D", "2D", "3D", "Cube", "Buffer"})
      reserved |= name.starts_with(kind) && name.substr(kind.size()).starts_with(of);
  if (reserved)
    return Error{ErrorCode::bad_argument, "A " + std::string(what) + " cannot be called " + quoted(name) +
                                              ": that is a word of C++ or GLSL, in which kernels are written."};
  return {};
}

Error taken(std::string_view name, const char* what, std::string_view by) {
  return {ErrorCode::name_taken, "There is a " + std::string(what) + " " + quoted(name) + " already" + std::string(by) +
                                     "; choose another name."};
}

namespace {

/// Of a property of the host's own: whatever its type can hold.
Status check_numbers(PropertyType type, const double* numbers, std::string_view name, std::size_t real_bytes) {
  if (type == PropertyType::int32 || type == PropertyType::uint32) return {};
  const bool single = number_bytes(type, real_bytes) == 4;
  const double most = single ? std::numeric_limits<float>::max() : std::numeric_limits<double>::max();
  for (std::uint32_t c = 0; c < components(type); c++)
    if (!(std::fabs(numbers[c]) <= most))
      return Error{ErrorCode::not_finite, "The value of the property " + quoted(name) + " is " + number(numbers[c]) +
                                              "; it must be finite, and no larger than " + number(most) + "."};
  return {};
}

/// The row of an object in the property's table.
Result<std::uint32_t> find_row(const WorldState& s, const Found& f, RowOf object) {
  constexpr const char* kinds[] = {"body", "joint", "row of a table of the host's own"};
  const RowOf::Kind wanted = f.table == Table::body    ? RowOf::Kind::body
                             : f.table == Table::joint ? RowOf::Kind::joint
                                                       : RowOf::Kind::row;
  if (object.kind != wanted)
    return Error{ErrorCode::bad_argument, "The property " + quoted(f.info.name) + " is of the table " +
                                              quoted(f.info.table) + "; ask with a " + kinds[std::size_t(wanted)] +
                                              "."};
  if (object.kind == RowOf::Kind::row) {
    if (object.id.index == 0 || object.id.index >= s.tables.rows(f.table))
      return Error{ErrorCode::bad_argument, "The table " + quoted(f.info.table) + " has rows 1 to " +
                                                std::to_string(s.tables.rows(f.table) - 1) + "; there is no row " +
                                                std::to_string(object.id.index) + "."};
    return object.id.index;
  }
  const IdPool& pool = object.kind == RowOf::Kind::body ? s.body_ids : s.joint_ids;
  if (!pool.valid(object.id)) return stale(kinds[std::size_t(object.kind)]);
  return pool.row(object.id.index);
}

}  // namespace

std::string_view name(Role role) {
  constexpr std::string_view names[] = {"input", "state", "derived", "scratch", "host"};
  return names[std::size_t(role)];
}
std::string_view name(PropertyType type) {
  constexpr std::string_view names[] = {"real", "vec3",    "quat",    "sym3",  "vec4",
                                        "mat3", "float32", "float64", "int32", "uint32"};
  return names[std::size_t(type)];
}
std::uint32_t components(PropertyType type) {
  constexpr std::uint32_t counts[] = {1, 3, 4, 6, 4, 9, 1, 1, 1, 1};
  return counts[std::size_t(type)];
}

Result<Table> WorldState::table_of(TableId id) const {
  if (id == body_table) return Table::body;
  if (id == joint_table) return Table::joint;
  const std::uint32_t k = id.index - own_tables_from;
  if (id.index < own_tables_from || k >= own.tables.size() || !own.tables[k].used ||
      own.tables[k].generation != id.generation || id.world != id_world())
    return stale("table");
  return own.tables[k].table;
}

Result<PropertyView> World::view(std::string_view property) const try {
  const Tables& t = settled().tables;
  Found f;
  if (!by_name(state(), property, f)) return unknown(property);
  const PropertyType type = f.info.type;
  return PropertyView{t.bytes(f.buffer).data() + f.offset,
                      t.rows(f.table),
                      t.row_bytes(f.buffer),
                      components(type),
                      number_bytes(type, t.real_bytes()) == 4 ? Precision::f32 : Precision::f64,
                      type};
} catch (...) {
  return caught();
}

Result<World::AnyProperty> World::add_property(std::string_view name, PropertyType type, const double* initial,
                                               std::string_view unit, TableId table, Role role) try {
  WorldState& s = state();
  Status ok = changeable();
  if (ok) ok = check_name(name, "property");
  if (ok) ok = check_numbers(type, initial, name, s.tables.real_bytes());
  if (ok && role > Role::host)
    ok = Error{ErrorCode::bad_argument,
               "The role of a property is none that there is; use one of Role, such as Role::host."};
  if (!ok) return ok.error();
  Found there;
  if (by_name(s, name, there)) return taken(name, "property", there.info.own ? "" : " among those of the library");
  const Result<Table> of = s.table_of(table);
  if (!of) return of.error();
  const std::size_t real = s.tables.real_bytes();
  std::array<std::byte, 12 * 8> row{};
  for (std::uint32_t c = 0; c < components(type); c++)
    write_number(row.data() + c * number_bytes(type, real), type, real, initial[c]);
  OwnProperty added{std::string(name), std::string(unit), type, role, *of, {}};
  make_room(s.own.list);
  added.buffer = s.tables.add(*of, std::span(row).first(own_row_bytes(type, real)));
  const std::uint32_t k = s.own.add(std::move(added));
  return AnyProperty{std::uint32_t(pcphys::properties().size()) + k, s.own.list[k].generation, s.id_world()};
} catch (...) {
  return caught();
}

Status World::remove_property(std::string_view name) try {
  if (Status ok = changeable(); !ok) return ok;
  WorldState& s = state();
  Found f;
  if (!by_name(s, name, f)) return unknown(name);
  if (!f.info.own)
    return Error{ErrorCode::bad_argument,
                 "The property " + quoted(name) + " is the library's; only a host's own can be removed."};
  s.tables.remove(f.buffer);
  s.removals++;
  s.own.list[f.id.index - pcphys::properties().size()].used = false;
  return {};
} catch (...) {
  return caught();
}

Result<World::AnyProperty> World::find_property(std::string_view name, PropertyType type) const try {
  Found f;
  if (!by_name(state(), name, f)) return unknown(name);
  if (f.info.type != type)
    return Error{ErrorCode::wrong_type, "The property " + quoted(name) + " holds values of type " +
                                            std::string(pcphys::name(f.info.type)) + ", not " +
                                            std::string(pcphys::name(type)) + "."};
  return AnyProperty{f.id.index, f.id.generation, f.id.world};
} catch (...) {
  return caught();
}

Status World::read(AnyProperty property, RowOf object, double* numbers) const try {
  const WorldState& s = state();
  Found f;
  if (!by_id(s, property, f)) return stale("property");
  const Result<std::uint32_t> row = find_row(s, f, object);
  if (!row) return row.error();
  const std::size_t real = s.tables.real_bytes();
  const std::byte* p = s.tables.bytes(f.buffer).data() + *row * s.tables.row_bytes(f.buffer) + f.offset;
  for (std::uint32_t c = 0; c < components(f.info.type); c++)
    numbers[c] = read_number(p + c * number_bytes(f.info.type, real), f.info.type, real);
  return {};
} catch (...) {
  return caught();
}

Status World::write(AnyProperty property, RowOf object, const double* numbers) try {
  if (Status ok = changeable(); !ok) return ok;
  WorldState& s = state();
  Found f;
  if (!by_id(s, property, f)) return stale("property");
  if (!f.info.own)
    return Error{ErrorCode::bad_argument,
                 "The property " + quoted(f.info.name) +
                     " is the library's, and others follow from it; use the function of World that sets it."};
  if (Status ok = check_numbers(f.info.type, numbers, f.info.name, s.tables.real_bytes()); !ok) return ok;
  const Result<std::uint32_t> row = find_row(s, f, object);
  if (!row) return row.error();
  const std::size_t real = s.tables.real_bytes();
  std::byte* p = s.tables.bytes(f.buffer).data() + *row * s.tables.row_bytes(f.buffer);
  bool changed = false;
  for (std::uint32_t c = 0; c < components(f.info.type); c++) {
    std::byte* const number = p + c * number_bytes(f.info.type, real);
    const double before = read_number(number, f.info.type, real);
    write_number(number, f.info.type, real, numbers[c]);
    changed |= read_number(number, f.info.type, real) != before;
  }
  s.tables.touch(f.buffer);
  if (changed && s.own.named(f.buffer)) s.stir_reader(f.table, *row);
  return {};
} catch (...) {
  return caught();
}

std::vector<PropertyInfo> World::properties() const try {
  std::vector<PropertyInfo> all;
  each_property(state(), [&](const Found& f) { all.push_back(f.info); });
  return all;
} catch (...) {
  detail::no_memory_for("World::properties");
}

}  // namespace pcphys
