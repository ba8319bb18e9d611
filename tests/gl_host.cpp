// Pins what a host with GL of its own sees of pcphys: after every call the context, surfaces and API that were current
// are so again, and a GL error that the host has not read yet is still there to read, whether pcphys has a context of
// its own or uses the host's.
#include <doctest/doctest.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <string>
#include <vector>

#include "glcompute/egl_devices.h"
#include "pcphys/device.h"
#include "pcphys/pcphys.h"
#include "pcphys/write_kernel.h"

namespace {
using namespace pcphys;

PCPHYS_KERNEL(lift, (PC_INOUT(Vec3) force, PC_PARAM(Vec3) push), { force = pc_add(force, push); })

/// A context as a host makes one: with a small surface, or without any.
class HostContext {
 public:
  explicit HostContext(bool surface) {
    std::vector<void*> displays{egl_surfaceless_display()};
    for (void* device : egl_devices()) displays.push_back(egl_device_display(device));
    for (std::size_t i = 0; i < displays.size() && context_ == EGL_NO_CONTEXT; i++) open(displays[i], surface);
    if (context_ == EGL_NO_CONTEXT)
      FAIL("This test needs OpenGL 4.3 through EGL (scripts/install-dependencies brings llvmpipe).");
    REQUIRE(eglMakeCurrent(display_, surface_, surface_, context_));
  }
  HostContext(const HostContext&) = delete;
  HostContext& operator=(const HostContext&) = delete;
  ~HostContext() {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (surface_ != EGL_NO_SURFACE) eglDestroySurface(display_, surface_);
    eglDestroyContext(display_, context_);
  }
  bool is_current() const {
    return eglGetCurrentContext() == context_ && eglGetCurrentDisplay() == display_ &&
           eglGetCurrentSurface(EGL_DRAW) == surface_ && eglGetCurrentSurface(EGL_READ) == surface_ &&
           eglQueryAPI() == EGL_OPENGL_API;
  }

 private:
  void open(EGLDisplay display, bool surface) {
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) return;
    eglBindAPI(EGL_OPENGL_API);
    const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, surface ? EGL_PBUFFER_BIT : 0,
                             EGL_NONE};
    EGLConfig config{};
    EGLint count = 0;
    if (!eglChooseConfig(display, wanted, &config, 1, &count) || count == 0) return;
    const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 3, EGL_NONE};
    const EGLint size[] = {EGL_WIDTH, 8, EGL_HEIGHT, 8, EGL_NONE};
    if (surface) surface_ = eglCreatePbufferSurface(display, config, size);
    if (surface && surface_ == EGL_NO_SURFACE) return;
    display_ = display;
    context_ = eglCreateContext(display, config, EGL_NO_CONTEXT, version);
  }
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  EGLSurface surface_ = EGL_NO_SURFACE;
};

/// Some error of the host's, in its context.
void leave_error(GLenum code) {
  GLuint object = 0;
  switch (code) {
    case GL_INVALID_ENUM: return glEnable(0xdead);
    case GL_INVALID_VALUE: return glViewport(0, 0, -1, -1);
    case GL_INVALID_OPERATION: return glUseProgram(glCreateShader(GL_COMPUTE_SHADER));  // no program
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      glGenFramebuffers(1, &object);
      glBindFramebuffer(GL_FRAMEBUFFER, object);
      glClear(GL_COLOR_BUFFER_BIT);
      return glBindFramebuffer(GL_FRAMEBUFFER, 0);
    default:
      glGenBuffers(1, &object);
      glBindBuffer(GL_ARRAY_BUFFER, object);
      return glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(1) << 60, nullptr, GL_STATIC_DRAW);
  }
}
constexpr GLenum errors[] = {
    GL_NO_ERROR,     GL_INVALID_ENUM, GL_INVALID_VALUE, GL_INVALID_OPERATION, GL_INVALID_FRAMEBUFFER_OPERATION,
    GL_OUT_OF_MEMORY};

StepSettings on_gl(bool host_context) {
  StepSettings settings;
  settings.set_all(Place::gl);
  settings.host_context = host_context;
  settings.resident = true;
  return settings;
}

/// Calls that reach a device, from the first to the last; `look` after each.
template <class Look> void use(bool host_context, Look look) {
  World world;
  BodyDef def;
  def.shapes = {ShapeDef::sphere(0.5)};
  const Result<BodyId> body = world.create_body(def);
  REQUIRE(body);
  {
    Stepper stepper(on_gl(host_context));
    const auto step = [&] {
      const StepReport& report = stepper.step(world, 1.0 / 60);
      CHECK_MESSAGE(report, report.error.message);
    };
    step();
    look("the first step");
    step();
    look("a step");
    CHECK(world.view("position"));
    look("a view of what the device holds");
    CHECK(stepper.add_kernel(world, {.text = lift::text(), .parameters = {{"push", Vec3{0, 20, 0}}}}));
    look("a kernel");
    CHECK_FALSE(stepper.add_kernel(
        world, {.text = {.name = "broken", .signature = "(PC_INOUT(Vec3) force)", .body = "{ force = none; }"}}));
    look("a kernel that is refused");
    step();
    look("a step with a kernel");
    CHECK_FALSE(stepper.step(world, -1));
    look("a step that is refused");
    CHECK(world.hash() != 0);
    look("a hash");
  }
  look("the end of a stepper");
}

void check_untouched(const HostContext& host, bool host_context) {
  for (const GLenum code : errors) {
    CAPTURE(code);
    while (glGetError() != GL_NO_ERROR) {}
    if (code != GL_NO_ERROR) leave_error(code);
    use(host_context, [&](const char* after) {
      CAPTURE(std::string(after));
      CHECK(host.is_current());
      CHECK(glGetError() == code);
      CHECK(glGetError() == GL_NO_ERROR);
      if (code != GL_NO_ERROR) leave_error(code);
    });
  }
  while (glGetError() != GL_NO_ERROR) {}
}

}  // namespace

TEST_CASE("beside a context of the host's: it is current again after every call, and its errors are its own") {
  for (const bool surface : {false, true}) {
    CAPTURE(surface);
    const HostContext host(surface);
    check_untouched(host, false);
    glEnable(0xdead);
    CHECK(probe_gl(-1).usable);
    CHECK(host.is_current());
    CHECK_FALSE(gl_devices().empty());
    CHECK_FALSE(probe_gl(99).usable);
    CHECK(host.is_current());
    CHECK(glGetError() == GL_INVALID_ENUM);
  }
}

TEST_CASE("in the host's context: what it had not read of errors is there to read") {
  const HostContext host(true);
  check_untouched(host, true);
}

TEST_CASE("where nothing was current nothing is after a call, and the API is the one that was bound") {
  REQUIRE(eglBindAPI(EGL_OPENGL_ES_API));
  use(false, [](const char* after) {
    CAPTURE(std::string(after));
    CHECK(eglGetCurrentContext() == EGL_NO_CONTEXT);
    CHECK(eglQueryAPI() == EGL_OPENGL_ES_API);
  });
  eglBindAPI(EGL_OPENGL_API);
}
