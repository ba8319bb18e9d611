#include "glcompute/context.h"

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <vector>

#include "glcompute/egl_devices.h"
#include "step/processor_state.h"

namespace pcphys {
namespace {

Error unavailable(std::string message) { return {ErrorCode::unavailable, std::move(message)}; }

bool software_renderer(const std::string& renderer) {
  for (const char* name : {"llvmpipe", "softpipe", "swrast", "Software Rasterizer"})
    if (renderer.find(name) != std::string::npos) return true;
  return false;
}

/// The context that is current on this thread, through whichever library the host made it.
void* current_context() {
  if (epoxy_has_egl())
    if (void* context = eglGetCurrentContext()) return context;
  for (const char* library : {"libGLX.so.0", "libGL.so.1"}) {
    void* handle = dlopen(library, RTLD_LAZY | RTLD_NOLOAD);
    if (handle == nullptr) continue;
    const auto get = reinterpret_cast<void* (*)()>(dlsym(handle, "glXGetCurrentContext"));
    void* context = get != nullptr ? get() : nullptr;
    dlclose(handle);
    if (context != nullptr) return context;
  }
  return nullptr;
}

std::string text_of(GLenum name) {
  const GLubyte* text = glGetString(name);
  return text != nullptr ? reinterpret_cast<const char*>(text) : "";
}

std::uint32_t limit(GLenum name) {
  GLint value = 0;
  glGetIntegerv(name, &value);
  return std::uint32_t(value);
}

/// `notified`: a reset of the device is told (glGetGraphicsResetStatus);
/// otherwise results would go on as if nothing was.
EGLContext create_context(EGLDisplay display, EGLConfig config, int major, int minor, bool notified) {
  std::vector<EGLint> wanted;
  if (major != 0)
    wanted = {EGL_CONTEXT_MAJOR_VERSION,       major,
              EGL_CONTEXT_MINOR_VERSION,       minor,
              EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT};
#ifndef NDEBUG
  if (epoxy_egl_version(display) >= 15) wanted.insert(wanted.end(), {EGL_CONTEXT_OPENGL_DEBUG, EGL_TRUE});
#endif
  if (notified)
    wanted.insert(wanted.end(), {EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET});
  wanted.push_back(EGL_NONE);
  return eglCreateContext(display, config, EGL_NO_CONTEXT, wanted.data());
}

EGLConfig any_config(EGLDisplay display) {
  const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
  EGLConfig config = EGL_NO_CONFIG_KHR;
  EGLint count = 0;
  return eglChooseConfig(display, wanted, &config, 1, &count) && count > 0 ? config : EGL_NO_CONFIG_KHR;
}

#ifndef NDEBUG
void GLAPIENTRY on_debug(GLenum, GLenum type, GLuint, GLenum, GLsizei, const GLchar* message, const void* user) {
  auto* first = static_cast<std::string*>(const_cast<void*>(user));
  if (type == GL_DEBUG_TYPE_ERROR && first->empty()) *first = message;
}
#endif

}  // namespace

// ---- bindings ---------------------------------------------------------------------------------------
void GlBindings::save() {
  program_ = limit(GL_CURRENT_PROGRAM);
  storage_ = limit(GL_SHADER_STORAGE_BUFFER_BINDING);
  uniform_ = limit(GL_UNIFORM_BUFFER_BINDING);
  copied_ = limit(GL_COPY_READ_BUFFER_BINDING);
  copy_ = limit(GL_COPY_WRITE_BUFFER_BINDING);
  const auto range = [](GLenum binding, GLenum start, GLenum size, GLuint index) {
    GLint buffer = 0;
    Range range{};
    glGetIntegeri_v(binding, index, &buffer);
    range.buffer = std::uint32_t(buffer);
    glGetInteger64i_v(start, index, &range.start);
    glGetInteger64i_v(size, index, &range.size);
    return range;
  };
  for (GLuint i = 0; i < storage_ranges_.size(); i++)
    storage_ranges_[i] =
        range(GL_SHADER_STORAGE_BUFFER_BINDING, GL_SHADER_STORAGE_BUFFER_START, GL_SHADER_STORAGE_BUFFER_SIZE, i);
  uniform_range_ = range(GL_UNIFORM_BUFFER_BINDING, GL_UNIFORM_BUFFER_START, GL_UNIFORM_BUFFER_SIZE, 0);
}

void GlBindings::restore() const {
  const auto bind = [](GLenum target, GLuint index, const Range& range) {
    if (range.size > 0)
      glBindBufferRange(target, index, range.buffer, range.start, range.size);
    else
      glBindBufferBase(target, index, range.buffer);
  };
  for (GLuint i = 0; i < storage_ranges_.size(); i++) bind(GL_SHADER_STORAGE_BUFFER, i, storage_ranges_[i]);
  bind(GL_UNIFORM_BUFFER, 0, uniform_range_);
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, storage_);
  glBindBuffer(GL_UNIFORM_BUFFER, uniform_);
  glBindBuffer(GL_COPY_READ_BUFFER, copied_);
  glBindBuffer(GL_COPY_WRITE_BUFFER, copy_);
  glUseProgram(program_);
}

// ---- creation ---------------------------------------------------------------------------------------
Result<std::unique_ptr<GlContext>> GlContext::open(int device) {
  if (!epoxy_has_egl())
    return unavailable(
        "libEGL is not on this machine; install it (Debian, Ubuntu: apt-get install libegl1 libgl1-mesa-dri).");
  const std::vector<void*> devices = egl_devices();
  if (device >= 0) {
    if (std::size_t(device) >= devices.size())
      return unavailable("There is no EGL device " + std::to_string(device) + "; this machine has " +
                         std::to_string(devices.size()) + ". `pcphys doctor` lists them.");
    return open_display(egl_device_display(devices[std::size_t(device)]), device);
  }
  std::string problem;
  const auto attempt = [&](void* display, int index) -> std::unique_ptr<GlContext> {
    Result<std::unique_ptr<GlContext>> context = open_display(display, index);
    if (context) return std::move(*context);
    if (problem.empty()) problem = context.error().message;
    return nullptr;
  };
  for (std::size_t i = 0; i < devices.size(); i++)
    if (auto context = attempt(egl_device_display(devices[i]), int(i))) return context;
  if (auto context = attempt(egl_surfaceless_display(), -1)) return context;
  if (auto context = attempt(eglGetDisplay(EGL_DEFAULT_DISPLAY), -1)) return context;
  return unavailable(problem);
}

Result<std::unique_ptr<GlContext>> GlContext::open_display(void* display, int device) {
  const std::string cure =
      " Install a driver with OpenGL 4.3 (Debian, Ubuntu: apt-get install libgl1-mesa-dri libegl-mesa0).";
  // drivers that compute on the processor do so on threads that begin in the state of the one that opens the display
  const FlushSubnormals flush;
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr))
    return unavailable(device < 0 ? "No EGL display could be opened." + cure
                                  : "EGL device " + std::to_string(device) + " could not be opened." + cure);
  const EGLenum api = eglQueryAPI();
  eglBindAPI(EGL_OPENGL_API);
  const bool any = epoxy_has_egl_extension(display, "EGL_KHR_no_config_context") ||
                   epoxy_has_egl_extension(display, "EGL_MESA_configless_context");
  const EGLConfig config = any ? EGL_NO_CONFIG_KHR : any_config(display);
  std::unique_ptr<GlContext> made(new GlContext);
  made->report_.device = device;
  made->display_ = display;
  if (epoxy_egl_version(display) >= 15) made->context_ = create_context(display, config, 4, 3, true);
  if (made->context_ == EGL_NO_CONTEXT) made->context_ = create_context(display, config, 4, 3, false);
  const bool old = made->context_ == EGL_NO_CONTEXT;
  if (old) made->context_ = create_context(display, config, 0, 0, false);  // only to say which version there is
  eglBindAPI(api);
  if (made->context_ == EGL_NO_CONTEXT) return unavailable("The EGL display has no OpenGL contexts." + cure);
  GlScope scope(*made);
  if (!scope.status()) return unavailable(scope.status().error().message);
  const Status status = made->describe();
  if (old || !status)
    return unavailable("pcphys needs OpenGL 4.3; " +
                       (made->report_.renderer.empty() ? "this device" : made->report_.renderer) + " offers " +
                       made->report_.version + "." + cure);
  return made;
}

Result<std::unique_ptr<GlContext>> GlContext::adopt_current() {
  void* host = current_context();
  if (host == nullptr)
    return Error{
        ErrorCode::device_error,
        "No GL context is current on this thread; make the host's context current, or ask for a headless one."};
  std::unique_ptr<GlContext> made(new GlContext);
  made->host_ = host;
  GlScope scope(*made);
  if (!scope.status()) return scope.status().error();
  if (Status status = made->describe(); !status) return status.error();
  return made;
}

/// Version, names and limits, of the current context.
Status GlContext::describe() {
  report_.renderer = text_of(GL_RENDERER);
  report_.vendor = text_of(GL_VENDOR);
  report_.version = text_of(GL_VERSION);
  report_.software = software_renderer(report_.renderer);
  if (!epoxy_is_desktop_gl() || epoxy_gl_version() < 43)
    return unavailable("pcphys needs OpenGL 4.3; this context offers " + report_.version + ".");
  report_.limits.storage_blocks = limit(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS);
  report_.limits.shared_memory_bytes = limit(GL_MAX_COMPUTE_SHARED_MEMORY_SIZE);
  report_.limits.work_group_invocations = limit(GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS);
  GLint groups = 0;
  glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0, &groups);
  report_.limits.work_group_count = std::uint32_t(groups);
  GLint64 bytes = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
  report_.limits.storage_block_bytes = std::uint64_t(bytes);
  report_.usable = true;
#ifndef NDEBUG
  if (host_ == nullptr) {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(on_debug, &debug_message_);
  }
#endif
  return {};
}

/// Displays stay initialised: EGL hands the same one to everybody in the process, and nobody counts.
GlContext::~GlContext() {
  if (context_ == nullptr) return;
  if (depth_ > 0) {
    depth_ = 1;
    leave();
  }
  eglDestroyContext(display_, context_);
}

// ---- current ----------------------------------------------------------------------------------------
Status GlContext::enter() {
  if (depth_ == 0) {
    if (Status status = make_current(); !status) return status;
    if (host_ != nullptr) {
      host_errors_.take();  // not ours to report
      bindings_.save();
    }
  }
  depth_++;
  return {};
}

Status GlContext::make_current() {
  if (host_ != nullptr) {
    if (current_context() == host_) return {};
    return Error{ErrorCode::device_error,
                 "The host's GL context is not current on this thread (or was destroyed); make it current before "
                 "calling pcphys."};
  }
  switched_ = eglGetCurrentContext() != context_;
  if (!switched_) return {};
  before_ = {eglGetCurrentDisplay(), eglGetCurrentSurface(EGL_DRAW), eglGetCurrentSurface(EGL_READ),
             eglGetCurrentContext(), eglQueryAPI()};
  eglBindAPI(EGL_OPENGL_API);
  if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) return {};
  eglBindAPI(before_.api);
  return Error{ErrorCode::device_error,
               "The GL context could not be made current; it is in use on another thread, or a GLX context is current "
               "on this one."};
}

void GlContext::leave() {
  if (--depth_ > 0) return;
  if (host_ != nullptr) {
    host_errors_.give_back();
    bindings_.restore();
  } else if (switched_) {
    if (before_.context != EGL_NO_CONTEXT)
      eglMakeCurrent(before_.display, before_.draw, before_.read, before_.context);
    else
      eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglBindAPI(before_.api);
  }
}

Status GlContext::check(const std::string& doing) {
  const bool reset = epoxy_gl_version() >= 45 && glGetGraphicsResetStatus() != GL_NO_ERROR;
  const GLenum code = glGetError();
  if (reset || code == GL_CONTEXT_LOST)
    return Error{ErrorCode::device_error,
                 "The GL device was reset while " + doing +
                     ", and its context is lost; go on with a new stepper, and with less work at a time."};
  if (code == GL_NO_ERROR) return {};
  while (glGetError() != GL_NO_ERROR) {}
  const char* what = code == GL_OUT_OF_MEMORY   ? "out of memory"
                     : code == GL_INVALID_VALUE ? "invalid value"
                     : code == GL_INVALID_ENUM  ? "invalid enumerant"
                                                : "invalid operation";
  std::string message = "GL reports " + std::string(what) + " while " + doing + ".";
  if (!debug_message_.empty()) message += " " + debug_message_;
  debug_message_.clear();
  return Error{ErrorCode::device_error, std::move(message)};
}

}  // namespace pcphys
