// A file that is written under another name, and takes the place of an older one only when it is whole.
#pragma once
#include <array>
#include <csignal>
#include <filesystem>
#include <string>

namespace pcphys::command {

/// "." for a bare name.
std::filesystem::path folder_of(const std::filesystem::path& path);

/// All of the bytes, however many calls that takes; errno tells why not.
bool write_all(int descriptor, const std::string& bytes);

/// A new file beside its target. It goes with its object, unless it became the target.
class Draft {
 public:
  explicit Draft(const std::filesystem::path& target);
  Draft(const Draft&) = delete;
  ~Draft();

  /// If not, errno tells why.
  bool made() const { return descriptor_ >= 0; }
  /// Writes the content and takes the target's place, with the owner and the permissions that the target had.
  /// If that fails, the target is as it was and errno tells why.
  bool becomes_target(const std::string& content);

 private:
  void take_over_permissions();

  std::filesystem::path target_, name_;
  int descriptor_ = -1;
};

/// While one lives, a signal that would end the program waits until its end, so that no draft is left behind.
class SignalsWait {
 public:
  SignalsWait();
  SignalsWait(const SignalsWait&) = delete;
  ~SignalsWait();

 private:
  static constexpr std::array signals{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
  std::array<struct sigaction, signals.size()> before_{};
};

}  // namespace pcphys::command
