#include "world/schema.h"

#include <cassert>

namespace pcphys {
namespace {

constexpr BufferSchema buffer_schemas[] = {
#define PC_TABLE(table, doc)
#define PC_BUFFER(table, buffer, quads, doc) {#buffer, Table::table, quads * 4, doc},
#define PC_PROPERTY(table, buffer, offset, type, name, role, initial, unit, doc)
#include "kernels/properties.inl"
#undef PC_TABLE
#undef PC_BUFFER
#undef PC_PROPERTY
    {"bodies", Table::body, 0, "body rows that move"},
    {"contact_ends", Table::contact, 0, "the two body rows of a slot"},
    {"contact_order", Table::contact, 0, "the contact of a slot"},
    {"joint_ends", Table::joint, 0, "the two body rows of a slot"},
    {"joint_order", Table::joint, 0, "the joint of a slot"},
    {"joint_paths", Table::joint, 0, "of joints that close loops of trees the way from the roots to their bodies"},
    {"tree_blocks", Table::joint, 0,
     "of a block of trees its first node, their number, and where its levels stand in this list"},
    {"tree_parents", Table::joint, 0,
     "of a node twice its parent's place, and 1 where the joint's body a is the child"},
    {"tree_ends", Table::joint, 0, "body row and joint row of a node"},
    {"tree_order", Table::node, 0, "row of a node in the table of nodes"},
    {"contact_paths", Table::contact, 0, "of contacts with trees the way from the roots to their bodies"},
    {"nets", Table::joint, 0, "of nets of springs their sizes, which bodies each spring joins, and the rows of both"},
    {"bodies_by_id", Table::body, 0, "all bodies in the order of their ids"},
    {"moving_by_id", Table::body, 0, "bodies that can move, in the order of their ids"},
    {"joints_by_id", Table::joint, 0, "joints in the order of their ids"},
    {"joined", Table::joint, 0, "joints of bodies that move, with the rows of both"},
    {"body_joints", Table::body, 0, "the joints of each body, in the order of their ids"},
    {"near_first", Table::body, 0, "where the list of a body's neighbours begins"},
    {"near_rows", Table::body, 0, "lists of neighbours"},
    {"island_ends", Table::body, 0, "the two body rows of an edge: bodies that act on each other"},
    {"island_labels", Table::body, 0, "of a body the lowest row of its island; of row 0 whether some were lowered"},
#define PC_ROWS(domain, buffer, reals) {#buffer, Table::domain, reals, "scratch of the solver"},
#include "kernels/kernels.inl"
#undef PC_ROWS
};
static_assert(std::size(buffer_schemas) == buffer_count);

#define PC_ROWS(domain, buffer, reals) \
  static_assert(reals % 4 == 0, #buffer ": GL keeps rows in whole quads (prelude.glsl, PC_AT)");
#include "kernels/kernels.inl"
#undef PC_ROWS

constexpr PropertySchema property_schemas[] = {
#define PC_TABLE(table, doc)
#define PC_BUFFER(table, buffer, quads, doc)
#define PC_PROPERTY(table, buffer, offset, type, name, role, initial, unit, doc) \
  {Table::table, Buffer::buffer, offset, PropertyType::type, #name, Role::role, initial, unit, doc},
#include "kernels/properties.inl"
#undef PC_TABLE
#undef PC_BUFFER
#undef PC_PROPERTY
};

#define PC_READ(buffer) {Buffer::buffer, false},
#define PC_WRITE(buffer) {Buffer::buffer, true},
#define PC_KERNEL(name, domain, stage, accesses) constexpr Access accesses_##name[] = {accesses};
#include "kernels/kernels.inl"
#undef PC_KERNEL
#undef PC_READ
#undef PC_WRITE

constexpr KernelSchema kernel_schemas[] = {
#define PC_KERNEL(name, domain, stage, accesses) {#name, Domain::domain, Stage::stage, accesses_##name},
#include "kernels/kernels.inl"
#undef PC_KERNEL
};

// GL 4.3 guarantees eight storage blocks to a program, no more.
#define PC_KERNEL(name, domain, stage, accesses) \
  static_assert(std::size(accesses_##name) <= 8, #name " binds more than eight buffers");
#include "kernels/kernels.inl"
#undef PC_KERNEL

}  // namespace

const BufferSchema& schema(Buffer buffer) { return buffer_schemas[std::size_t(buffer)]; }
const KernelSchema& schema(Kernel kernel) { return kernel_schemas[std::size_t(kernel)]; }
std::span<const PropertySchema> properties() { return property_schemas; }

bool holds(Buffer buffer, Role role) {
  static constexpr auto roles = [] {
    std::array<unsigned, buffer_count> bits{};
    for (const PropertySchema& p : property_schemas) bits[std::size_t(p.buffer)] |= 1u << unsigned(p.role);
    return bits;
  }();
  return roles[std::size_t(buffer)] >> unsigned(role) & 1u;
}

std::string_view name(Table table) {
  constexpr std::string_view names[] = {
#define PC_TABLE(table, doc) #table,
#define PC_BUFFER(table, buffer, quads, doc)
#define PC_PROPERTY(table, buffer, offset, type, name, role, initial, unit, doc)
#include "kernels/properties.inl"
#undef PC_TABLE
#undef PC_BUFFER
#undef PC_PROPERTY
  };
  return names[std::size_t(table)];
}
std::string_view name(Stage stage) {
  constexpr std::string_view names[] = {"integrate", "joints", "impulses", "islands"};
  return names[std::size_t(stage)];
}

}  // namespace pcphys
