#include "glcompute/own_sums.h"

#include <algorithm>

#include "glcompute/program_source.h"

namespace pcphys {
namespace {

bool wide(const OwnKernel& k, PropertyType type) { return number_words(type, k.real_bytes) == 2; }

}  // namespace

std::string for_sums(const OwnKernel& k, const EachNumber& each) {
  std::string text;
  std::uint32_t word = 0;
  for (const OwnArgument& a : k.arguments) {
    if (!a.summed()) continue;
    text += OwnText::for_parts(a.type, [&](std::uint32_t, const std::string& part) {
      const std::string at = std::to_string(word) + "u";
      word += number_words(a.type, k.real_bytes);
      return each(a, part, at);
    });
  }
  return text;
}

std::string declare_sums(const OwnKernel& k, const std::string& prefix) {
  std::string text;
  for (const OwnArgument& a : k.arguments)
    if (a.summed()) text += "  " + OwnText::precise(a) + OwnText::type(a.type) + " " + prefix + a.name + ";\n";
  return text;
}

std::string clear(const OwnKernel& k, const std::string& prefix) {
  return for_sums(k, [&](const OwnArgument& a, const std::string& part, const std::string&) {
    return "  " + prefix + a.name + part + " = " + OwnText::number_type(a.type) + "(0);\n";
  });
}

/// What cannot be ordered is added: a NaN stays one, to be told of.
std::string combined(const OwnArgument& a, const std::string& x, const std::string& y) {
  const std::string sum = x + " + " + y, first = x + " <= " + y + " || " + y + " <= " + x + " ? " + x + " : " + sum;
  if (a.kind == OwnArgument::Kind::least) return y + " < " + x + " ? " + y + " : " + first;
  if (a.kind == OwnArgument::Kind::most) return x + " < " + y + " ? " + y + " : " + first;
  return sum;
}

std::string combine(const OwnKernel& k, const std::string& into, const std::string& with) {
  return for_sums(k, [&](const OwnArgument& a, const std::string& part, const std::string&) {
    const std::string x = into + a.name + part;
    return "  " + x + " = " + combined(a, x, with + a.name + part) + ";\n";
  });
}

std::string put(const OwnKernel& k, const std::string& prefix, const std::string& index) {
  return for_sums(k, [&](const OwnArgument& a, const std::string& part, const std::string& word) {
    return "  pc_put(" + word + ", " + index + ", " + prefix + a.name + part + ");\n";
  });
}

std::string value_at(const OwnKernel& k, const OwnArgument& a, const std::string& word, const std::string& index) {
  const char* form = a.type == PropertyType::int32    ? "int"
                     : a.type == PropertyType::uint32 ? "uint"
                     : wide(k, a.type)                ? "double"
                                                      : "float";
  return std::string("pc_get_") + form + "(" + word + ", " + index + ")";
}

std::string get(const OwnKernel& k, const std::string& prefix, const std::string& index) {
  return for_sums(k, [&](const OwnArgument& a, const std::string& part, const std::string& word) {
    return "  " + prefix + a.name + part + " = " + value_at(k, a, word, index) + ";\n";
  });
}

std::string apply(const OwnKernel& k, const OwnText& own) {
  std::string text;
  for (const OwnArgument& a : k.arguments) {
    if (!a.summed()) continue;
    text += own.for_parts(a.type, [&](std::uint32_t c, const std::string& part) {
      const std::string place = own.place(a, c, "pc_row"), sum = "pc_sum_" + a.name + part;
      if (!a.adds()) return "  " + place + " = " + sum + ";\n";
      return "  " + a.name + part + " = " + place + ";\n  " + a.name + part + " = " + a.name + part + " + " + sum +
             ";\n  " + place + " = " + a.name + part + ";\n";
    });
  }
  return text;
}

std::string sums_block(const OwnKernel& k, std::size_t binding) {
  std::string text =
      "layout(std430, binding = " + std::to_string(binding) + ") restrict buffer Block_sums { uint io_sums[]; };\n";
  text += "uint pc_stride;\n";
  text += "void pc_put(uint word, uint pc_i, uint x) { io_sums[word * pc_stride + pc_i] = x; }\n";
  text += "void pc_put(uint word, uint pc_i, int x) { io_sums[word * pc_stride + pc_i] = uint(x); }\n";
  text += "void pc_put(uint word, uint pc_i, float x) { io_sums[word * pc_stride + pc_i] = floatBitsToUint(x); }\n";
  text += "uint pc_get_uint(uint word, uint pc_i) { return io_sums[word * pc_stride + pc_i]; }\n";
  text += "int pc_get_int(uint word, uint pc_i) { return int(io_sums[word * pc_stride + pc_i]); }\n";
  text += "float pc_get_float(uint word, uint pc_i) { return uintBitsToFloat(io_sums[word * pc_stride + pc_i]); }\n";
  const bool doubles =
      std::ranges::any_of(k.arguments, [&](const OwnArgument& a) { return a.summed() && wide(k, a.type); });
  if (!doubles) return text;
  text +=
      "void pc_put(uint word, uint pc_i, double x) { uvec2 b = unpackDouble2x32(x); pc_put(word, pc_i, b.x); "
      "pc_put(word + 1u, pc_i, b.y); }\n";
  text +=
      "double pc_get_double(uint word, uint pc_i) { return packDouble2x32(uvec2(pc_get_uint(word, pc_i), "
      "pc_get_uint(word + 1u, pc_i))); }\n";
  return text;
}

}  // namespace pcphys
