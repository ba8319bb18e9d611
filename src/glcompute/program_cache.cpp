#include "glcompute/program_cache.h"

#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <fstream>

namespace pcphys {
namespace {

constexpr char magic[8] = {'p', 'c', 'p', 'h', 'y', 's', '0', '2'};

/// What a file starts with.
struct Header {
  char kind[sizeof magic];
  std::uint64_t size;  // of what follows [bytes]
  std::uint64_t sum;   // of it and of the name that it was stored under
};

// FNV-1a, 64 bit
constexpr std::uint64_t hash_start = 0xcbf29ce484222325u;
std::uint64_t hash(std::string_view bytes, std::uint64_t h) {
  for (const char c : bytes) h = (h ^ std::uint8_t(c)) * 0x100000001b3u;
  return h;
}

/// The name is a hash of the identity and the text, so that a file under the name of another has the wrong sum.
std::uint64_t sum_of(const std::filesystem::path& file, const std::vector<char>& bytes) {
  return hash({bytes.data(), bytes.size()}, hash(file.filename().string(), hash_start));
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
  const std::filesystem::path place = file(text);
  std::error_code error;
  // To read a folder throws, and to open a pipe waits.
  if (place.empty() || !std::filesystem::is_regular_file(place, error)) return {};
  std::ifstream in(place, std::ios::binary);
  Header header;
  if (!in.read(reinterpret_cast<char*>(&header), sizeof header)) return {};
  if (std::memcmp(header.kind, magic, sizeof magic) != 0) return {};
  const std::uintmax_t whole = std::filesystem::file_size(place, error);
  if (error || whole - sizeof header != header.size) return {};
  std::vector<char> bytes(header.size);
  if (!in.read(bytes.data(), std::streamsize(bytes.size()))) return {};
  if (sum_of(place, bytes) != header.sum) return {};
  return bytes;
}

void ProgramCache::store(std::string_view text, const std::vector<char>& bytes) const {
  if (folder_.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  // It is written beside its place and moved there: another process sees a whole file or none.
  static std::atomic<unsigned> serial{0};
  const std::filesystem::path target = file(text);
  std::filesystem::path draft = target;
  draft += std::to_string(getpid()) + '-' + std::to_string(serial++) + ".draft";
  Header header{{}, bytes.size(), sum_of(target, bytes)};
  std::memcpy(header.kind, magic, sizeof magic);
  std::ofstream out(draft, std::ios::binary);
  out.write(reinterpret_cast<const char*>(&header), sizeof header).write(bytes.data(), std::streamsize(bytes.size()));
  out.close();
  // An empty folder in its place goes; one that holds something stays, and the program is compiled each time.
  if (std::filesystem::is_directory(target, error)) std::filesystem::remove(target, error);
  error.clear();
  if (out) std::filesystem::rename(draft, target, error);
  if (!out || error) std::filesystem::remove(draft, error);
}

}  // namespace pcphys
