// Linked programs and probe results on disk, so that a second start does not compile again.
// A cache must never be the reason of a failure: what cannot be read or written, or is not what its name says, is as if
// it were not there.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcphys {

class ProgramCache {
 public:
  /// identity: of the device and its driver; part of every key.
  /// Lives in $PCPHYS_CACHE, else $XDG_CACHE_HOME/pcphys, else ~/.cache/pcphys; an empty PCPHYS_CACHE turns it off.
  explicit ProgramCache(std::string identity);

  /// The bytes stored for this text, when they are there, whole, and were stored for it.
  std::optional<std::vector<char>> load(std::string_view text) const;
  /// Replaces what is there, if the place can be written.
  void store(std::string_view text, const std::vector<char>& bytes) const;
  /// Where `text` is kept; empty when there is no cache.
  std::filesystem::path file(std::string_view text) const;

 private:
  std::string identity_;
  std::filesystem::path folder_;
};

}  // namespace pcphys
