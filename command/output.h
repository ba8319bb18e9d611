// Where results go: standard output, or files that are known to be writable before a long run starts.
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "pcphys/result.h"

namespace pcphys::command {

using Json = nlohmann::ordered_json;

/// A file that the result will be written to at the end. Opening it checks that this will be possible; when
/// nothing is written in the end, a file that was not there before is not there after.
class OutputFile {
 public:
  OutputFile() = default;
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&& other) noexcept;
  ~OutputFile();

  /// "" is no file, "-" is standard output. Errors: bad_file.
  static Result<OutputFile> open(const std::string& path);

  explicit operator bool() const { return !path_.empty(); }
  bool standard_output() const { return path_ == "-"; }
  const std::string& path() const { return path_; }
  Status write(const std::string& content);

 private:
  std::string path_;
  bool created_ = false;
};

/// Where --json and --csv of a sub-command go.
struct ResultFiles {
  OutputFile json, csv;

  static Result<ResultFiles> open(const std::string& json, const std::string& csv);
  /// Whether the result is printed for people: nothing else goes to standard output, and there is no JSON.
  bool printed() const { return !json && !csv.standard_output(); }
  Status write(const Json& as_json, const std::string& as_csv);
};

/// A line on standard error that counts up while a long run is under way, on a terminal only.
class Progress {
 public:
  /// `unit` is what is counted.
  Progress(std::string label, std::uint64_t total, const char* unit = "step");
  ~Progress();
  void show(std::uint64_t done);

 private:
  std::string label_;
  const char* unit_;
  std::uint64_t total_;
  double started_, shown_;
  bool terminal_, drawn_ = false;
};

/// Seconds of a clock that only goes forward.
double now();

/// Exit codes of the command.
enum Exit : int { exit_ok = 0, exit_failed = 1, exit_usage = 2, exit_unsound = 3, exit_missed = 4 };

/// Prints one line to standard error, and says which code to exit with.
int fail(const Error& error);

}  // namespace pcphys::command
