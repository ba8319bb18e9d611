// An OpenGL 4.3 context without a window: one of our own through EGL, or the one that a host has made current.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "glcompute/host_errors.h"
#include "pcphys/device.h"
#include "pcphys/result.h"

namespace pcphys {

/// What the backend binds, as it was before: a host finds its own bindings again.
class GlBindings {
 public:
  void save();
  void restore() const;

 private:
  struct Range {
    std::uint32_t buffer;
    std::int64_t start, size;
  };
  std::uint32_t program_ = 0, storage_ = 0, uniform_ = 0, copied_ = 0, copy_ = 0;
  std::array<Range, 8> storage_ranges_{};
  Range uniform_range_{};
};

class GlContext {
 public:
  /// device: index into the EGL devices, -1 for the first that works.
  static Result<std::unique_ptr<GlContext>> open(int device);
  /// The context that is current on this thread.
  static Result<std::unique_ptr<GlContext>> adopt_current();
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  /// Makes the own context current on this thread; of a host's it checks that it is, and keeps its bindings and its
  /// unread errors. Calls nest; `leave` of the outermost restores what was.
  Status enter();
  void leave();
  /// GL errors since the last look, and lost devices.
  Status check(const std::string& doing);

  const GlReport& report() const { return report_; }  // without the arithmetic
  std::string identity() const { return report_.vendor + "|" + report_.renderer + "|" + report_.version; }

 private:
  GlContext() = default;
  Status describe();
  Status make_current();
  static Result<std::unique_ptr<GlContext>> open_display(void* display, int device);

  GlReport report_;
  void* display_ = nullptr;  // EGL, of our own context
  void* context_ = nullptr;
  void* host_ = nullptr;  // the host's context, GLX or EGL
  int depth_ = 0;
  bool switched_ = false;
  struct Current {
    void *display, *draw, *read, *context;
    unsigned api;
  } before_{};
  GlBindings bindings_;
  HostErrors host_errors_;
  std::string debug_message_;  // the driver's first complaint, debug builds only
};

/// Inside this scope the context is current.
class GlScope {
 public:
  explicit GlScope(GlContext& context) : context_(context), status_(context.enter()) {}
  ~GlScope() {
    if (status_) context_.leave();
  }
  GlScope(const GlScope&) = delete;
  GlScope& operator=(const GlScope&) = delete;
  const Status& status() const { return status_; }

 private:
  GlContext& context_;
  Status status_;
};

}  // namespace pcphys
