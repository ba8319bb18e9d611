#include "output.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>

#include "draft.h"

namespace pcphys::command {
namespace {

namespace fs = std::filesystem;

Error cannot_write(const std::string& path, int reason) {
  const std::string why = reason ? std::string(": ") + std::strerror(reason) : "";
  return {ErrorCode::bad_file,
          "Cannot write '" + path + "'" + why + "; give a file in a folder that exists, may be written and has room."};
}

/// Whether the path is the name of a descriptor of this process, as /dev/fd/3 is.
bool names_descriptor(const fs::path& path) {
  std::error_code ignored;
  return fs::weakly_canonical(folder_of(path), ignored).string().starts_with("/proc/");
}

/// Where a chain of links ends, which may be a file that is not there yet.
fs::path followed(fs::path path) {
  std::error_code error;
  while (!names_descriptor(path)) {
    const fs::path next = fs::read_symlink(path, error);
    if (error) break;
    path = path.parent_path() / next;
  }
  return path;
}

std::string number_of(const struct stat& status) {
  return std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino);
}

/// Two outputs may go to one device, and /dev/null is not standard output even where that is /dev/null too.
bool is_standard_output(const struct stat& status) {
  struct stat own {};
  if (fstat(STDOUT_FILENO, &own) != 0 || number_of(own) != number_of(status)) return false;
  return !S_ISCHR(status.st_mode) || isatty(STDOUT_FILENO);
}

}  // namespace

OutputFile::OutputFile(OutputFile&& other) noexcept { *this = std::move(other); }

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(target_, other.target_);
  std::swap(place_, other.place_);
  std::swap(stream_, other.stream_);
  return *this;
}

OutputFile::~OutputFile() {
  if (stream_ >= 0) close(stream_);
}

Result<OutputFile> OutputFile::open(const std::string& path) {
  OutputFile file;
  if (path.empty()) return file;
  struct stat status {};
  const bool exists = stat(path.c_str(), &status) == 0;
  if (path == "-" || (exists && is_standard_output(status))) {
    file.path_ = file.place_ = "-";
    return file;
  }
  if (!exists && errno != ENOENT) return cannot_write(path, errno);
  if (exists && S_ISDIR(status.st_mode)) return cannot_write(path, EISDIR);
  file.path_ = path;
  file.target_ = followed(path);
  if (exists && !S_ISCHR(status.st_mode)) file.place_ = number_of(status);
  const bool stream = exists && (!S_ISREG(status.st_mode) || names_descriptor(file.target_));
  if (auto ready = stream ? file.prepare_stream() : file.prepare_file(); !ready) return ready.error();
  return file;
}

Status OutputFile::prepare_stream() {
  stream_ = ::open(path_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  if (stream_ < 0) return cannot_write(path_, errno);
  return {};
}

/// Makes a draft that is thrown away at once, for what only that can tell.
Status OutputFile::prepare_file() {
  if (place_.empty()) {
    struct stat folder {};
    if (stat(folder_of(target_).c_str(), &folder) != 0) return cannot_write(path_, errno);
    place_ = number_of(folder) + "/" + target_.filename().string();
  } else if (access(target_.c_str(), W_OK) != 0) {
    return cannot_write(path_, errno);
  }
  const SignalsWait wait;
  if (!Draft(target_).made()) return cannot_write(path_, errno);
  return {};
}

Status OutputFile::write(const std::string& content) {
  if (path_.empty()) return {};
  if (standard_output()) {
    std::cout << content;  // `finish_streams` tells whether it arrived
    return {};
  }
  if (stream_ >= 0) {
    if (!write_all(stream_, content)) return cannot_write(path_, errno);
    return {};
  }
  const SignalsWait wait;
  Draft draft(target_);
  if (!draft.made() || !draft.becomes_target(content)) return cannot_write(path_, errno);
  return {};
}

Status open_outputs(std::initializer_list<Output> outputs) {
  for (const Output& output : outputs) {
    auto file = OutputFile::open(output.path);
    if (!file) return file.error();
    output.file = std::move(*file);
    const Output& first = *std::ranges::find_if(
        outputs, [&](const Output& other) { return &other == &output || other.file.same_place(output.file); });
    if (&first == &output) continue;
    const std::string place = output.file.standard_output() ? "Standard output" : "The file '" + output.path + "'";
    return Error{ErrorCode::bad_argument, place + " is asked for by " + first.option + " and by " + output.option +
                                              "; give one of them another file, or leave it out."};
  }
  return {};
}

Result<ResultFiles> ResultFiles::open(const std::string& json, const std::string& csv) {
  ResultFiles files;
  if (auto status = open_outputs({{"--json", json, files.json}, {"--csv", csv, files.csv}}); !status)
    return status.error();
  return files;
}

Status ResultFiles::write(const Json& as_json, const std::string& as_csv) {
  if (auto status = csv.write(as_csv); !status) return status;
  return json.write(as_json.dump(2) + "\n");
}

Progress::Progress(std::string label, std::uint64_t total, const char* unit)
    : label_(std::move(label)),
      unit_(unit),
      total_(total),
      started_(now()),
      shown_(started_),
      terminal_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (drawn_) std::fprintf(stderr, "\r\033[K");
}

void Progress::show(std::uint64_t done) {
  const double time = now();
  if (!terminal_ || time - started_ < 1 || time - shown_ < 0.1) return;
  shown_ = time;
  drawn_ = true;
  const double left = (time - started_) / double(done) * double(total_ - done);
  std::fprintf(stderr, "\r%s: %s %llu of %llu, %.0f s left\033[K", label_.c_str(), unit_, (unsigned long long)done,
               (unsigned long long)total_, left);
}

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

void print_error(std::string sentence) {
  for (char& c : sentence)
    if (std::iscntrl(static_cast<unsigned char>(c))) c = ' ';
  std::cerr << "pcphys: " << sentence << "\n";
}

int fail(const Error& error) {
  print_error(error.message);
  const bool usage = error.code == ErrorCode::bad_argument || error.code == ErrorCode::unknown_name ||
                     error.code == ErrorCode::bad_time_step;
  return usage ? exit_usage : exit_failed;
}

void guard_streams() {
  // The number of a closed stream would go to the next file that is opened, and the stream's text with it. /dev/null
  // that is opened the wrong way holds the number, and refuses what is written.
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0) ::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

int finish_streams(int code) {
  errno = 0;
  std::cout.flush();
  const bool flushed = std::fflush(stdout) == 0;
  const int reason = errno;
  if (flushed && std::cout && !std::ferror(stdout)) return code;
  const std::string why = reason ? std::string(": ") + std::strerror(reason) : "";
  print_error("Cannot write all of the result to standard output" + why + "; give it a file or a pipe that takes it.");
  return exit_failed;
}

}  // namespace pcphys::command
