// How much work waits for the device.
#pragma once
#include <epoxy/gl.h>

namespace pcphys {

/// Keeps it short: drivers end a context whose work takes them seconds, and other processes on the device make it take
/// longer (docs/gpu.md). Not more than two batches of dispatches wait.
class GlQueue {
 public:
  /// After each dispatch, in the context.
  void dispatched() {
    if (++dispatches_ < batch) return;
    dispatches_ = 0;
    const GLsync now = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    wait_for_last();
    last_ = now;
  }
  void release() { wait_for_last(); }

 private:
  static constexpr unsigned batch = 256;

  void wait_for_last() {
    if (last_ == nullptr) return;
    glClientWaitSync(last_, GL_SYNC_FLUSH_COMMANDS_BIT, ~GLuint64{0});  // where it fails, so will `check`
    glDeleteSync(last_);
    last_ = nullptr;
  }

  GLsync last_ = nullptr;  // ends the batch before this one
  unsigned dispatches_ = 0;
};

}  // namespace pcphys
