#include "glcompute/source_text.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "embedded.h"

namespace pcphys {
namespace {

const char* form_suffix(RoundingForm form) { return form == RoundingForm::none ? "builtin" : name(form); }

}  // namespace

Status SourceText::include(std::string_view file) {
  const char* text = embedded_source(file);
  if (text == nullptr)
    return Error{ErrorCode::unknown_name, "There is no embedded kernel text called " + std::string(file) + "."};
  return add_text(text, file, 1);
}

Status SourceText::add_text(std::string_view text, std::string_view file, std::uint32_t first) {
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

Status SourceText::line(std::string_view text, std::size_t file, std::uint32_t at) {
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
Status SourceText::constants(std::string_view text, std::string_view file, std::uint32_t at) {
  constexpr std::string_view marker = "PC_REAL(";
  for (std::size_t i = text.find(marker); i != text.npos; i = text.find(marker)) {
    text_ += text.substr(0, i);
    text.remove_prefix(i + marker.size());
    double value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code != std::errc() || end == text.data() + text.size() || *end != ')')
      return Error{ErrorCode::bad_argument, "PC_REAL at " + std::string(file) + ":" + std::to_string(at) +
                                                " holds no decimal number; write one, such as PC_REAL(0.5)."};
    text_ += literal(value);
    text.remove_prefix(std::size_t(end - text.data()) + 1);
  }
  text_ += text;
  return {};
}

std::string SourceText::literal(double value) const {
  char digits[64];
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const double scaled = std::ldexp(value, 10);
  // exact in few digits
  const bool plain = (bits >> 52 & 0x7ffu) < 1073u && static_cast<double>(static_cast<std::int64_t>(scaled)) == scaled;
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

std::string source_head(const SourceOptions& options) {
  std::string text = "#version 430\n";
  if (options.precision == Precision::f64) text += "#define PC_DOUBLE\n";
  text += "#define PC_W " + std::to_string(options.lanes) + "u\n";
  text += std::string("#define pc_div pc_div_") + form_suffix(options.division) + "\n";
  text += std::string("#define pc_sqrt pc_sqrt_") + form_suffix(options.square_root) + "\n";
  return text;
}

std::string info_declaration() {
  std::string text = "layout(std140, binding = 0) uniform PcInfo {\n";
#define PC_INFO_FIELD(name, doc) text += "  Real " #name ";\n";
#include "kernels/info.inl"
#undef PC_INFO_FIELD
  return text + "} pc_info;\n";
}

}  // namespace pcphys
