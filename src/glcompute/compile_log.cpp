#include "glcompute/compile_log.h"

#include <charconv>

namespace pcphys {
namespace {

constexpr std::size_t longest_quote = 120;

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

/// Takes the first line of a text.
std::string_view take_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text = end == text.npos ? std::string_view() : text.substr(end + 1);
  return line;
}

bool speaks_of(std::string_view text, std::string_view word) { return text.find(word) != text.npos; }

/// Takes a number, and says whether there was one.
bool take(std::string_view& text, std::uint32_t& number) {
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (code != std::errc()) return false;
  text.remove_prefix(std::size_t(end - text.data()));
  return true;
}

struct Mark {
  std::uint32_t line = 0, file = 0;
  friend bool operator==(const Mark&, const Mark&) = default;
};
bool find_mark(std::string_view said, Mark& mark) {
  if (!take(said, mark.file) || said.empty() || (said[0] != ':' && said[0] != '(')) return false;
  said.remove_prefix(1);
  return take(said, mark.line);
}

std::string place_of(const Mark& mark, const ProgramSource& source) {
  const std::string& file = mark.file < source.files.size() ? source.files[mark.file] : "";
  if (mark.file == 0 || file.empty() || file.ends_with(counted_by_statement)) return {};
  return file + ":" + std::to_string(mark.line) + ": ";
}

std::string_view line_at(std::string_view text, const Mark& wanted) {
  constexpr std::string_view directive = "#line ";
  Mark here;
  while (!text.empty()) {
    std::string_view line = take_line(text);
    if (line.starts_with(directive)) {
      line.remove_prefix(directive.size());
      if (!take(line, here.line)) continue;
      line = trimmed(line);
      (void)take(line, here.file);
      continue;
    }
    if (here == wanted) return trimmed(line);
    here.line++;
  }
  return {};
}

/// Mesa says file 0 of what is assigned and must not be, whatever #line gave: then it is of the host's own text, if
/// that has such a line.
std::string_view line_at(const ProgramSource& source, Mark& mark) {
  const Mark host{mark.line, source.host};
  const std::string_view at = mark.file == 0 && source.host != 0 ? line_at(source.text, host) : std::string_view();
  if (at.empty()) return line_at(source.text, mark);
  mark = host;
  return at;
}

}  // namespace

std::string by_statement(std::string_view line) {
  std::string text;
  int depth = 0;  // of parentheses: a loop's head is one statement
  for (const char c : line.substr(0, line.find("//"))) {
    if (c == ' ' && text.ends_with('\n')) continue;
    text += c;
    depth += (c == '(') - (c == ')');
    if (depth == 0 && (c == ';' || c == '{' || c == '}')) text += '\n';
  }
  return text;
}

std::string with_quotes(std::string_view log, const ProgramSource& source) {
  std::string text;
  const bool refused = speaks_of(log, "error");
  while (!log.empty()) {
    const std::string_view said = take_line(log);
    // drivers warn of what was not asked about
    if (refused && speaks_of(said, "warning") && !speaks_of(said, "error")) continue;
    text += (text.empty() ? "" : "\n") + std::string(said);
    Mark mark;
    const std::string_view at = find_mark(said, mark) ? line_at(source, mark) : std::string_view();
    if (!at.empty())
      text += "\n  there: " + place_of(mark, source) + std::string(at.substr(0, longest_quote)) +
              (at.size() > longest_quote ? "..." : "");
  }
  return text;
}

}  // namespace pcphys
