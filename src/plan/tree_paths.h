// Joint trees as contacts see them: which bodies answer together, and the ways between roots and bodies.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "plan/forest.h"
#include "world/memory.h"

namespace pcphys {

/// The nodes of a forest as rows of the table of nodes (row 0 pads), by body row and by node row.
class TreeNodes {
 public:
  /// For contacts larger trees are left out: each of their contacts would wait for all others, and walk far. Their
  /// bodies answer contacts alone, and their joints follow.
  static constexpr std::uint32_t largest_tree = 64;
  /// For joints that close loops trees are left out where bodies times such joints are more than this, nets: every one
  /// of them waits for all others.
  static constexpr std::size_t most_loop_visits = 8192;

  /// `masses` by body row, 0 for bodies that nothing moves. `closings`, by tree: how many joints close a loop on it.
  /// Without them, as contacts see the forest. Rows are the same in both.
  void build(const Forest& forest, std::span<const double> masses, std::span<const std::uint32_t> closings = {});

  std::uint32_t rows() const { return std::uint32_t(parent_.size()); }
  /// Row of a body's node; 0: it stands in no tree, or in one that is too large, or does not move.
  std::uint32_t node(std::uint32_t body) const { return node_[body]; }
  /// Whether the body moves in a tree that is too large.
  bool is_large(std::uint32_t body) const { return large_[body]; }
  /// What answers an impulse on the body: itself, or the first moving body of its tree.
  std::uint32_t unit(std::uint32_t body) const { return unit_[body]; }
  /// Of a node; 0 above a root.
  std::uint32_t parent(std::uint32_t node) const { return parent_[node]; }
  /// Of a node's tree; 0 of row 0.
  std::uint32_t root(std::uint32_t node) const { return root_[node]; }
  /// Levels between a node and its root.
  std::uint32_t level(std::uint32_t node) const { return level_[node]; }
  std::size_t memory_bytes() const { return bytes_of(node_, unit_, parent_, root_, level_, large_); }

 private:
  std::vector<std::uint32_t> node_, unit_, parent_, root_, level_;
  std::vector<char> large_;  // by body row
};

/// Contacts or joints of one kind have ways of about one length, and do about the same work: `turns`, a contact of more
/// than one point; `idle`, one that will probably be left alone. 0 where neither body has a node.
std::uint16_t path_kind(const TreeNodes& nodes, std::uint32_t a, std::uint32_t b, bool turns, bool idle);

/// The lists `contact_paths` and `joint_paths` of tree_path.inl for the first `blocks` blocks of slots; how many slots
/// of `contact_reach` they have. `ends` as in Slots.
std::uint32_t pack_paths(const TreeNodes& nodes, std::uint32_t width, std::uint32_t blocks,
                         std::span<const std::uint32_t> ends, std::vector<std::uint32_t>& out);

}  // namespace pcphys
