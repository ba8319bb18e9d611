// Who goes when: the list of bodies that move, and the colours of joints and contacts as slots of a backend.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "collision/standing.h"
#include "pcphys/step.h"
#include "plan/coloring.h"
#include "plan/forest.h"
#include "plan/nets.h"
#include "plan/pivots.h"
#include "plan/tree_paths.h"
#include "step/backend.h"
#include "step/island_lists.h"
#include "step/own_lists.h"
#include "world/memory.h"
#include "world/state.h"

namespace pcphys {

/// What a contact's work will be like. It orders contacts within a colour, and changes no result.
struct ContactWork {
  bool turns = false, idle = false;  // see path_kind
  // of one in no tree: 1 where its shapes will come together, 2 where they are apart for good
  std::uint16_t later = 0;
};

/// Constraints of one domain, grouped into colours: two of one colour share no body that moves.
class ColouredSlots {
 public:
  /// `ends`: two body rows by table row (row 0 pads). `kind` makes priorities of joints and contacts differ. Of all
  /// rows but 0, or of those in `rows`.
  /// Constraints with bodies of `trees` come first, and whole trees are what answers them;
  /// but not those that are set in `alone`.
  void colour(const WorldState& state, std::span<const std::array<std::uint32_t, 2>> ends,
              std::span<const Standing> standings, std::uint32_t kind, const TreeNodes& trees);
  void colour(const WorldState& state, std::span<const std::array<std::uint32_t, 2>> ends,
              std::span<const std::uint32_t> rows, std::uint32_t kind, const TreeNodes& trees,
              std::span<const char> alone);
  /// Which octave each body is of, by row; the span lasts until the next call.
  void group(OctaveOf of_bodies);
  /// Lays the colours out for a backend of `width` lanes; nothing to do if they stand so already.
  void pack(std::uint32_t width);

  /// Slots side by side, as they were laid out last.
  std::uint32_t width() const { return width_; }
  /// How many the largest colour has.
  std::uint32_t side_by_side() const { return side_by_side_; }
  std::uint32_t colours() const { return colouring_.colours(); }
  std::uint32_t constraints() const { return colouring_.constraints(); }
  std::size_t slots() const { return slots_.order.size(); }
  std::span<const Range> ranges(unsigned octave) const {
    return std::span(slots_.ranges).subspan(std::size_t{octave} * colours(), colours());
  }
  /// Those of constraints with a body of a tree, and the others.
  std::span<const Range> tree_ranges(unsigned octave) const {
    return ranges(octave).first(colouring_.leading_colours());
  }
  std::span<const Range> free_ranges(unsigned octave) const {
    return ranges(octave).subspan(colouring_.leading_colours());
  }
  /// How many of them have a body of a tree.
  std::uint32_t with_trees() const { return colouring_.offsets()[colouring_.leading_colours()]; }
  bool any_with_trees() const { return colouring_.leading_colours() > 0; }
  bool any_without_trees() const { return colouring_.leading_colours() < colouring_.colours(); }
  /// Constraints with a body of a tree that is too large for them to be solved in it.
  std::uint32_t beside_trees() const { return beside_trees_; }
  std::vector<std::uint32_t>& paths() { return paths_; }
  /// Of contact_reach.
  std::size_t reach_slots() const { return std::size_t{reach_blocks_} * width_; }
  std::vector<std::uint32_t>& ends() { return slots_.ends; }
  std::vector<std::uint32_t>& order() { return slots_.order; }
  const std::vector<std::uint32_t>& order() const { return slots_.order; }
  /// Counts the changes of `ends` and `order`.
  std::uint64_t version() const { return version_; }
  std::size_t memory_bytes() const {
    return bytes_of(colouring_, slots_, bodies_, units_, priorities_, ends_, rows_, paths_, kinds_, works_, octaves_);
  }

 private:
  Colouring colouring_;
  Slots slots_;
  void colour_rows(const WorldState& state, std::span<const std::array<std::uint32_t, 2>> ends, std::uint32_t kind,
                   const TreeNodes& trees, std::span<const char> alone);

  struct Body {
    std::uint32_t id, unit;
  };
  /// What is read of bodies, when the world's objects have changed.
  void follow(const WorldState& state, const TreeNodes& trees);

  std::vector<Body> bodies_;                             // by row
  std::uint64_t serial_ = 0, structure_ = 0, rest_ = 0;  // of the world that they are of
  std::vector<std::uint32_t> units_, priorities_, ends_, rows_, paths_;
  std::vector<std::uint16_t> kinds_;
  std::vector<ContactWork> works_;  // by row, of contacts
  const TreeNodes* trees_ = nullptr;
  OctaveOf of_bodies_;
  std::vector<std::uint8_t> octaves_;  // of the constraints, where there are several
  std::uint32_t beside_trees_ = 0, reach_blocks_ = 0, side_by_side_ = 0;
  std::uint32_t width_ = 0;
  std::uint64_t version_ = 0;
};

/// Joint trees, one a lane, for a backend's width.
class TreeSlots {
 public:
  void build(const WorldState& state, const Nets& nets);
  /// As ColouredSlots::group.
  void group(OctaveOf of_bodies);
  void pack(std::uint32_t width);

  const SolvedJoints& solved() const { return solved_; }
  const Forest& forest() const { return forest_; }
  /// As contacts see them, and as joints that close loops do.
  const TreeNodes& nodes() const { return nodes_; }
  const TreeNodes& loop_nodes() const { return loop_nodes_; }
  std::span<const Pivot> pivots() const { return pivots_; }
  /// Whether every tree is one, and what turns there has no limits: the pins have nothing to solve.
  bool bare_pivots() const { return bare_pivots_; }
  /// By joint row: whether it joins two bodies that a tree's joint joins already. What the tree leaves it to answer is
  /// singular: such joints stay rows.
  std::span<const char> parallel() const { return parallel_; }
  /// Rows of the joints that stand in no tree, and of springs between two points that pull or damp; ascending.
  std::span<const std::uint32_t> closing() const { return closing_; }
  /// Whether some joint has a motor or a spring: of those in trees, and of the others.
  bool drives() const { return drives_; }
  /// Whether some joint of a tree has angles that have limits.
  bool limits() const { return limits_; }
  bool closing_drives() const { return closing_drives_; }
  /// Springs between two points of which neither stands in a tree that answers them.
  std::uint32_t free_springs() const { return free_springs_; }
  std::size_t slots() const { return blocks_.parents.size() * width_; }  // one a node and lane
  /// How many trees of one shape there are, of the shape of which there are most.
  std::uint32_t side_by_side() const { return alike_; }
  std::span<const Range> ranges(unsigned octave) const { return std::span(blocks_.ranges).subspan(octave, 1); }
  TreeBlocks& lists() { return blocks_; }
  std::uint64_t version() const { return version_; }
  std::size_t memory_bytes() const {
    return bytes_of(solved_, forest_, nodes_, loop_nodes_, parallel_, closing_, pivots_, shapes_, blocks_, octaves_);
  }

 private:
  SolvedJoints solved_;
  Forest forest_;
  void find_parallel(std::span<const JointLink> links);
  void find_drives(const WorldState& state, std::span<const JointLink> links, const Nets& nets);

  TreeNodes nodes_, loop_nodes_;
  std::vector<char> parallel_;
  std::vector<std::uint32_t> closing_;
  bool drives_ = false, closing_drives_ = false, bare_pivots_ = false, limits_ = false;
  std::uint32_t free_springs_ = 0, alike_ = 0;
  std::vector<Pivot> pivots_;
  TreeShapes shapes_;
  TreeBlocks blocks_;
  OctaveOf of_bodies_;
  std::vector<std::uint8_t> octaves_;  // of the trees, where there are several
  std::uint32_t width_ = 0;
  std::uint64_t version_ = 0;
};

/// Nets of springs, one a lane.
class NetSlots {
 public:
  void build(const WorldState& state) {
    nets_.build(state);
    width_ = 0;
  }
  /// As ColouredSlots::group.
  void group(OctaveOf of_bodies);
  void pack(std::uint32_t width);

  const Nets& nets() const { return nets_; }
  std::uint32_t side_by_side() const { return nets_.most_alike(); }
  std::size_t slots() const { return std::size_t{blocks_.slots} * width_; }
  std::span<const Range> ranges(unsigned octave) const { return std::span(blocks_.ranges).subspan(octave, 1); }
  std::vector<std::uint32_t>& list() { return blocks_.list; }
  std::uint64_t version() const { return version_; }
  std::size_t memory_bytes() const { return bytes_of(nets_, blocks_, octaves_); }

 private:
  Nets nets_;
  NetBlocks blocks_;
  OctaveOf of_bodies_;
  std::vector<std::uint8_t> octaves_;  // of the nets, where there are several
  std::uint32_t width_ = 0;
  std::uint64_t version_ = 0;
};

class Schedule {
 public:
  /// Follows a change of the world's objects.
  void update_structure(const WorldState& state);
  void update_contacts(const WorldState& state, std::span<const Standing> standings = {}) {
    changes_++;
    contacts.colour(state, state.contacts.ends, standings, 1, trees.nodes());
  }
  /// Sorts everything that moves by octave; `octaves` by body row, empty: all of octave 0. After each update_structure.
  void group(std::span<const std::uint8_t> octaves);
  /// Places in `bodies`.
  std::span<const Range> ranges(unsigned octave) const { return std::span(body_ranges_).subspan(octave, 1); }
  bool grouped() const { return body_ranges_.size() > 1; }
  OctaveOf octave_of() const { return {octaves_, std::uint32_t(body_ranges_.size())}; }
  /// Counts the changes of all that stands here, but for how it is packed.
  std::uint64_t changes() const { return changes_ + own.version + own.near.version + islands.version(); }
  std::span<const std::uint32_t> rows_that_move() const { return rows_; }

  std::vector<std::uint32_t> bodies;  // rows that move; those of an octave padded with row 0 to a multiple of `padding`
  std::uint32_t moving = 0;           // without the padding
  std::span<const std::uint32_t> moving_bodies() const { return std::span(bodies).first(body_ranges_.back().end); }
  bool drag = false, gyroscopic = false;  // some body that moves has drag, or unequal moments
  bool rotates = false;                   // some body that moves rotates
  bool uneven = false;                    // masses differ
  std::uint64_t bodies_version = 0;
  ColouredSlots joints, contacts;  // joints: those that stand in no tree
  TreeSlots trees;
  NetSlots nets;
  OwnLists own;         // of kernels of the host's own
  IslandLists islands;  // of a device that finds them

  static constexpr std::uint32_t padding = 32;  // the widest backend
  std::size_t memory_bytes() const {
    return bytes_of(bodies, joints, contacts, trees, nets, own, islands, joint_ends_, rows_, octaves_, body_ranges_);
  }

 private:
  std::vector<std::array<std::uint32_t, 2>> joint_ends_;
  std::vector<std::uint32_t> rows_;  // those that move
  std::vector<std::uint8_t> octaves_;
  std::vector<Range> body_ranges_;
  std::uint64_t changes_ = 0;
};

}  // namespace pcphys
