#include "glcompute/gl_buffer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <string>

namespace pcphys {

Status GlBuffer::resize(std::string_view label, std::size_t bytes, std::uint64_t limit) {
  if (bytes > limit)
    return Error{ErrorCode::buffer_full, "The buffer `" + std::string(label) + "` needs " + std::to_string(bytes) +
                                             " bytes; this GL device takes at most " + std::to_string(limit) +
                                             ". Make the scene smaller, or use the CPU backend."};
  if (id_ != 0 && bytes <= capacity_) return {};
  constexpr std::size_t smallest = 256;  // an empty buffer cannot be bound
  const std::size_t half_more = capacity_ + capacity_ / 2;
  const std::size_t wanted = std::max({bytes, smallest, std::min<std::size_t>(half_more, limit)});
  if (id_ == 0) glGenBuffers(1, &id_);
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, id_);
  glBufferData(GL_SHADER_STORAGE_BUFFER, GLsizeiptr(wanted), nullptr, GL_DYNAMIC_COPY);
  if (glGetError() == GL_OUT_OF_MEMORY) {
    release();
    return Error{ErrorCode::buffer_full, "The GL device has no memory for the buffer `" + std::string(label) + "` of " +
                                             std::to_string(wanted) + " bytes."};
  }
  capacity_ = wanted;
  return {};
}

void GlBuffer::upload() const {
  if (bytes_ == 0) return;
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, id_);
  glBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, GLsizeiptr(bytes_), host_);
}

void GlBuffer::download() const {
  if (bytes_ == 0) return;
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, id_);
  glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, GLsizeiptr(bytes_), host_);
}

bool GlBuffer::take(std::size_t offset, std::size_t bytes) const {
  constexpr std::uint64_t none = 0;
  std::uint64_t value = 0;
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, id_);
  glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, GLintptr(offset), GLsizeiptr(bytes), &value);
  if (value != 0) glBufferSubData(GL_SHADER_STORAGE_BUFFER, GLintptr(offset), GLsizeiptr(bytes), &none);
  return value != 0;
}

void GlBuffer::release() {
  if (id_ != 0) glDeleteBuffers(1, &id_);
  *this = GlBuffer();
}

}  // namespace pcphys
