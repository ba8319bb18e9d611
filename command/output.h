// Where results go: standard output, or files that are known to be writable before a long run starts.
#pragma once
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>

#include "pcphys/result.h"

namespace pcphys::command {

using Json = nlohmann::ordered_json;

/// Where a result goes at the end of a run. Opening it checks that this will be possible, and leaves a file that is
/// there as it is.
class OutputFile {
 public:
  OutputFile() = default;
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&& other) noexcept;
  ~OutputFile();

  /// "" is no file; "-" is standard output, as is every other name of it, such as /dev/stdout. Errors: bad_file.
  static Result<OutputFile> open(const std::string& path);

  explicit operator bool() const { return !path_.empty(); }
  bool standard_output() const { return path_ == "-"; }
  /// Whether what is written to one would be lost or mixed with what is written to the other.
  bool same_place(const OutputFile& other) const { return !place_.empty() && place_ == other.place_; }
  /// Once at most. A file is replaced as a whole, or stays as it was; a device or a pipe is written directly.
  Status write(const std::string& content);

 private:
  Status prepare_file();
  Status prepare_stream();

  std::string path_;              // as it was given
  std::filesystem::path target_;  // where links from there lead
  std::string place_;             // equal for all names of one place; empty where two may write
  int stream_ = -1;               // descriptor of a device, a pipe or what is open already
};

/// An output that a sub-command was asked for.
struct Output {
  const char* option;
  std::string path;
  OutputFile& file;
};

/// Errors: bad_file; bad_argument where two outputs go to one place.
Status open_outputs(std::initializer_list<Output> outputs);

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
/// The sentence on one line, whatever names of files and other programs' messages hold.
void print_error(std::string sentence);

/// To be called first: a stream that is closed, a pipe without a reader and a file at its limit become errors of
/// writing.
void guard_streams();
/// To be called last, with the exit code of what was done. It says so when standard output did not take all that was
/// printed.
int finish_streams(int code);

}  // namespace pcphys::command
