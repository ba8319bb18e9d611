// The storage of all tables: one aligned block of bytes a buffer, in the precision of the world.
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "pcphys/math.h"
#include "pcphys/types.h"
#include "world/memory.h"
#include "world/schema.h"

namespace pcphys {

class Tables {
 public:
  explicit Tables(Precision precision);

  Precision precision() const { return precision_; }
  std::size_t real_bytes() const { return precision_ == Precision::f32 ? 4 : 8; }
  std::uint32_t rows(Table table) const { return rows_[std::size_t(table)]; }
  std::size_t row_bytes(Buffer buffer) const { return schema(buffer).reals * real_bytes(); }

  /// New rows hold every property's initial value.
  void resize(Table table, std::uint32_t rows);
  void copy_row(Table table, std::uint32_t from, std::uint32_t to);

  /// Takes over the rows of a table of one buffer, handing back those it had.
  void exchange(Table table, Buffer buffer, AlignedBytes& bytes, std::uint32_t rows) {
    std::swap(bytes_[std::size_t(buffer)], bytes);
    rows_[std::size_t(table)] = rows;
    touch(buffer);
  }

  AlignedBytes& bytes(Buffer buffer) { return bytes_[std::size_t(buffer)]; }
  const AlignedBytes& bytes(Buffer buffer) const { return bytes_[std::size_t(buffer)]; }
  template <class Scalar> Scalar* data(Buffer buffer) { return reinterpret_cast<Scalar*>(bytes(buffer).data()); }
  template <class Scalar> const Scalar* data(Buffer buffer) const {
    return reinterpret_cast<const Scalar*>(bytes(buffer).data());
  }

  /// Counts the changes of a buffer, so that a device knows when its copy is old.
  std::uint64_t version(Buffer buffer) const { return versions_[std::size_t(buffer)]; }
  void touch(Buffer buffer) { versions_[std::size_t(buffer)]++; }
  /// Counts the changes of where buffers stand and how long they are, but for what `exchange` does.
  std::uint64_t layout() const { return layout_; }

  // one value at a time, in double, for the border
  double get(Buffer buffer, std::uint32_t row, std::uint32_t offset) const;
  void set(Buffer buffer, std::uint32_t row, std::uint32_t offset, double value);
  Vec3 get3(Buffer buffer, std::uint32_t row, std::uint32_t offset) const;
  void set3(Buffer buffer, std::uint32_t row, std::uint32_t offset, Vec3 value);
  Quat get4(Buffer buffer, std::uint32_t row, std::uint32_t offset) const;
  void set4(Buffer buffer, std::uint32_t row, std::uint32_t offset, Quat value);

  std::size_t memory_bytes() const;

 private:
  Precision precision_;
  std::array<AlignedBytes, table_buffer_count> bytes_;
  std::array<std::uint32_t, table_count> rows_{};
  std::array<std::uint64_t, table_buffer_count> versions_{};
  std::uint64_t layout_ = 0;
};

}  // namespace pcphys
