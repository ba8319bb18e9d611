// Pins: what stands in the place of a cached program and is not that program counts as missing, and is replaced.
// Needs no GL.
#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "glcompute/program_cache.h"

using pcphys::ProgramCache;
namespace fs = std::filesystem;

namespace {

const std::vector<char> first{'f', 'i', 'r', 's', 't'}, second{'o', 't', 'h', 'e', 'r'};

/// PCPHYS_CACHE names a folder of the process's own, and what it named before at the end.
class OwnFolder {
 public:
  OwnFolder() : folder_(fs::temp_directory_path() / ("pcphys-cache-test-" + std::to_string(getpid()))) {
    if (const char* before = std::getenv("PCPHYS_CACHE")) before_ = before;
    setenv("PCPHYS_CACHE", folder_.c_str(), 1);
  }
  ~OwnFolder() {
    if (before_)
      setenv("PCPHYS_CACHE", before_->c_str(), 1);
    else
      unsetenv("PCPHYS_CACHE");
    fs::remove_all(folder_);
  }
  const fs::path& path() const { return folder_; }

 private:
  fs::path folder_;
  std::optional<std::string> before_;
};

}  // namespace

TEST_CASE("program cache: what is not the program counts as missing and is replaced") {
  const OwnFolder folder;
  const ProgramCache cache("device"), other_device("another device");
  const auto store = [&](const ProgramCache& of, const char* text) {
    of.store(text, second);
    return of.file(text);
  };
  const fs::path place = cache.file("text");
  const auto copy = [&](const fs::path& from) { fs::copy_file(from, place, fs::copy_options::overwrite_existing); };
  struct Spoiling {
    const char* what;
    std::function<void()> act;
  };
  const Spoiling spoilings[] = {
      {"another text's", [&] { copy(store(cache, "another text")); }},
      {"another device's", [&] { copy(store(other_device, "text")); }},
      {"empty", [&] { fs::resize_file(place, 0); }},
      {"cut short", [&] { fs::resize_file(place, fs::file_size(place) - 1); }},
      {"far too long", [&] { fs::resize_file(place, std::uintmax_t(1) << 36); }},
      {"a folder", [&] { fs::remove(place), fs::create_directory(place); }},
      {"a pipe", [&] { fs::remove(place), mkfifo(place.c_str(), 0600); }},
      {"a link to nothing", [&] { fs::remove(place), fs::create_symlink("nothing", place); }},
      {"a link to itself", [&] { fs::remove(place), fs::create_symlink(place, place); }},
      {"not for reading", [&] { fs::permissions(place, fs::perms::none); }},
  };
  for (const Spoiling& spoiling : spoilings) {
    CAPTURE(std::string(spoiling.what));
    cache.store("text", first);
    REQUIRE(cache.load("text") == first);
    spoiling.act();
    const auto found = cache.load("text");
    const bool readable = std::string(spoiling.what) == "not for reading" && geteuid() == 0;
    CHECK(found.has_value() == readable);
    cache.store("text", second);
    CHECK(cache.load("text") == second);
  }
}

TEST_CASE("program cache: a place that cannot be written is no error") {
  const OwnFolder folder;
  const ProgramCache cache("device");
  fs::create_directories(cache.file("text") / "held");
  cache.store("text", first);
  CHECK_FALSE(cache.load("text"));
  CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 1);  // no draft
  fs::remove_all(folder.path());
  std::ofstream(folder.path()) << "a file where the folder should be";
  cache.store("text", first);
  CHECK_FALSE(cache.load("text"));
  setenv("PCPHYS_CACHE", std::string(5000, 'a').c_str(), 1);
  const ProgramCache nowhere("device");
  nowhere.store("text", first);
  CHECK_FALSE(nowhere.load("text"));
}
