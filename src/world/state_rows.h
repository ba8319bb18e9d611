// What of the tables is state, and the hash over it.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <vector>

#include "world/state.h"

namespace pcphys {

/// FNV-1a, 64 bit. Reals are taken by their bits, with -0 as +0 and what is no number as one.
class Hash {
 public:
  void bytes(const void* data, std::size_t n) {
    for (std::size_t i = 0; i < n; i++)
      value_ = (value_ ^ static_cast<const unsigned char*>(data)[i]) * 1099511628211ull;
  }
  template <class Scalar> void reals(const std::byte* p, std::size_t n) {
    for (std::size_t i = 0; i < n; i += sizeof(Scalar)) {
      Scalar x;
      std::memcpy(&x, p + i, sizeof x);
      if (x == 0) x = 0;
      if (x != x) x = std::numeric_limits<Scalar>::quiet_NaN();
      bytes(&x, sizeof x);
    }
  }
  void index(std::uint32_t i) { bytes(&i, sizeof i); }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037ull;
};

/// What of a table is state, and where it stands.
class StateRows {
 public:
  /// of_hash: with those of the host's that a kernel has named; of_snapshots: with all of the host's; shown: also what
  /// hosts are shown though it is none.
  enum Of : std::uint8_t { of_hash, of_snapshots, shown };
  StateRows(const WorldState& s, Table table, Of of)
      : tables_(s.tables), fields_(fields(s.tables, s.own, table, Role::state)) {
    for (const Field& f : fields(s.tables, s.own, table, Role::host))
      if (of != of_hash || s.own.named(f.buffer)) fields_.push_back(f);
    for (const Role role : {Role::input, Role::derived})
      if (of == shown) std::ranges::copy(fields(s.tables, s.own, table, role), std::back_inserter(fields_));
    for (const Field& f : fields_) bytes_ += f.bytes;
  }
  /// Those in the buffer alone, or all others.
  StateRows within(Buffer buffer, bool within = true) const {
    StateRows part = *this;
    std::erase_if(part.fields_, [&](const Field& f) { return (f.buffer == buffer) != within; });
    return part;
  }
  std::size_t bytes() const { return bytes_; }  // of a row
  const Tables& tables() const { return tables_; }
  /// what(field, where it begins in the buffer)
  template <class Do> void each(std::uint32_t row, Do&& what) const {
    for (const Field& f : fields_) what(f, row * tables_.row_bytes(f.buffer) + f.offset);
  }
  void hash(Hash& hash, std::uint32_t row) const {
    each(row, [&](const Field& f, std::size_t at) {
      const std::byte* p = tables_.bytes(f.buffer).data() + at;
      if (f.type == PropertyType::int32 || f.type == PropertyType::uint32)
        hash.bytes(p, f.bytes);
      else if (number_bytes(f.type, tables_.real_bytes()) == 4)
        hash.reals<float>(p, f.bytes);
      else
        hash.reals<double>(p, f.bytes);
    });
  }

 private:
  const Tables& tables_;
  std::vector<Field> fields_;
  std::size_t bytes_ = 0;
};

}  // namespace pcphys
