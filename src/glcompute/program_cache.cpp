#include "glcompute/program_cache.h"

#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

namespace pcphys {
namespace {

constexpr char magic[8] = {'p', 'c', 'p', 'h', 'y', 's', '0', '1'};
constexpr std::size_t header_bytes = sizeof magic + sizeof(std::uint64_t);

// FNV-1a, 64 bit
constexpr std::uint64_t hash_start = 0xcbf29ce484222325u;
std::uint64_t hash(std::string_view bytes, std::uint64_t h) {
  for (const char c : bytes) h = (h ^ std::uint8_t(c)) * 0x100000001b3u;
  return h;
}

std::string hexadecimal(std::uint64_t value) {
  std::string text(16, '0');
  for (std::size_t i = 0; i < 16; i++) text[15 - i] = "0123456789abcdef"[(value >> (4 * i)) & 15];
  return text;
}

std::filesystem::path cache_folder() {
  if (const char* own = std::getenv("PCPHYS_CACHE")) return own;
  if (const char* shared = std::getenv("XDG_CACHE_HOME"); shared != nullptr && *shared != 0)
    return std::filesystem::path(shared) / "pcphys";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != 0)
    return std::filesystem::path(home) / ".cache" / "pcphys";
  return {};
}

}  // namespace

ProgramCache::ProgramCache(std::string identity) : identity_(std::move(identity)), folder_(cache_folder()) {}

std::filesystem::path ProgramCache::file(std::string_view text) const {
  if (folder_.empty()) return {};
  const std::uint64_t first = hash(text, hash(identity_, hash_start));
  const std::uint64_t second = hash(identity_, hash(text, ~hash_start));
  return folder_ / (hexadecimal(first) + hexadecimal(second));
}

std::optional<std::vector<char>> ProgramCache::load(std::string_view text) const {
  if (folder_.empty()) return {};
  std::ifstream in(file(text), std::ios::binary);
  if (!in) return {};
  std::vector<char> bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (bytes.size() < header_bytes || std::memcmp(bytes.data(), magic, sizeof magic) != 0) return {};
  std::uint64_t expected = 0;
  std::memcpy(&expected, bytes.data() + sizeof magic, sizeof expected);
  bytes.erase(bytes.begin(), bytes.begin() + header_bytes);
  if (hash({bytes.data(), bytes.size()}, hash_start) != expected) return {};
  return bytes;
}

void ProgramCache::store(std::string_view text, const std::vector<char>& bytes) const {
  if (folder_.empty()) return;
  std::error_code ignored;
  std::filesystem::create_directories(folder_, ignored);
  // written beside its place and moved there: another process sees a whole file or none
  static std::atomic<unsigned> serial{0};
  const std::filesystem::path target = file(text);
  std::filesystem::path draft = target;
  draft += std::to_string(getpid()) + '-' + std::to_string(serial++) + ".draft";
  std::ofstream out(draft, std::ios::binary);
  const std::uint64_t sum = hash({bytes.data(), bytes.size()}, hash_start);
  out.write(magic, sizeof magic)
      .write(reinterpret_cast<const char*>(&sum), sizeof sum)
      .write(bytes.data(), std::streamsize(bytes.size()));
  out.close();
  if (out) std::filesystem::rename(draft, target, ignored);
  if (!out || ignored) std::filesystem::remove(draft, ignored);
}

}  // namespace pcphys
