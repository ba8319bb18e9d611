#include "output.h"

#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>

namespace pcphys::command {
namespace {

Error cannot_write(const std::string& path, int reason) {
  const std::string why = reason ? std::string(": ") + std::strerror(reason) : "";
  return {ErrorCode::bad_file, "Cannot write '" + path + "'" + why + "; give a file in a folder that exists and may be written."};
}

}  // namespace

OutputFile::OutputFile(OutputFile&& other) noexcept { *this = std::move(other); }

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(created_, other.created_);
  return *this;
}

OutputFile::~OutputFile() {
  std::error_code ignored;
  if (created_) std::filesystem::remove(path_, ignored);
}

Result<OutputFile> OutputFile::open(const std::string& path) {
  OutputFile file;
  if (path.empty()) return file;
  if (path != "-") {
    std::error_code ignored;
    const bool existed = std::filesystem::exists(path, ignored);
    errno = 0;
    if (!std::ofstream(path, std::ios::app | std::ios::binary)) return cannot_write(path, errno);
    file.created_ = !existed;
  }
  file.path_ = path;
  return file;
}

Status OutputFile::write(const std::string& content) {
  if (path_.empty()) return {};
  if (standard_output()) {
    std::cout << content << std::flush;
    if (!std::cout) return cannot_write("standard output", 0);
    return {};
  }
  errno = 0;
  std::ofstream file(path_, std::ios::trunc | std::ios::binary);
  file << content;
  file.close();
  if (!file) return cannot_write(path_, errno);
  created_ = false;
  return {};
}

Result<ResultFiles> ResultFiles::open(const std::string& json, const std::string& csv) {
  auto json_file = OutputFile::open(json), csv_file = OutputFile::open(csv);
  if (!json_file) return json_file.error();
  if (!csv_file) return csv_file.error();
  return ResultFiles{std::move(*json_file), std::move(*csv_file)};
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

int fail(const Error& error) {
  std::cerr << "pcphys: " << error.message << "\n";
  const bool usage =
      error.code == ErrorCode::bad_argument || error.code == ErrorCode::unknown_name || error.code == ErrorCode::bad_time_step;
  return usage ? exit_usage : exit_failed;
}

}  // namespace pcphys::command
