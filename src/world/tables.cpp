#include "world/tables.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

namespace pcphys {

Tables::Tables(Precision precision)
    : precision_(precision), columns_(table_buffer_count), rows_(table_count, 0), columns_of_(table_count) {
  for (std::size_t b = 0; b < table_buffer_count; b++) add_listed(Buffer(b));
  // row 0 of every table is the padding row
  for (std::size_t t = 0; t < table_count; t++) resize(Table(t), 1);
}

void Tables::add_listed(Buffer buffer) {
  Column& column = columns_[index(buffer)];
  column.used = true;
  column.table = schema(buffer).table;
  columns_of_[std::size_t(column.table)].push_back(std::uint32_t(index(buffer)));
  column.row_bytes = schema(buffer).reals * real_bytes();
  column.initial.resize(column.row_bytes);
  column.on_demand = !holds(buffer, Role::input) && !holds(buffer, Role::state) && !holds(buffer, Role::derived);
  const auto put = [&](std::uint32_t offset, double value) {
    if (precision_ == Precision::f32)
      reinterpret_cast<float*>(column.initial.data())[offset] = float(value);
    else
      reinterpret_cast<double*>(column.initial.data())[offset] = value;
  };
  for (const PropertySchema& p : properties()) {
    if (p.buffer != buffer || p.initial == 0) continue;
    const bool turn = p.type == PropertyType::quat;
    for (std::uint32_t c = turn ? 3 : 0; c < components(p.type); c++) put(p.offset + c, p.initial);
  }
}

void Tables::fill(Column& column, std::uint32_t before, std::uint32_t rows) {
  const std::size_t n = column.row_bytes;
  column.bytes.resize(rows * n);
  for (std::uint32_t row = before; row < rows; row++)
    std::memcpy(column.bytes.data() + row * n, column.initial.data(), n);
  column.version++;
}

void Tables::reserve(Table table, std::uint32_t rows) {
  for (const std::uint32_t k : columns_of_[std::size_t(table)]) {
    Column& column = columns_[k];
    if (column.made || (rows > 1 && !column.on_demand)) column.bytes.reserve(rows * column.row_bytes);
  }
}

void Tables::resize(Table table, std::uint32_t rows) {
  reserve(table, rows);
  const std::uint32_t before = std::exchange(rows_[std::size_t(table)], rows);
  layout_++;
  for (const std::uint32_t k : columns_of_[std::size_t(table)]) {
    Column& column = columns_[k];
    if (!column.made && (rows <= 1 || column.on_demand)) {
      column.version++;
      continue;
    }
    if (column.keeper) std::exchange(column.keeper, nullptr)->fetch(buffer_at(k));
    fill(column, column.made ? before : 0, rows);
    column.made = true;
  }
}

Tables::~Tables() {
  for (Keeper* keeper : keepers_) keeper->lose();
}

void Tables::make_current(Buffer buffer) {
  Column& column = columns_[index(buffer)];
  place_of(buffer);
  if (column.keeper) std::exchange(column.keeper, nullptr)->fetch(buffer);
}

AlignedBytes& Tables::place_of(Buffer buffer) {
  Column& column = columns_[index(buffer)];
  if (!column.made) {
    fill(column, 0, rows(column.table));
    column.made = true;
    layout_++;
  }
  return column.bytes;
}

void Tables::leave(Buffer buffer, Keeper* keeper) {
  Column& column = columns_[index(buffer)];
  column.version++;
  column.keeper = keeper;
  if (std::ranges::find(keepers_, keeper) == keepers_.end()) keepers_.push_back(keeper);
}

void Tables::take_back(Keeper* keeper) {
  std::erase(keepers_, keeper);
  for (std::size_t k = 0; k < columns_.size(); k++)
    if (columns_[k].keeper == keeper) make_current(buffer_at(k));
}

void Tables::copy_row(Table table, std::uint32_t from, std::uint32_t to) {
  for (const std::uint32_t k : columns_of_[std::size_t(table)]) {
    Column& column = columns_[k];
    if (!column.made) continue;
    if (column.keeper) make_current(buffer_at(k));
    const std::size_t n = column.row_bytes;
    column.version++;
    std::memcpy(column.bytes.data() + to * n, column.bytes.data() + from * n, n);
  }
}

Buffer Tables::add(Table table, std::span<const std::byte> initial) {
  std::size_t k = table_buffer_count;
  while (k < columns_.size() && columns_[k].used) k++;
  if (k == columns_.size()) columns_.emplace_back();
  std::vector<std::uint32_t>& of_table = columns_of_[std::size_t(table)];
  pcphys::make_room(of_table);
  Column column;
  column.version = columns_[k].version;  // goes on: a device may still hold what stood here before
  column.used = column.made = true;
  column.table = table;
  column.row_bytes = initial.size();
  column.initial.resize(initial.size());
  std::memcpy(column.initial.data(), initial.data(), initial.size());
  fill(column, 0, rows(table));
  columns_[k] = std::move(column);
  of_table.push_back(std::uint32_t(k));
  layout_++;
  return own_buffer(k - table_buffer_count);
}

void Tables::remove(Buffer own) {
  const std::uint64_t version = this->version(own);
  Column& column = columns_[index(own)];
  std::erase(columns_of_[std::size_t(column.table)], std::uint32_t(index(own)));
  column = {};
  column.version = version + 1;
  layout_++;
}

Table Tables::add_table() {
  std::size_t t = table_count;
  while (t < rows_.size() && rows_[t] > 0) t++;
  if (columns_of_.size() == t) columns_of_.emplace_back();
  if (rows_.size() == t) rows_.push_back(0);
  rows_[t] = 1;
  return Table(t);
}

void Tables::remove_table(Table own) {
  while (!columns_of_[std::size_t(own)].empty()) remove(buffer_at(columns_of_[std::size_t(own)].back()));
  rows_[std::size_t(own)] = 0;
}

void Tables::shrink() {
  for (Column& column : columns_) {
    if (column.on_demand && column.made && !column.keeper) {
      column.bytes = AlignedBytes();
      column.made = false;
    }
    column.bytes.shrink();
  }
  layout_++;
}

void Tables::touch_all() {
  for (Column& column : columns_) column.version++;
}

namespace {
/// The n reals of a row from `offset` on.
template <std::size_t n>
std::array<double, n> read(const Tables& tables, Buffer buffer, std::uint32_t row, std::uint32_t offset) {
  const std::byte* from =
      tables.bytes(buffer).data() + row * tables.row_bytes(buffer) + std::size_t(offset) * tables.real_bytes();
  std::array<double, n> values;
  if (tables.precision() == Precision::f32)
    std::copy_n(reinterpret_cast<const float*>(from), n, values.begin());
  else
    std::copy_n(reinterpret_cast<const double*>(from), n, values.begin());
  return values;
}
}  // namespace

double Tables::get(Buffer buffer, std::uint32_t row, std::uint32_t offset) const {
  assert(row < rows(columns_[index(buffer)].table));
  return read<1>(*this, buffer, row, offset)[0];
}
template <std::size_t n>
void Tables::write(Buffer buffer, std::uint32_t row, std::uint32_t offset, const std::array<double, n>& values) {
  Column& column = at(buffer);
  assert(row < rows(column.table));
  std::byte* to = column.bytes.data() + row * column.row_bytes + std::size_t(offset) * real_bytes();
  if (precision_ == Precision::f32)
    std::ranges::transform(values, reinterpret_cast<float*>(to), normal<float>);
  else
    std::ranges::transform(values, reinterpret_cast<double*>(to), normal<double>);
  column.version++;
}
void Tables::set(Buffer buffer, std::uint32_t row, std::uint32_t offset, double value) {
  write<1>(buffer, row, offset, {value});
}
Vec3 Tables::get3(Buffer buffer, std::uint32_t row, std::uint32_t offset) const {
  assert(row < rows(columns_[index(buffer)].table));
  const auto [x, y, z] = read<3>(*this, buffer, row, offset);
  return {x, y, z};
}
void Tables::set3(Buffer buffer, std::uint32_t row, std::uint32_t offset, Vec3 v) {
  write<3>(buffer, row, offset, {v.x, v.y, v.z});
}
Quat Tables::get4(Buffer buffer, std::uint32_t row, std::uint32_t offset) const {
  assert(row < rows(columns_[index(buffer)].table));
  const auto [x, y, z, w] = read<4>(*this, buffer, row, offset);
  return {x, y, z, w};
}
void Tables::set4(Buffer buffer, std::uint32_t row, std::uint32_t offset, Quat q) {
  write<4>(buffer, row, offset, {q.x, q.y, q.z, q.w});
}

bool Tables::are_long_enough() const {
  return std::ranges::all_of(columns_, [&](const Column& column) {
    const std::size_t wanted = column.used && column.made ? rows(column.table) * column.row_bytes : 0;
    return column.bytes.size() == wanted;
  });
}

std::size_t Tables::memory_bytes() const {
  std::size_t sum = 0;
  for (const Column& column : columns_) sum += column.bytes.capacity() + column.initial.capacity();
  return sum;
}

}  // namespace pcphys
