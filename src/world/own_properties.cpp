#include "world/own_properties.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace pcphys {
namespace {

template <class T> double load(const std::byte* p) {
  T value;
  std::memcpy(&value, p, sizeof value);
  return double(value);
}
template <class T> void store(std::byte* p, double number) {
  const T value = T(number);
  std::memcpy(p, &value, sizeof value);
}

}  // namespace

std::uint32_t OwnProperties::add(OwnProperty property) {
  std::uint32_t k = 0;
  while (k < list.size() && list[k].used) k++;
  if (k == list.size()) list.emplace_back();
  property.generation = list[k].generation + 1;
  property.used = true;
  list[k] = std::move(property);
  return k;
}

bool OwnProperties::named(Buffer buffer) const {
  return std::ranges::any_of(list, [&](const OwnProperty& p) { return p.used && p.named && p.buffer == buffer; });
}

void OwnProperties::name(Buffer buffer) {
  for (OwnProperty& p : list)
    if (p.used && p.buffer == buffer) p.named = true;
}

std::string_view OwnProperties::table_name(Table table) const {
  for (const OwnTable& t : tables)
    if (t.used && t.table == table) return t.name;
  return pcphys::name(table);
}

std::pair<std::string_view, std::string_view> OwnProperties::names(Buffer buffer) const {
  for (const OwnProperty& p : list)
    if (p.used && p.buffer == buffer) return {p.name, table_name(p.table)};
  return {schema(buffer).name, of_table(buffer) ? pcphys::name(schema(buffer).table) : std::string_view()};
}

std::vector<Field> fields(const Tables& tables, const OwnProperties& own, Table table, Role role) {
  std::vector<Field> found;
  const std::size_t real = tables.real_bytes();
  for (const PropertySchema& p : properties())
    if (p.table == table && p.role == role)
      found.push_back({p.buffer, std::uint32_t(p.offset * real), std::uint32_t(components(p.type) * real), p.type});
  for (const OwnProperty& p : own.list)
    if (p.used && p.table == table && p.role == role)
      found.push_back({p.buffer, 0, std::uint32_t(components(p.type) * number_bytes(p.type, real)), p.type});
  return found;
}

std::size_t number_bytes(PropertyType type, std::size_t real_bytes) {
  switch (type) {
    case PropertyType::float32:
    case PropertyType::int32:
    case PropertyType::uint32: return 4;
    case PropertyType::float64: return 8;
    default: return real_bytes;
  }
}

std::size_t own_row_bytes(PropertyType type, std::size_t real_bytes) {
  const std::uint32_t n = components(type);
  return (n == 1 ? 1 : (n + 3) / 4 * 4) * number_bytes(type, real_bytes);
}

double read_number(const std::byte* p, PropertyType type, std::size_t real_bytes) {
  if (type == PropertyType::int32) return load<std::int32_t>(p);
  if (type == PropertyType::uint32) return load<std::uint32_t>(p);
  return number_bytes(type, real_bytes) == 4 ? load<float>(p) : load<double>(p);
}

void write_number(std::byte* p, PropertyType type, std::size_t real_bytes, double value) {
  if (type == PropertyType::int32)
    store<std::int32_t>(p, value);
  else if (type == PropertyType::uint32)
    store<std::uint32_t>(p, value);
  else if (number_bytes(type, real_bytes) == 4)
    store<float>(p, value);
  else
    store<double>(p, value);
}

}  // namespace pcphys
