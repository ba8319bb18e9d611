// The lists of src/kernels as C++: enumerations of tables, buffers, properties and kernels, and what each is.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "pcphys/plan.h"
#include "pcphys/property.h"

namespace pcphys {

enum class Table : std::uint8_t {
#define PC_TABLE(table, doc) table,
#define PC_BUFFER(table, buffer, quads, doc)
#define PC_PROPERTY(table, buffer, offset, type, name, role, initial, unit, doc)
#include "kernels/properties.inl"
#undef PC_TABLE
#undef PC_BUFFER
#undef PC_PROPERTY
  count
};

/// Where each property stands in a row of its buffer [reals], by its name.
namespace place {
#define PC_TABLE(table, doc)
#define PC_BUFFER(table, buffer, quads, doc)
#define PC_PROPERTY(table, buffer, offset, type, name, role, initial, unit, doc) \
  inline constexpr std::uint32_t name = offset;
#include "kernels/properties.inl"
#undef PC_TABLE
#undef PC_BUFFER
#undef PC_PROPERTY
}  // namespace place

/// Everything a kernel can bind. First the tables' buffers (role of a world), then what a step makes.
enum class Buffer : std::uint16_t {
#define PC_TABLE(table, doc)
#define PC_BUFFER(table, buffer, quads, doc) buffer,
#define PC_PROPERTY(table, buffer, offset, type, name, role, initial, unit, doc)
#include "kernels/properties.inl"
#undef PC_TABLE
#undef PC_BUFFER
#undef PC_PROPERTY
  table_buffers,  // how many stand above
  bodies = table_buffers,
  contact_ends,
  contact_order,
  joint_ends,
  joint_order,
  joint_paths,
  tree_blocks,
  tree_parents,
  tree_ends,
  tree_order,
  contact_paths,
  nets,
  bodies_by_id,
  moving_by_id,
  joints_by_id,
  joined,
  body_joints,
  near_first,
  near_rows,
  island_ends,
  island_labels,
#define PC_ROWS(domain, buffer, reals) buffer,
#include "kernels/kernels.inl"
#undef PC_ROWS
  count
};

enum class Kernel : std::uint8_t {
#define PC_KERNEL(name, domain, stage, accesses) name,
#include "kernels/kernels.inl"
#undef PC_KERNEL
  count
};

/// contact: all; free_contact and tree_contact: those whose bodies stand in no tree, and the others. joint: all that
/// stand in no tree; free_joint and tree_joint: the same of these. net: a net of springs; row: every row of bodies;
/// edge: two bodies that act on each other.
enum class Domain : std::uint8_t {
  body,
  contact,
  free_contact,
  tree_contact,
  joint,
  free_joint,
  tree_joint,
  tree,
  tree_nodes,
  net,
  row,
  edge
};

inline constexpr std::size_t table_count = std::size_t(Table::count);
inline constexpr std::size_t table_buffer_count = std::size_t(Buffer::table_buffers);
inline constexpr std::size_t buffer_count = std::size_t(Buffer::count);
inline constexpr std::size_t kernel_count = std::size_t(Kernel::count);
// that are put on a place each; islands are on a device or not in the plan
inline constexpr std::size_t stage_count = 3;
/// Whether its kernels are called element by element, not in slots of several lanes.
constexpr bool one_by_one(Domain domain) {
  return domain == Domain::body || domain == Domain::row || domain == Domain::edge;
}

/// Whether they are of joint trees.
constexpr bool of_trees(Domain domain) { return domain == Domain::tree || domain == Domain::tree_nodes; }

/// Where a host's own property number k stands (World::add_property):
/// behind all that kernels.inl and properties.inl name.
constexpr Buffer own_buffer(std::size_t k) { return Buffer(buffer_count + k); }
constexpr bool is_own(Buffer buffer) { return std::size_t(buffer) >= buffer_count; }
/// Whether rows of some table stand in it, the host's own included.
constexpr bool of_table(Buffer buffer) { return std::size_t(buffer) < table_buffer_count || is_own(buffer); }

struct BufferSchema {
  std::string_view name;
  Table table;          // of a table's buffer
  std::uint32_t reals;  // per row, or per slot of an array of structures of arrays; 0: unsigned integers
  std::string_view doc;
};

struct PropertySchema {
  Table table;
  Buffer buffer;
  std::uint32_t offset;  // reals into the row
  PropertyType type;
  std::string_view name;
  Role role;
  double initial;  // of every component; of a quaternion's w
  std::string_view unit, doc;
};

struct Access {
  Buffer buffer;
  bool write;
};

struct KernelSchema {
  std::string_view name;
  Domain domain;
  Stage stage;
  std::span<const Access> accesses;
};

/// Reals in a row of a table's buffer.
constexpr std::size_t reals_of(Buffer buffer) {
  constexpr std::size_t quads_of[] = {
#define PC_TABLE(table, doc)
#define PC_BUFFER(table, buffer, quads, doc) quads,
#define PC_PROPERTY(table, buffer, offset, type, name, role, initial, unit, doc)
#include "kernels/properties.inl"
#undef PC_TABLE
#undef PC_BUFFER
#undef PC_PROPERTY
  };
  return 4 * quads_of[std::size_t(buffer)];
}

const BufferSchema& schema(Buffer buffer);
const KernelSchema& schema(Kernel kernel);
std::span<const PropertySchema> properties();
/// Whether some property of this role stands in it.
bool holds(Buffer buffer, Role role);
std::string_view name(Table table);

/// What kernels are told besides buffers (src/kernels/info.inl), in the precision of the world.
template <class Scalar> struct InfoOf {
#define PC_INFO_FIELD(name, doc) Scalar name = 0;
#include "kernels/info.inl"
#undef PC_INFO_FIELD
};

/// Where a field stands in it, in reals.
namespace info_field {
enum : std::uint32_t {
#define PC_INFO_FIELD(name, doc) name,
#include "kernels/info.inl"
#undef PC_INFO_FIELD
};
}  // namespace info_field

}  // namespace pcphys
