// The storage of all tables: one aligned block of bytes a buffer, in the precision of the world.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "pcphys/math.h"
#include "pcphys/types.h"
#include "world/memory.h"
#include "world/schema.h"

namespace pcphys {

/// Steps on the CPU take numbers below the normal ones for zero, and devices may hand them on: to everybody they are
/// zero from the start.
template <class Scalar> Scalar normal(double value) {
  const Scalar x = Scalar(value);
  return std::fabs(x) < std::numeric_limits<Scalar>::min() ? Scalar(0) : x;
}

/// Holds the newest rows of buffers that the host has not asked for since a device wrote them.
class Keeper {
 public:
  /// Puts them where the tables keep them.
  virtual void fetch(Buffer buffer) = 0;
  /// The tables are gone.
  virtual void lose() = 0;

 protected:
  ~Keeper() = default;
};

/// A buffer's rows are there once something asks for them: those that only steps use (Role::scratch) until then take no
/// memory, nor do those of tables without rows, and rows that a keeper holds come from it.
class Tables {
 public:
  explicit Tables(Precision precision);
  Tables(const Tables&) = delete;
  Tables& operator=(const Tables&) = delete;
  ~Tables();

  Precision precision() const { return precision_; }
  std::size_t real_bytes() const { return precision_ == Precision::f32 ? 4 : 8; }
  std::uint32_t rows(Table table) const { return rows_[std::size_t(table)]; }
  std::size_t row_bytes(Buffer buffer) const { return columns_[index(buffer)].row_bytes; }
  Table table_of(Buffer buffer) const { return columns_[index(buffer)].table; }

  /// So that `resize` up to so many rows needs no memory.
  void reserve(Table table, std::uint32_t rows);
  /// New rows hold every property's initial value. Where there is no memory for them, nothing changes.
  void resize(Table table, std::uint32_t rows);
  void copy_row(Table table, std::uint32_t from, std::uint32_t to);

  /// Gives back what is more than the rows there are, and rows that steps alone use.
  void shrink();

  /// A buffer of the host's own beside those of the table; all rows hold `initial`, which is as long as a row.
  Buffer add(Table table, std::span<const std::byte> initial);
  void remove(Buffer own);
  /// A table of the host's own, with a row that pads and no buffer.
  Table add_table();
  void remove_table(Table own);

  /// Takes over the rows of a table of one buffer, handing back those it had.
  void exchange(Table table, Buffer buffer, AlignedBytes& bytes, std::uint32_t rows) {
    std::swap(at(buffer).bytes, bytes);
    rows_[std::size_t(table)] = rows;
    touch(buffer);
  }

  /// From now on the keeper has the newest rows; those here are old until they are asked for.
  void leave(Buffer buffer, Keeper* keeper);
  /// Brings home all that it holds; it is none of theirs any more.
  void take_back(Keeper* keeper);
  /// Who has newer rows of it than stand here, or null.
  const Keeper* keeper(Buffer buffer) const { return columns_[index(buffer)].keeper; }
  /// Whether some keeper holds rows, or did.
  bool kept() const { return !keepers_.empty(); }
  /// Where rows stand, or will once they are asked for.
  AlignedBytes& place_of(Buffer buffer);
  /// Bytes taken, also of a buffer that nobody has asked for.
  std::size_t held_bytes(Buffer buffer) const { return columns_[index(buffer)].bytes.capacity(); }

  AlignedBytes& bytes(Buffer buffer) { return at(buffer).bytes; }
  const AlignedBytes& bytes(Buffer buffer) const { return at(buffer).bytes; }
  template <class Scalar> Scalar* data(Buffer buffer) { return reinterpret_cast<Scalar*>(bytes(buffer).data()); }
  template <class Scalar> const Scalar* data(Buffer buffer) const {
    return reinterpret_cast<const Scalar*>(bytes(buffer).data());
  }

  /// Counts the changes of a buffer, so that a device knows when its copy is old.
  std::uint64_t version(Buffer buffer) const { return columns_[index(buffer)].version; }
  void touch(Buffer buffer) { columns_[index(buffer)].version++; }
  void touch_all();
  /// Counts the changes of where buffers stand and how long they are, but for what `exchange` does.
  std::uint64_t layout() const { return layout_; }

  // one value at a time, in double, for the border; of buffers of reals
  double get(Buffer buffer, std::uint32_t row, std::uint32_t offset) const;
  void set(Buffer buffer, std::uint32_t row, std::uint32_t offset, double value);
  Vec3 get3(Buffer buffer, std::uint32_t row, std::uint32_t offset) const;
  void set3(Buffer buffer, std::uint32_t row, std::uint32_t offset, Vec3 value);
  Quat get4(Buffer buffer, std::uint32_t row, std::uint32_t offset) const;
  void set4(Buffer buffer, std::uint32_t row, std::uint32_t offset, Quat value);

  std::size_t memory_bytes() const;
  /// Whether every buffer is as long as its table's rows, or has no memory yet.
  bool are_long_enough() const;

 private:
  struct Column {
    bool used = false, made = false;  // made: rows have memory
    bool on_demand = false;           // only steps use it
    Keeper* keeper = nullptr;         // has newer rows
    Table table{};
    std::size_t row_bytes = 0;
    AlignedBytes initial;  // one row
    AlignedBytes bytes;
    std::uint64_t version = 0;
  };
  template <std::size_t n>
  void write(Buffer buffer, std::uint32_t row, std::uint32_t offset, const std::array<double, n>& values);
  /// Columns stand in the order of the list of buffers, the host's own behind them.
  static std::size_t index(Buffer buffer) {
    return is_own(buffer) ? std::size_t(buffer) - buffer_count + table_buffer_count : std::size_t(buffer);
  }
  Column& at(Buffer buffer) {
    Column& column = columns_[index(buffer)];
    if (!column.made || column.keeper) [[unlikely]]
      make_current(buffer);
    return column;
  }
  const Column& at(Buffer buffer) const { return const_cast<Tables*>(this)->at(buffer); }  // what it shows is the same
  void make_current(Buffer buffer);
  static Buffer buffer_at(std::size_t k) {
    return k < table_buffer_count ? Buffer(k) : own_buffer(k - table_buffer_count);
  }
  void fill(Column& column, std::uint32_t before, std::uint32_t rows);
  void add_listed(Buffer buffer);

  Precision precision_;
  std::vector<Column> columns_;
  std::vector<std::uint32_t> rows_;                     // by Table; 0: removed
  std::vector<std::vector<std::uint32_t>> columns_of_;  // by Table, those that are used
  std::uint64_t layout_ = 0;
  std::vector<Keeper*> keepers_;  // that hold rows, or did
};

}  // namespace pcphys
