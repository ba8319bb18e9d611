// What program sources are put together from.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "glcompute/program_source.h"

namespace pcphys {

/// Copies embedded texts: resolves #include, replaces PC_REAL(literal), drops comments, keeps line numbers.
class SourceText {
 public:
  explicit SourceText(Precision precision) : precision_(precision) { files_.push_back("generated"); }

  void add(std::string_view text) { text_ += text; }
  Status include(std::string_view file);
  /// A text that is not embedded, whose first line is number `first` of `file`.
  Status add_text(std::string_view text, std::string_view file, std::uint32_t first);
  ProgramSource take() { return {std::move(text_), std::move(files_)}; }

 private:
  Status line(std::string_view text, std::size_t file, std::uint32_t at);
  Status constants(std::string_view text, std::string_view file, std::uint32_t at);
  void locate(std::size_t file, std::uint32_t at) {
    text_ += "#line " + std::to_string(at) + " " + std::to_string(file) + "\n";
  }
  std::string literal(double value) const;

  Precision precision_;
  std::string text_;
  std::vector<std::string> files_;
};

/// What every program begins with: the version, and what its precision and rounding are.
std::string source_head(const SourceOptions& options);
/// The block of what kernels are told besides buffers.
std::string info_declaration();

}  // namespace pcphys
