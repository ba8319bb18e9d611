#include "glcompute/host_errors.h"

#include <epoxy/gl.h>

#include <limits>

namespace pcphys {
namespace {

constexpr GLenum no_such_name = 0xffffffffu;

/// Maps no buffer.
void raise_invalid_operation() {
  glBindBuffer(GL_COPY_READ_BUFFER, 0);
  glUnmapBuffer(GL_COPY_READ_BUFFER);
}

/// Reads from a framebuffer that has nothing to read.
void raise_invalid_framebuffer_operation() {
  GLint before = 0;
  glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &before);
  GLuint empty = 0;
  glGenFramebuffers(1, &empty);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, empty);
  GLubyte pixel[4];
  glReadPixels(0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(before));
  glDeleteFramebuffers(1, &empty);
}

/// Asks for more than any device has.
void raise_out_of_memory() {
  GLuint buffer = 0;
  glGenBuffers(1, &buffer);
  glBindBuffer(GL_COPY_WRITE_BUFFER, buffer);
  glBufferData(GL_COPY_WRITE_BUFFER, std::numeric_limits<GLsizeiptr>::max(), nullptr, GL_STATIC_DRAW);
  glDeleteBuffers(1, &buffer);
}

void raise(GLenum code) {
  GLint value = 0;
  switch (code) {
    case GL_INVALID_ENUM: return void(glIsEnabled(no_such_name));
    case GL_INVALID_VALUE: return glGetIntegeri_v(GL_UNIFORM_BUFFER_BINDING, no_such_name, &value);
    case GL_INVALID_FRAMEBUFFER_OPERATION: return raise_invalid_framebuffer_operation();
    case GL_OUT_OF_MEMORY: return raise_out_of_memory();
    default: return raise_invalid_operation();  // a stack of the host's that is full or empty, too
  }
}

}  // namespace

void HostErrors::take() {
  count_ = 0;
  while (count_ < codes_.size()) {
    const GLenum code = glGetError();
    if (code == GL_NO_ERROR) return;
    codes_[count_++] = code;
    if (code == GL_CONTEXT_LOST) return;  // there is no end of these, and each call finds one
  }
}

void HostErrors::give_back() {
  for (std::size_t i = 0; i < count_; i++)
    if (codes_[i] != GL_CONTEXT_LOST) raise(codes_[i]);
  count_ = 0;
}

}  // namespace pcphys
