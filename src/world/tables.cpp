#include "world/tables.h"

#include <cassert>

namespace pcphys {

Tables::Tables(Precision precision) : precision_(precision) {
  // row 0 of every table is the padding row
  for (std::size_t t = 0; t < table_count; t++) resize(Table(t), 1);
}

void Tables::resize(Table table, std::uint32_t rows) {
  const std::uint32_t before = rows_[std::size_t(table)];
  layout_++;
  for (std::size_t b = 0; b < table_buffer_count; b++)
    if (schema(Buffer(b)).table == table) {
      bytes_[b].resize(rows * row_bytes(Buffer(b)));
      versions_[b]++;
    }
  rows_[std::size_t(table)] = rows;
  for (const PropertySchema& p : properties()) {
    if (p.table != table || p.initial == 0) continue;
    for (std::uint32_t row = before; row < rows; row++) {
      if (p.type == PropertyType::quat)
        set(p.buffer, row, p.offset + 3, p.initial);
      else
        for (std::uint32_t c = 0; c < components(p.type); c++) set(p.buffer, row, p.offset + c, p.initial);
    }
  }
}

void Tables::copy_row(Table table, std::uint32_t from, std::uint32_t to) {
  for (std::size_t b = 0; b < table_buffer_count; b++) {
    if (schema(Buffer(b)).table != table) continue;
    const std::size_t n = row_bytes(Buffer(b));
    versions_[b]++;
    std::memcpy(bytes_[b].data() + to * n, bytes_[b].data() + from * n, n);
  }
}

double Tables::get(Buffer buffer, std::uint32_t row, std::uint32_t offset) const {
  assert(row < rows(schema(buffer).table));
  const std::size_t i = std::size_t(row) * schema(buffer).reals + offset;
  return precision_ == Precision::f32 ? double(data<float>(buffer)[i]) : data<double>(buffer)[i];
}
void Tables::set(Buffer buffer, std::uint32_t row, std::uint32_t offset, double value) {
  assert(row < rows(schema(buffer).table));
  const std::size_t i = std::size_t(row) * schema(buffer).reals + offset;
  if (precision_ == Precision::f32)
    data<float>(buffer)[i] = float(value);
  else
    data<double>(buffer)[i] = value;
  touch(buffer);
}
Vec3 Tables::get3(Buffer buffer, std::uint32_t row, std::uint32_t offset) const {
  return {get(buffer, row, offset), get(buffer, row, offset + 1), get(buffer, row, offset + 2)};
}
void Tables::set3(Buffer buffer, std::uint32_t row, std::uint32_t offset, Vec3 v) {
  set(buffer, row, offset, v.x);
  set(buffer, row, offset + 1, v.y);
  set(buffer, row, offset + 2, v.z);
}
Quat Tables::get4(Buffer buffer, std::uint32_t row, std::uint32_t offset) const {
  return {get(buffer, row, offset), get(buffer, row, offset + 1), get(buffer, row, offset + 2), get(buffer, row, offset + 3)};
}
void Tables::set4(Buffer buffer, std::uint32_t row, std::uint32_t offset, Quat q) {
  set3(buffer, row, offset, {q.x, q.y, q.z});
  set(buffer, row, offset + 3, q.w);
}

std::size_t Tables::memory_bytes() const {
  std::size_t sum = 0;
  for (const AlignedBytes& b : bytes_) sum += b.capacity();
  return sum;
}

}  // namespace pcphys
