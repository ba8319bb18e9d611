// Nets: bodies that springs between points join, where no pin holds any of them. The springs of a net are solved at
// once (kernels/net_solve.inl).
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "plan/octave_of.h"
#include "step/backend.h"
#include "world/memory.h"
#include "world/state.h"

namespace pcphys {

struct Net {
  std::vector<std::uint32_t> bodies;   // rows, in the order of their ids: those that move and those that do not
  std::vector<std::uint32_t> springs;  // joint rows, in the order of their ids
  std::vector<std::uint32_t> links;    // of each spring the places in `bodies` of a and of b
  std::size_t memory_bytes() const { return bytes_of(bodies, springs, links); }
  std::uint32_t moving = 0;  // row of a body that moves
};

/// What the kernels read, for blocks of `width` nets of one shape; see net_rows.inl.
struct NetBlocks {
  std::vector<std::uint32_t> list;
  std::vector<Range> ranges;  // of blocks, by octave
  std::size_t memory_bytes() const { return bytes_of(list, ranges); }
  std::uint32_t slots = 0;  // of one lane
};

class Nets {
 public:
  void build(const WorldState& state);
  std::size_t count() const { return nets_.size(); }
  const Net& net(std::size_t i) const { return nets_[i]; }
  /// By joint row: whether a net holds that spring.
  bool holds(std::uint32_t row) const { return held_[row] != 0; }
  std::uint32_t springs() const { return springs_; }
  /// How many nets of one shape there are, of the shape of which there are most.
  std::uint32_t most_alike() const { return most_alike_; }
  void pack(std::uint32_t width, OctaveOf of, NetBlocks& out) const;
  std::size_t memory_bytes() const { return bytes_of(nets_, shapes_, held_); }

 private:
  void add(const WorldState& state, std::span<const std::uint32_t> springs);

  std::vector<Net> nets_;
  std::vector<std::vector<std::uint32_t>> shapes_;  // nets that are alike
  std::vector<char> held_;
  std::uint32_t springs_ = 0, most_alike_ = 0;
};

}  // namespace pcphys
