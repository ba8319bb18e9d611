#include "glcompute/gl_memory.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cstring>
#include <string>

namespace pcphys {
namespace {

std::string_view label_of(Buffer buffer) {
  return is_own(buffer) ? "a property of the host's own" : schema(buffer).name;
}

}  // namespace

void GlMemory::start(Precision precision, const GlLimits& limits) {
  limits_ = limits;
  GLint alignment = 1;
  glGetIntegerv(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT, &alignment);
  info_bytes_ = precision == Precision::f64 ? sizeof(InfoOf<double>) : sizeof(InfoOf<float>);
  const std::size_t step = std::size_t(std::max(alignment, 1));
  info_stride_ = (info_bytes_ + step - 1) / step * step;
  glGenBuffers(1, &info_buffer_);
}

void GlMemory::release() {
  for (GlBuffer& buffer : buffers_) buffer.release();
  glDeleteBuffers(1, &info_buffer_);
}

Status GlMemory::resize(Buffer buffer, std::size_t bytes) {
  return at(buffer).resize(label_of(buffer), bytes, limits_.storage_block_bytes);
}

Status GlMemory::keep(Buffer buffer) { return at(buffer).keep(label_of(buffer)); }

Status GlMemory::check_transferable(Buffer buffer) {
  if (at(buffer).attached() && at(buffer).transferable()) return {};
  return Error{ErrorCode::bad_argument, "The buffer `" + std::string(label_of(buffer)) +
                                            "` has no memory on the host; attach it before a transfer."};
}

void GlMemory::set_infos(const void* infos, std::size_t count) {
  info_staging_.resize(count * info_stride_);
  for (std::size_t i = 0; i < count; i++)
    std::memcpy(info_staging_.data() + i * info_stride_, static_cast<const char*>(infos) + i * info_bytes_,
                info_bytes_);
  glBindBuffer(GL_UNIFORM_BUFFER, info_buffer_);
  if (count > info_capacity_) {
    glBufferData(GL_UNIFORM_BUFFER, GLsizeiptr(info_staging_.size()), info_staging_.data(), GL_DYNAMIC_DRAW);
    info_capacity_ = count;
  } else {
    glBufferSubData(GL_UNIFORM_BUFFER, 0, GLsizeiptr(info_staging_.size()), info_staging_.data());
  }
  info_count_ = count;
}

Status GlMemory::bind(Buffer buffer, std::uint32_t binding, std::string_view kernel) {
  if (!at(buffer).attached())
    return Error{ErrorCode::bad_argument, "The kernel `" + std::string(kernel) + "` uses the buffer `" +
                                              std::string(label_of(buffer)) +
                                              "`, which was neither attached nor reserved."};
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, at(buffer).id());
  return {};
}

Status GlMemory::bind(std::span<const Access> accesses, std::string_view kernel) {
  std::uint32_t binding = 0;
  for (const Access& access : accesses)
    if (Status status = bind(access.buffer, binding++, kernel); !status) return status;
  return {};
}

Status GlMemory::bind_info(std::size_t info) {
  if (info >= info_count_)
    return Error{ErrorCode::bad_argument, "There is no info block " + std::to_string(info) + "; set_infos gave " +
                                              std::to_string(info_count_) + "."};
  glBindBufferRange(GL_UNIFORM_BUFFER, 0, info_buffer_, GLintptr(info * info_stride_), GLsizeiptr(info_bytes_));
  return {};
}

}  // namespace pcphys
