#include "plan/kernel_lines.h"

#include <algorithm>
#include <fstream>
#include <iterator>

namespace pcphys {
namespace {

bool space(char c) { return std::string_view(" \t\n\r\f\v").find(c) != std::string_view::npos; }
int count_lines(std::string_view text) { return int(std::ranges::count(text, '\n')); }

/// A place in the text of a file.
class Cursor {
 public:
  Cursor(std::string_view rest, int line) : rest_(rest), line_(line) {}
  int line() const { return line_; }
  /// White space, comments and lines that go on: what stringising makes one space of, or none.
  void skip() {
    while (!rest_.empty()) {
      if (space(rest_[0]))
        drop(1);
      else if (rest_.starts_with("//"))
        drop(std::min(rest_.find('\n'), rest_.size()));
      else if (rest_.starts_with("/*"))
        drop(std::min(rest_.find("*/", 2), rest_.size() - 2) + 2);
      else if (rest_.starts_with("\\\n") || rest_.starts_with("\\\r\n"))
        drop(2);
      else
        return;
    }
  }
  bool take(char wanted) {
    skip();
    if (rest_.empty() || rest_[0] != wanted) return false;
    drop(1);
    return true;
  }

 private:
  void drop(std::size_t n) {
    line_ += count_lines(rest_.substr(0, n));
    rest_.remove_prefix(n);
  }
  std::string_view rest_;
  int line_;
};

/// Walks both texts in lockstep; false where they differ.
bool lay_out(Cursor& file, std::string_view joined, KernelLines::Text& out) {
  file.skip();
  int line = out.line = file.line();
  for (const char c : joined) {
    if (space(c)) {
      out.text += c;
      continue;
    }
    file.skip();
    out.text.append(std::size_t(file.line() - line), '\n');
    line = file.line();
    if (!file.take(c)) return false;
    out.text += c;
  }
  return true;
}

}  // namespace

int KernelLines::Text::line_at(std::size_t place) const {
  int at = line;
  for (const char c : text) {
    if (c == '\n')
      at++;
    else if (place-- == 0)
      break;
  }
  return at;
}

std::optional<KernelLines> find_lines(std::string_view source, const OwnKernel& k) {
  if (k.name.empty()) return {};
  std::optional<KernelLines> found;
  int line = 1;  // where the text before `from` ends
  std::size_t from = 0;
  for (std::size_t at = source.find(k.name); at != source.npos; at = source.find(k.name, at + 1)) {
    std::size_t opens = at;
    while (opens > 0 && space(source[opens - 1])) opens--;
    if (opens == 0 || source[opens - 1] != '(') continue;
    line += count_lines(source.substr(from, opens - from));
    from = opens;
    if (line > k.line) break;
    const std::size_t end = at + k.name.size();
    Cursor file(source.substr(end), line + count_lines(source.substr(opens, end - opens)));
    KernelLines lines;
    if (file.take(',') && lay_out(file, k.signature, lines.signature) && file.take(',') &&
        lay_out(file, k.body, lines.body) && (k.body.empty() || file.take(')')))
      found = std::move(lines);
  }
  return found;
}

std::optional<KernelLines> read_lines(const OwnKernel& k) {
  std::ifstream file(k.file);
  if (!file) return {};
  const std::string source{std::istreambuf_iterator<char>(file), {}};
  return find_lines(source, k);
}

std::string place_in_signature(const OwnKernel& k, std::size_t place) {
  if (k.file.empty()) return {};
  const std::optional<KernelLines> lines = k.own_lines ? std::nullopt : read_lines(k);
  return k.file + ":" + std::to_string(lines ? lines->signature.line_at(place) : k.line);
}

}  // namespace pcphys
