#include "glcompute/gl_buffer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <string>

namespace pcphys {
namespace {

Status allocate(std::string_view label, std::size_t bytes, std::uint32_t& id) {
  if (id == 0) glGenBuffers(1, &id);
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, id);
  glBufferData(GL_SHADER_STORAGE_BUFFER, GLsizeiptr(bytes), nullptr, GL_DYNAMIC_COPY);
  if (glGetError() != GL_OUT_OF_MEMORY) return {};
  return Error{ErrorCode::buffer_full, "The GL device has no memory for the buffer `" + std::string(label) + "` of " +
                                           std::to_string(bytes) + " bytes."};
}

void copy(std::uint32_t from, std::uint32_t to, std::size_t bytes) {
  glBindBuffer(GL_COPY_READ_BUFFER, from);
  glBindBuffer(GL_COPY_WRITE_BUFFER, to);
  glCopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, 0, 0, GLsizeiptr(bytes));
}

}  // namespace

// A new store each time: the one before may still be read from.
void GlStaging::write(std::uint32_t storage, std::size_t offset, std::size_t bytes, const void* from) {
  if (there_ == 0) glGenBuffers(1, &there_);
  glBindBuffer(GL_COPY_READ_BUFFER, there_);
  glBufferData(GL_COPY_READ_BUFFER, GLsizeiptr(bytes), from, GL_STREAM_DRAW);
  glBindBuffer(GL_COPY_WRITE_BUFFER, storage);
  glCopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, 0, GLintptr(offset), GLsizeiptr(bytes));
}

void GlStaging::read(std::uint32_t storage, std::size_t offset, std::size_t bytes, void* to) {
  if (back_ == 0) glGenBuffers(1, &back_);
  glBindBuffer(GL_COPY_WRITE_BUFFER, back_);
  if (bytes > room_) glBufferData(GL_COPY_WRITE_BUFFER, GLsizeiptr(room_ = bytes), nullptr, GL_STREAM_READ);
  glBindBuffer(GL_COPY_READ_BUFFER, storage);
  glCopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, GLintptr(offset), 0, GLsizeiptr(bytes));
  glGetBufferSubData(GL_COPY_WRITE_BUFFER, 0, GLsizeiptr(bytes), to);
}

void GlStaging::release() {
  for (const std::uint32_t id : {there_, back_})
    if (id != 0) glDeleteBuffers(1, &id);
  *this = GlStaging();
}

Status GlBuffer::resize(std::string_view label, std::size_t bytes, std::uint64_t limit) {
  if (bytes > limit)
    return Error{ErrorCode::buffer_full, "The buffer `" + std::string(label) + "` needs " + std::to_string(bytes) +
                                             " bytes; this GL device takes at most " + std::to_string(limit) +
                                             ". Make the scene smaller, or use the CPU backend."};
  if (id_ != 0 && bytes <= capacity_) return {};
  constexpr std::size_t smallest = 256;  // an empty buffer cannot be bound
  const std::size_t half_more = capacity_ + capacity_ / 2;
  const std::size_t wanted = std::max({bytes, smallest, std::min<std::size_t>(half_more, limit)});
  if (Status ok = allocate(label, wanted, id_); !ok) return release(), ok;
  capacity_ = wanted;
  return {};
}

Status GlBuffer::keep(std::string_view label) {
  if (bytes_ == 0) return {};
  if (kept_capacity_ < bytes_) {
    kept_capacity_ = 0;
    if (Status ok = allocate(label, capacity_, kept_id_); !ok) return ok;
    kept_capacity_ = capacity_;
  }
  copy(id_, kept_id_, bytes_);
  return {};
}

void GlBuffer::put_back() const {
  if (bytes_ > 0 && kept_capacity_ >= bytes_) copy(kept_id_, id_, bytes_);
}

void GlBuffer::upload(GlStaging& staging) const {
  if (bytes_ > 0) staging.write(id_, 0, bytes_, host_);
}

void GlBuffer::download(GlStaging& staging) const {
  if (bytes_ > 0) staging.read(id_, 0, bytes_, host_);
}

bool GlBuffer::take(GlStaging& staging, std::size_t offset, std::size_t bytes) const {
  constexpr std::uint64_t none = 0;
  std::uint64_t value = 0;
  staging.read(id_, offset, bytes, &value);
  if (value != 0) staging.write(id_, offset, bytes, &none);
  return value != 0;
}

void GlBuffer::release() {
  for (const std::uint32_t id : {id_, kept_id_})
    if (id != 0) glDeleteBuffers(1, &id);
  *this = GlBuffer();
}

}  // namespace pcphys
