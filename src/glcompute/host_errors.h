// Errors that a host has left unread in its own GL context. pcphys asks the context for errors of its own, which takes
// the host's along; GL has no call that puts one back, so the host's are raised anew, by calls that are wrong in the
// same way and change nothing.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace pcphys {

/// The host's context must be current.
class HostErrors {
 public:
  /// The context has none then.
  void take();
  /// The host finds what was taken. Binds buffers for copies; the rest of the context's state is as before.
  void give_back();

 private:
  std::array<std::uint32_t, 8> codes_{};  // a context may keep one of each kind
  std::size_t count_ = 0;
};

}  // namespace pcphys
