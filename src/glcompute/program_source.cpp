#include "glcompute/program_source.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "embedded.h"

namespace pcphys {
namespace {

std::string number(std::uint64_t value) { return std::to_string(value); }

/// Copies embedded texts: resolves #include, replaces PC_REAL(literal), drops comments, keeps line numbers.
class Text {
 public:
  explicit Text(Precision precision) : precision_(precision) { files_.push_back("generated"); }

  void add(std::string_view text) { text_ += text; }
  Status include(std::string_view file);
  /// A text that is not embedded, whose first line is number `first` of `file`.
  Status add_text(std::string_view text, std::string_view file, std::uint32_t first);
  ProgramSource take() { return {std::move(text_), std::move(files_)}; }

 private:
  Status line(std::string_view text, std::size_t file, std::uint32_t at);
  Status constants(std::string_view text, std::string_view file, std::uint32_t at);
  void locate(std::size_t file, std::uint32_t at) { text_ += "#line " + number(at) + " " + number(file) + "\n"; }
  std::string literal(double value) const;

  Precision precision_;
  std::string text_;
  std::vector<std::string> files_;
};

Status Text::include(std::string_view file) {
  const char* text = embedded_source(file);
  if (text == nullptr)
    return Error{ErrorCode::unknown_name, "There is no embedded kernel text called " + std::string(file) + "."};
  return add_text(text, file, 1);
}

Status Text::add_text(std::string_view text, std::string_view file, std::uint32_t first) {
  const std::size_t index = files_.size();
  files_.emplace_back(file);
  locate(index, first);
  std::string_view rest = text;
  for (std::uint32_t at = first; !rest.empty(); at++) {
    const std::size_t end = rest.find('\n');
    if (Status status = line(rest.substr(0, end), index, at); !status) return status;
    rest = end == rest.npos ? std::string_view() : rest.substr(end + 1);
  }
  return {};
}

Status Text::line(std::string_view text, std::size_t file, std::uint32_t at) {
  text = text.substr(0, text.find("//"));
  constexpr std::string_view directive = "#include \"";
  if (text.starts_with(directive)) {
    const std::string_view name = text.substr(directive.size(), text.find('"', directive.size()) - directive.size());
    if (Status status = include(name); !status) return status;
    locate(file, at + 1);
    return {};
  }
  if (Status status = constants(text, files_[file], at); !status) return status;
  text_ += '\n';
  return {};
}

/// A constant means the same number here as in C++: read as double, rounded to the precision, written so that
/// every compiler gives it back. Found on an H200 (driver 580): decimals of many digits are read an ulp off as
/// doubles (pi / 2 in parts), so those go by their bits; with all doubles by their bits, joint_solve was
/// compiled wrongly, so short ones stay decimals.
Status Text::constants(std::string_view text, std::string_view file, std::uint32_t at) {
  constexpr std::string_view marker = "PC_REAL(";
  for (std::size_t i = text.find(marker); i != text.npos; i = text.find(marker)) {
    text_ += text.substr(0, i);
    text.remove_prefix(i + marker.size());
    double value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code != std::errc() || end == text.data() + text.size() || *end != ')')
      return Error{ErrorCode::bad_argument, "PC_REAL at " + std::string(file) + ":" + number(at) +
                                                " holds no decimal number; write one, such as PC_REAL(0.5)."};
    text_ += literal(value);
    text.remove_prefix(std::size_t(end - text.data()) + 1);
  }
  text_ += text;
  return {};
}

std::string Text::literal(double value) const {
  char digits[64];
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const double scaled = std::ldexp(value, 10);
  const bool plain =
      (bits >> 52 & 0x7ffu) < 1073u && static_cast<double>(static_cast<std::int64_t>(scaled)) == scaled;  // exact in few digits
  if (precision_ == Precision::f64 && plain) {
    std::string text(digits, std::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed).ptr);
    if (text.find('.') == text.npos) text += ".0";
    return "(" + text + "lf)";
  }
  if (precision_ == Precision::f64) {
    std::snprintf(digits, sizeof digits, "packDouble2x32(uvec2(0x%08xu, 0x%08xu))", unsigned(bits & 0xffffffffu),
                  unsigned(bits >> 32));
    return digits;
  }
  std::string text(digits, std::to_chars(digits, digits + sizeof digits, static_cast<float>(value)).ptr);
  if (text.find_first_of(".e") == text.npos) text += ".0";
  text += "f";
  return text.front() == '-' ? "(" + text + ")" : text;
}

const char* form_suffix(RoundingForm form) { return form == RoundingForm::none ? "builtin" : name(form); }

std::string head(const SourceOptions& options) {
  std::string text = "#version 430\n";
  if (options.precision == Precision::f64) text += "#define PC_DOUBLE\n";
  text += "#define PC_W " + number(options.lanes) + "u\n";
  text += std::string("#define pc_div pc_div_") + form_suffix(options.division) + "\n";
  text += std::string("#define pc_sqrt pc_sqrt_") + form_suffix(options.square_root) + "\n";
  return text;
}

/// Elements as the prelude's macros take them.
std::string element(Buffer buffer, Precision precision) {
  if (schema(buffer).reals == 0) return "uint";
  return scalar_elements(buffer, precision) ? "Real" : "Real4";
}

std::string buffer_declarations(const KernelSchema& kernel, Precision precision) {
  std::string text;
  std::uint32_t binding = 0;
  for (const Access& access : kernel.accesses) {
    const BufferSchema& buffer = schema(access.buffer);
    const std::string label(buffer.name);
    text += "layout(std430, binding = " + number(binding++) + ") restrict " + (access.write ? "" : "readonly ") +
            "buffer Block_" + label + " { " + element(access.buffer, precision) + " io_" + label + "[]; };\n";
    if (buffer.reals != 0) text += "#define quads_" + label + " " + number(quads(access.buffer)) + "u\n";
  }
  return text;
}

std::string info_declaration() {
  std::string text = "layout(std140, binding = 0) uniform PcInfo {\n";
#define PC_INFO_FIELD(name, doc) text += "  Real " #name ";\n";
#include "kernels/info.inl"
#undef PC_INFO_FIELD
  return text + "} pc_info;\n";
}

// ---- kernels of the host's own ------------------------------------------------------------------------
constexpr const char* glsl_types[] = {"Real", "Vec3", "Quaternion", "Sym3", "Quad", "Mat3", "float", "double", "int", "uint"};
const char* glsl_type(PropertyType type) { return glsl_types[std::size_t(type)]; }
/// Of one element of a buffer that holds nothing but such numbers.
bool single(PropertyType type) { return components(type) == 1; }

/// The name in a program of a buffer of which it uses a property.
std::string own_label(const OwnKernel& k, Buffer buffer) {
  if (!is_own(buffer)) return std::string(schema(buffer).name);
  const auto* user = &*std::ranges::find_if(
      k.arguments, [&](const OwnArgument& a) { return a.kind != OwnArgument::Kind::parameter && a.buffer == buffer; });
  return "own_" + user->name;
}
PropertyType own_type(const OwnKernel& k, Buffer buffer) {
  return std::ranges::find_if(k.arguments,
                              [&](const OwnArgument& a) { return a.kind != OwnArgument::Kind::parameter && a.buffer == buffer; })
      ->type;
}

std::string own_declarations(const OwnKernel& k) {
  std::string text;
  std::uint32_t binding = 0;
  for (const Access& access : k.accesses) {
    std::string element = "Real4";
    if (is_own(access.buffer) && single(own_type(k, access.buffer))) element = glsl_type(own_type(k, access.buffer));
    if (!of_table(access.buffer)) element = "uint";
    const std::string label = own_label(k, access.buffer);
    text += "layout(std430, binding = " + number(binding++) + ") restrict " + (access.write ? "" : "readonly ") +
            "buffer Block_" + label + " { " + element + " io_" + label + "[]; };\n";
  }
  for (const OwnArgument& a : k.arguments) {
    if (a.kind == OwnArgument::Kind::parameter && !a.given)
      for (std::uint32_t c = 0; c < components(a.type); c++)
        text +=
            std::string("uniform ") + (single(a.type) ? glsl_type(a.type) : "Real") + " pc_" + a.name + "_" + number(c) + ";\n";
    if (a.writes())
      text += std::string(a.type == PropertyType::int32 || a.type == PropertyType::uint32 ? "" : "precise ") + glsl_type(a.type) +
              " " + a.name + ";\n";
  }
  return text;
}

/// Component c of an argument in memory.
std::string own_place(const OwnKernel& k, const OwnArgument& a, std::uint32_t c) {
  if (a.kind == OwnArgument::Kind::parameter) {
    if (!a.given) return "pc_" + a.name + "_" + number(c);
    constexpr const char* gravity[] = {"gravity_x", "gravity_y", "gravity_z"};
    return std::string("pc_info.") + (a.name == "h" ? "h" : gravity[c]);
  }
  const std::string array = "io_" + own_label(k, a.buffer);
  if (is_own(a.buffer) && single(a.type)) return array + "[row]";
  const std::uint32_t at = a.offset / std::uint32_t(k.real_bytes) + c, quad_bytes = std::uint32_t(k.real_bytes << 2);
  return array + "[PC_QUAD_AT(row, " + number(a.row_bytes / quad_bytes) + "u, " + number(at / 4) + "u)]." + "xyzw"[at % 4];
}
/// Component c of a value of that type in the kernel's text.
std::string own_part(PropertyType type, std::uint32_t c) {
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

/// The function with the host's text: what it reads is const, what it writes stands outside and is precise.
std::string own_function(const OwnKernel& k) {
  std::string text;
  for (const OwnArgument& a : k.arguments)
    if (!a.writes()) text += (text.empty() ? "" : ", ") + std::string("const in ") + glsl_type(a.type) + " " + a.name;
  return "void pc_own(" + text + ")\n";
}

std::string own_main(const OwnKernel& k, std::uint32_t local_size) {
  std::string text = "layout(local_size_x = " + number(local_size) + ") in;\nuniform uvec2 pc_range;\nvoid main() {\n";
  text += "  uint k = gl_GlobalInvocationID.x + pc_range.x;\n  if (k >= pc_range.y) return;\n";
  text += k.table == Table::body ? "  uint row = io_bodies[k];\n" : "  uint row = k;\n";
  std::string call;
  for (const OwnArgument& a : k.arguments) {
    const std::string word = a.writes() ? a.name : "in_" + a.name;
    if (!a.writes()) text += std::string("  ") + glsl_type(a.type) + " " + word + ";\n";
    for (std::uint32_t c = 0; c < components(a.type); c++)
      text += "  " + word + own_part(a.type, c) + " = " + own_place(k, a, c) + ";\n";
    if (!a.writes()) call += (call.empty() ? "" : ", ") + word;
  }
  text += "  pc_own(" + call + ");\n";
  for (const OwnArgument& a : k.arguments)
    for (std::uint32_t c = 0; a.writes() && c < components(a.type); c++)
      text += "  " + own_place(k, a, c) + " = " + a.name + own_part(a.type, c) + ";\n";
  return text + "}\n";
}

std::string main_text(Domain domain, std::uint32_t local_size) {
  std::string text = "layout(local_size_x = " + number(local_size) + ") in;\nuniform uvec2 pc_range;\nvoid main() {\n";
  text += "  uint k = gl_GlobalInvocationID.x + pc_range.x;\n  if (k >= pc_range.y) return;\n";
  text += domain == Domain::body ? "  pc_kernel(io_bodies[k]);\n" : "  pc_kernel(Slot(k / PC_W, k % PC_W));\n";
  return text + "}\n";
}

}  // namespace

bool scalar_elements(Buffer buffer, Precision precision) {
  return buffer > Buffer::table_buffers && schema(buffer).reals > 0 && precision == Precision::f64;
}

std::uint32_t quads(Buffer buffer) { return schema(buffer).reals == 0 ? 1 : schema(buffer).reals / 4; }

Result<ProgramSource> kernel_source(Kernel kernel, const SourceOptions& options) {
  const KernelSchema& what = schema(kernel);
  Text text(options.precision);
  text.add(head(options));
  if (Status status = text.include("prelude.glsl"); !status) return status.error();
  text.add("#line 1 0\n" + buffer_declarations(what, options.precision) + info_declaration());
  if (Status status = text.include(std::string(what.name) + ".inl"); !status) return status.error();
  text.add("#line 1 0\n" + main_text(what.domain, options.local_size));
  return text.take();
}

Result<ProgramSource> own_kernel_source(const OwnKernel& kernel, const SourceOptions& options) {
  Text text(options.precision);
  text.add(head(options));
  if (Status status = text.include("prelude.glsl"); !status) return status.error();
  text.add("#line 1 0\nstruct Mat3 { Vec3 x; Vec3 y; Vec3 z; };\n" + own_declarations(kernel) + info_declaration() +
           own_function(kernel));
  if (Status status = text.add_text(kernel.body, kernel.file, std::uint32_t(kernel.line)); !status) return status.error();
  text.add("\n#line 1 0\n" + own_main(kernel, options.local_size));
  return text.take();
}

Result<ProgramSource> probe_source(Precision precision) {
  Text text(precision);
  text.add(head({precision}));
  if (Status status = text.include("prelude.glsl"); !status) return status.error();
  if (Status status = text.include("probe.glsl"); !status) return status.error();
  return text.take();
}

const char* name(RoundingForm form) {
  constexpr const char* names[] = {"builtin", "fma", "nearest", "none"};
  return names[std::size_t(form)];
}

}  // namespace pcphys
