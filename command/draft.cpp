#include "draft.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

namespace pcphys::command {
namespace {

volatile std::sig_atomic_t arrived = 0;

void remember(int signal) { arrived = signal; }

}  // namespace

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : ".";
}

bool write_all(int descriptor, const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t written = write(descriptor, bytes.data() + done, bytes.size() - done);
    if (written < 0 && errno != EINTR) return false;
    if (written > 0) done += std::size_t(written);
  }
  return true;
}

/// The name does not grow with the target's, which may be as long as names can be.
Draft::Draft(const std::filesystem::path& target) : target_(target) {
  for (unsigned serial = 0; descriptor_ < 0; ++serial) {
    name_ = folder_of(target) / (".pcphys-" + std::to_string(getpid()) + "-" + std::to_string(serial));
    descriptor_ = open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno != EEXIST) return;
  }
}

Draft::~Draft() {
  if (!made()) return;
  const int reason = errno;
  close(descriptor_);
  if (!name_.empty()) unlink(name_.c_str());
  errno = reason;
}

void Draft::take_over_permissions() {
  struct stat status {};
  if (stat(target_.c_str(), &status) != 0) return;
  // Only a privileged process may give a file away; for others it becomes their own.
  [[maybe_unused]] const int given = fchown(descriptor_, status.st_uid, status.st_gid);
  fchmod(descriptor_, status.st_mode & 07777);
}

bool Draft::becomes_target(const std::string& content) {
  take_over_permissions();
  if (!write_all(descriptor_, content) || fsync(descriptor_) != 0) return false;
  if (std::rename(name_.c_str(), target_.c_str()) != 0) return false;
  name_.clear();
  return true;
}

SignalsWait::SignalsWait() {
  arrived = 0;
  struct sigaction note {};
  note.sa_handler = remember;
  note.sa_flags = SA_RESTART;
  for (std::size_t i = 0; i < signals.size(); ++i) {
    sigaction(signals[i], nullptr, &before_[i]);
    if (before_[i].sa_handler != SIG_IGN) sigaction(signals[i], &note, nullptr);
  }
}

SignalsWait::~SignalsWait() {
  for (std::size_t i = 0; i < signals.size(); ++i) sigaction(signals[i], &before_[i], nullptr);
  if (arrived) std::raise(arrived);
}

}  // namespace pcphys::command
