// Runs the built program as a user would, and keeps what it said.
#pragma once
#include <sys/wait.h>
#include <unistd.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>

namespace pcphys::test {

using Json = nlohmann::json;

inline std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// A folder of its own for every test case, gone at its end.
class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "pcphys-test-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  /// Names of all files, hidden ones too.
  std::set<std::string> names() const {
    std::set<std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) all.insert(entry.path().filename());
    return all;
  }

 private:
  std::filesystem::path path_;
};

struct Ran {
  int code = -1;
  std::string out, error;

  Json json() const { return Json::parse(out, nullptr, false); }
};

/// Whatever the shell makes of the line.
inline Ran shell(const std::string& line) {
  Folder folder;
  const std::string whole = "( " + line + " ) >" + folder.file("out") + " 2>" + folder.file("error") + " </dev/null";
  const int status = std::system(whole.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(folder.file("out")), read_file(folder.file("error"))};
}

/// `pcphys ARGUMENTS`, through the shell.
inline Ran command(const std::string& arguments) { return shell(std::string(PCPHYS_COMMAND) + " " + arguments); }

struct Refused {
  const char* arguments;
  int code;
  const char* says;  // in the message
};

/// One line on standard error that says so, the right code, and nothing on standard output.
inline void check_refused(std::span<const Refused> cases) {
  for (const Refused& c : cases) {
    CAPTURE(std::string(c.arguments));
    const Ran ran = command(c.arguments);
    CAPTURE(ran.error);
    CHECK(ran.code == c.code);
    CHECK(ran.out.empty());
    CHECK(ran.error.starts_with("pcphys: "));
    CHECK(ran.error.find(c.says) != std::string::npos);
    CHECK(std::count(ran.error.begin(), ran.error.end(), '\n') == 1);
    CHECK(ran.error.ends_with("\n"));
  }
}

/// Whether `--backend gl` can work here.
inline bool has_gl() {
  static const bool usable = [] {
    const Json report = command("doctor --json -").json();
    for (const Json& device : report["gl"])
      if (device["usable"].get<bool>()) return true;
    return false;
  }();
  return usable;
}

}  // namespace pcphys::test
