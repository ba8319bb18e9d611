#include "glcompute/own_text.h"

#include <algorithm>

#include "glcompute/program_source.h"

namespace pcphys {
namespace {

/// Of one element of a buffer that holds nothing but such numbers.
bool single(PropertyType type) { return components(type) == 1; }

}  // namespace

std::string OwnText::type(PropertyType type) {
  constexpr const char* types[] = {"Real", "Vec3",  "Quaternion", "Sym3", "Quad",
                                   "Mat3", "float", "double",     "int",  "uint"};
  return types[std::size_t(type)];
}
std::string OwnText::number_type(PropertyType type) { return single(type) ? OwnText::type(type) : "Real"; }

std::string OwnText::part(PropertyType type, std::uint32_t c) {
  constexpr const char* of_vec3[] = {".x", ".y", ".z"};
  constexpr const char* of_quaternion[] = {".v.x", ".v.y", ".v.z", ".w"};
  constexpr const char* of_quad[] = {".v.x", ".v.y", ".v.z", ".s"};
  constexpr const char* of_sym3[] = {".xx", ".xy", ".xz", ".yy", ".yz", ".zz"};
  constexpr const char* of_mat3[] = {".x.x", ".x.y", ".x.z", ".y.x", ".y.y", ".y.z", ".z.x", ".z.y", ".z.z"};
  switch (type) {
    case PropertyType::vec3: return of_vec3[c];
    case PropertyType::quat: return of_quaternion[c];
    case PropertyType::vec4: return of_quad[c];
    case PropertyType::sym3: return of_sym3[c];
    case PropertyType::mat3: return of_mat3[c];
    default: return "";
  }
}

std::string OwnText::for_parts(PropertyType type,
                               const std::function<std::string(std::uint32_t, const std::string&)>& each) {
  std::string text;
  for (std::uint32_t c = 0; c < components(type); c++) text += each(c, part(type, c));
  return text;
}

std::string OwnText::precise(const OwnArgument& a) {
  return a.type == PropertyType::int32 || a.type == PropertyType::uint32 ? "" : "precise ";
}

const OwnArgument& OwnText::user_of(Buffer buffer) const {
  return *std::ranges::find_if(k_.arguments,
                               [&](const OwnArgument& a) { return a.of_property() && a.buffer == buffer; });
}
/// The name in a program of a buffer of which it uses a property.
std::string OwnText::label(Buffer buffer) const {
  return is_own(buffer) ? "own_" + user_of(buffer).name : std::string(schema(buffer).name);
}

std::string OwnText::blocks(std::span<const Access> accesses) const {
  std::string text;
  std::uint32_t binding = 0;
  for (const Access& access : accesses) {
    std::string element = "Real4";
    if (is_own(access.buffer) && single(user_of(access.buffer).type)) element = type(user_of(access.buffer).type);
    if (!of_table(access.buffer)) element = "uint";
    const std::string name = label(access.buffer);
    text += "layout(std430, binding = " + std::to_string(binding++) + ") restrict " +
            (access.write ? "" : "readonly ") + "buffer Block_" + name + " { " + element + " io_" + name + "[]; };\n";
  }
  return text;
}

std::string OwnText::variables() const {
  std::string text;
  for (const OwnArgument& a : k_.arguments) {
    if (!a.of_property() && !a.given)
      for (std::uint32_t c = 0; c < components(a.type); c++)
        text += "uniform " + number_type(a.type) + " pc_" + a.name + "_" + std::to_string(c) + ";\n";
    if (a.writes()) text += precise(a) + type(a.type) + " " + a.name + ";\n";
  }
  return text;
}

std::string OwnText::function() const {
  std::string text;
  for (const OwnArgument& a : k_.arguments)
    if (!a.writes()) text += (text.empty() ? "" : ", ") + std::string("const in ") + type(a.type) + " " + a.name;
  return "void pc_own(" + text + ")\n";
}

std::string OwnText::call() const {
  std::string text;
  for (const OwnArgument& a : k_.arguments)
    if (!a.writes()) text += (text.empty() ? "pc_in_" : ", pc_in_") + a.name;
  return "pc_own(" + text + ");\n";
}

std::string OwnText::place(const OwnArgument& a, std::uint32_t c, const std::string& row) const {
  if (!a.of_property()) {
    if (!a.given) return "pc_" + a.name + "_" + std::to_string(c);
    constexpr const char* gravity[] = {"gravity_x", "gravity_y", "gravity_z"};
    const char* const h = k_.once_a_step ? "step" : "h";
    return std::string("pc_info.") + (a.name == "h" ? h : gravity[c]);
  }
  const std::string array = "io_" + label(a.buffer), at_row = a.single ? "1u" : row;
  if (is_own(a.buffer) && single(a.type)) return array + "[" + at_row + "]";
  const std::uint32_t at = a.offset / std::uint32_t(k_.real_bytes) + c, quad_bytes = std::uint32_t(k_.real_bytes << 2);
  return array + "[PC_QUAD_AT(" + at_row + ", " + std::to_string(a.row_bytes / quad_bytes) + "u, " +
         std::to_string(at / 4) + "u)]." + "xyzw"[at % 4];
}

std::string OwnText::load(const std::function<bool(const OwnArgument&)>& wanted, const std::string& row) const {
  std::string text;
  for (const OwnArgument& a : k_.arguments) {
    if (a.writes() || !wanted(a)) continue;
    text += "  " + type(a.type) + " pc_in_" + a.name + ";\n";
    text += for_parts(a.type, [&](std::uint32_t c, const std::string& part) {
      return "  pc_in_" + a.name + part + " = " + place(a, c, row) + ";\n";
    });
  }
  return text;
}

}  // namespace pcphys
