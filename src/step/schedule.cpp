#include "step/schedule.h"

#include <algorithm>
#include <iterator>

#include "pcphys/constants.h"

namespace pcphys {

namespace {

/// By contact row.
template <class Scalar>
void foresee(const WorldState& state, std::span<const Standing> standings, std::vector<ContactWork>& works) {
  const std::uint32_t reals = schema(Buffer::contact).reals;
  const Scalar* contact = state.tables.data<Scalar>(Buffer::contact);
  works.resize(state.tables.rows(Table::contact));
  for (std::size_t row = 0; row < works.size(); row++) {
    const auto points = std::uint32_t(contact[3]);
    bool idle = true;
    for (std::uint32_t i = 0; i < points; i++) idle &= contact[20 + i] == 0 && contact[7 + 4 * i] > 0;
    const Standing c = standings.empty() ? Standing() : standings[row];
    works[row] = {points > 1, idle, std::uint16_t(points > 0 ? 0 : c.soon ? 1 : 2)};
    contact += reals;
  }
}

}  // namespace

void ColouredSlots::colour(const WorldState& state, std::span<const std::array<std::uint32_t, 2>> ends,
                           std::span<const Standing> standings, std::uint32_t kind, const TreeNodes& trees) {
  if (ends.size() > 1)
    state.tables.precision() == Precision::f32 ? foresee<float>(state, standings, works_)
                                               : foresee<double>(state, standings, works_);
  rows_.clear();
  for (std::uint32_t row = 1; row < ends.size(); row++)
    if (state.sleepers == 0 || !(state.asleep(ends[row][0]) || state.asleep(ends[row][1]))) rows_.push_back(row);
  colour_rows(state, ends, kind, trees, {});
}

void ColouredSlots::colour(const WorldState& state, std::span<const std::array<std::uint32_t, 2>> ends,
                           std::span<const std::uint32_t> rows, std::uint32_t kind, const TreeNodes& trees,
                           std::span<const char> alone) {
  works_.clear();
  rows_.assign(rows.begin(), rows.end());
  colour_rows(state, ends, kind, trees, alone);
}

void ColouredSlots::colour_rows(const WorldState& state, std::span<const std::array<std::uint32_t, 2>> ends,
                                std::uint32_t kind, const TreeNodes& trees, std::span<const char> alone) {
  trees_ = &trees;
  follow(state, trees);
  const bool some_trees = trees.rows() > 1;
  kinds_.clear();
  beside_trees_ = 0;
  units_.clear();
  priorities_.clear();
  ends_.clear();
  for (const std::uint32_t row : rows_) {
    std::uint32_t ids[2];
    for (int side = 0; side < 2; side++) {
      const Body& body = bodies_[ends[row][side]];
      ids[side] = body.id;
      units_.push_back(body.unit);
      ends_.push_back(ends[row][side]);
    }
    priorities_.push_back(priority(std::min(ids[0], ids[1]), std::max(ids[0], ids[1]), kind));
    const ContactWork work = works_.empty() ? ContactWork{} : works_[row];
    const bool within_trees = some_trees && (alone.empty() || !alone[row]);
    const std::uint16_t path =
        within_trees ? path_kind(trees, ends[row][0], ends[row][1], work.turns, work.idle) : std::uint16_t{0};
    kinds_.push_back(path > 0 ? path : work.later);
    if (!some_trees) continue;
    beside_trees_ += trees.is_large(ends[row][0]) || trees.is_large(ends[row][1]);
  }
  colouring_.build(std::uint32_t(state.bodies.size()), units_, priorities_, kinds_);
  side_by_side_ = 0;
  for (std::uint32_t c = 0; c < colouring_.colours(); c++)
    side_by_side_ = std::max(side_by_side_, std::uint32_t(colouring_.of_colour(c).size()));
  width_ = 0;
}

void ColouredSlots::follow(const WorldState& state, const TreeNodes& trees) {
  if (serial_ == state.serial && structure_ == state.structure_version && rest_ == state.rest_version) return;
  serial_ = state.serial;
  structure_ = state.structure_version;
  rest_ = state.rest_version;  // joints of what sleeps are in no tree
  bodies_.resize(state.bodies.size());
  for (std::uint32_t row = 0; row < bodies_.size(); row++)
    bodies_[row] = {state.bodies[row].index, state.responds(row) ? trees.unit(row) : Colouring::fixed_unit};
}

void ColouredSlots::group(OctaveOf of_bodies) {
  of_bodies_ = of_bodies;
  width_ = 0;
}

void ColouredSlots::pack(std::uint32_t width) {
  if (width_ == width) return;
  width_ = width;
  version_++;
  octaves_.clear();
  if (!of_bodies_.octaves.empty())  // an end that stands has none
    for (std::size_t i = 0; i < rows_.size(); i++)
      octaves_.push_back(std::max(of_bodies_.octaves[ends_[2 * i]], of_bodies_.octaves[ends_[2 * i + 1]]));
  pack_slots(colouring_, width, ends_, rows_, slots_, {octaves_, of_bodies_.count});
  if (any_with_trees())
    reach_blocks_ = pack_paths(*trees_, width, tree_ranges(of_bodies_.count - 1).back().end, slots_.ends, paths_);
}

namespace {

/// By tree: how many joints that close a loop have a body of it that moves.
std::vector<std::uint32_t> closings_of_trees(const Forest& forest, std::span<const std::uint32_t> closing,
                                             std::span<const JointLink> links, std::span<const double> masses) {
  std::vector<std::uint32_t> count(forest.trees(), 0), tree_of(masses.size(), 0);  // tree + 1
  for (std::size_t i = 0; i < forest.trees(); i++)
    for (const TreeNode& node : forest.tree(i))
      if (masses[node.body] > 0) tree_of[node.body] = std::uint32_t(i + 1);
  for (const std::uint32_t row : closing) {
    const JointLink& link = links[row - 1];  // a link of each row from 1 on
    const std::uint32_t a = tree_of[link.a], b = tree_of[link.b];
    if (a > 0) count[a - 1]++;
    if (b > 0 && b != a) count[b - 1]++;
  }
  return count;
}

}  // namespace

void TreeSlots::build(const WorldState& state, const Nets& nets) {
  solved_.build(state);
  std::vector<JointLink> links, joints;  // joints: without springs between two points, and those that others stand for
  for (std::uint32_t row = 1; row < state.joints.size(); row++) {
    const JointRecord& joint = state.joints[row];
    links.push_back(
        {row, state.body_ids.row(joint.body_a), state.body_ids.row(joint.body_b), joint.index, joint.def.yields()});
    if (!joint.spring && !solved_.stands_back(row) && !state.asleep(joint)) joints.push_back(links.back());
  }
  std::vector<double> masses(state.bodies.size());
  std::vector<std::uint32_t> ids(state.bodies.size());
  for (std::uint32_t row = 0; row < state.bodies.size(); row++) {
    masses[row] = state.responds(row) ? state.tables.get(Buffer::mass, row, 3) : 0;
    ids[row] = state.bodies[row].index;
  }
  forest_.build(joints, masses, ids);
  nodes_.build(forest_, masses);
  find_parallel(links);
  closing_.assign(forest_.closing().begin(), forest_.closing().end());
  for (std::uint32_t row = 1; row < state.joints.size(); row++) {
    const JointRecord& joint = state.joints[row];  // a spring without stiffness and damping does nothing
    if (joint.spring && joint.driven() && !state.asleep(joint) && !nets.holds(row)) closing_.push_back(row);
  }
  std::ranges::sort(closing_);
  pivots_ = find_pivots(forest_, state, solved_);
  for (const Pivot& pivot : pivots_) forest_.set_pivot(pivot.tree);
  bare_pivots_ = pivots_.size() == forest_.trees() && std::ranges::none_of(pivots_, &Pivot::limited);
  limits_ = false;
  for (std::uint32_t i = 0; i < forest_.trees() && !limits_; i++) limits_ = has_limits(state, forest_.tree(i));
  shapes_.build(forest_);
  alike_ = shapes_.most_alike();
  loop_nodes_.build(forest_, masses, closings_of_trees(forest_, closing_, links, masses));
  find_drives(state, links, nets);
  width_ = 0;
}

void TreeSlots::find_drives(const WorldState& state, std::span<const JointLink> links, const Nets& nets) {
  closing_drives_ = false;
  free_springs_ = 0;
  std::size_t driven = 0;
  for (std::uint32_t row = 1; row < state.joints.size(); row++)
    driven += state.joints[row].driven() && !state.asleep(state.joints[row]) && !nets.holds(row);
  for (const std::uint32_t row : closing_) {
    const JointRecord& joint = state.joints[row];
    if (!joint.driven()) continue;
    closing_drives_ = true;
    driven--;
    const JointLink& link = links[row - 1];
    free_springs_ += joint.spring && loop_nodes_.node(link.a) == 0 && loop_nodes_.node(link.b) == 0;
  }
  drives_ = driven > 0;
}

/// Few joints close loops, so each joint of a tree looks for itself among them.
void TreeSlots::find_parallel(std::span<const JointLink> links) {
  parallel_.assign(links.size() + 1, false);
  struct Closing {
    std::array<std::uint32_t, 2> bodies;
    std::uint32_t row;
  };
  const auto both = [](std::uint32_t a, std::uint32_t b) { return std::array{std::min(a, b), std::max(a, b)}; };
  std::vector<Closing> closing;
  for (const std::uint32_t row : forest_.closing()) closing.push_back({both(links[row - 1].a, links[row - 1].b), row});
  if (closing.empty()) return;
  std::ranges::sort(closing, {}, &Closing::bodies);
  for (std::size_t i = 0; i < forest_.trees(); i++) {
    const std::span<const TreeNode> tree = forest_.tree(i);
    for (const TreeNode& node : tree.subspan(1)) {
      const auto bodies = both(node.body, tree[node.parent].body);
      const auto first = std::ranges::lower_bound(closing, bodies, {}, &Closing::bodies);
      for (auto c = first; c != closing.end() && c->bodies == bodies; ++c) parallel_[c->row] = true;
    }
  }
}

void TreeSlots::group(OctaveOf of_bodies) {
  of_bodies_ = of_bodies;
  width_ = 0;
}

void TreeSlots::pack(std::uint32_t width) {
  if (width_ == width) return;
  width_ = width;
  version_++;
  octaves_.clear();
  if (!of_bodies_.octaves.empty())
    for (std::size_t i = 0; i < forest_.trees(); i++)
      octaves_.push_back(of_bodies_.octaves[forest_.tree(i).back().body]);
  pack_trees(forest_, shapes_, width, blocks_, {octaves_, of_bodies_.count});
}

void NetSlots::group(OctaveOf of_bodies) {
  of_bodies_ = of_bodies;
  width_ = 0;
}

void NetSlots::pack(std::uint32_t width) {
  if (width_ == width) return;
  width_ = width;
  version_++;
  octaves_.clear();
  if (!of_bodies_.octaves.empty())
    for (std::size_t i = 0; i < nets_.count(); i++) octaves_.push_back(of_bodies_.octaves[nets_.net(i).moving]);
  nets_.pack(width, {octaves_, of_bodies_.count}, blocks_);
}

void Schedule::update_structure(const WorldState& state) {
  rows_.clear();
  own.forget();
  drag = gyroscopic = rotates = false;
  double lightest = 0, heaviest = 0;  // as inverse masses
  for (std::uint32_t row = 1; row < state.bodies.size(); row++) {
    if (!state.goes(row)) continue;
    rows_.push_back(row);
    drag |= state.tables.get(Buffer::force, row, 3) > 0 || state.tables.get(Buffer::force, row, 7) > 0;
    const Vec3 inverse = state.tables.get3(Buffer::mass, row, 4);
    rotates |= inverse.x > 0;
    gyroscopic |= inverse.x != inverse.y || inverse.y != inverse.z;
    const double inverse_mass = state.tables.get(Buffer::motion, row, 3);
    if (inverse_mass <= 0) continue;
    lightest = std::max(lightest, inverse_mass);
    heaviest = heaviest > 0 ? std::min(heaviest, inverse_mass) : inverse_mass;
  }
  uneven = lightest > heaviest && heaviest > 0;
  moving = std::uint32_t(rows_.size());
  joint_ends_.assign(state.joints.size(), {0, 0});
  for (std::uint32_t row = 1; row < state.joints.size(); row++)
    joint_ends_[row] = {state.body_ids.row(state.joints[row].body_a), state.body_ids.row(state.joints[row].body_b)};
  nets.build(state);
  trees.build(state, nets.nets());
  joints.colour(state, joint_ends_, trees.closing(), 0, trees.loop_nodes(), trees.parallel());
  group({});
}

void Schedule::group(std::span<const std::uint8_t> octaves) {
  changes_++;
  own.forget_octaves();
  octaves_.assign(octaves.begin(), octaves.end());
  const OctaveOf of{octaves_, octaves.empty() ? 1u : 1u + *std::ranges::max_element(octaves)};
  bodies.clear();
  body_ranges_.clear();
  for (unsigned octave = 0; octave < of.count; octave++) {
    const auto begin = std::uint32_t(bodies.size());
    std::ranges::copy_if(rows_, std::back_inserter(bodies), [&](std::uint32_t row) { return of.is(row, octave); });
    body_ranges_.push_back({begin, std::uint32_t(bodies.size())});
    bodies.resize((bodies.size() + padding - 1) / padding * padding, 0);
  }
  bodies_version++;
  joints.group(of);
  contacts.group(of);
  trees.group(of);
  nets.group(of);
}

}  // namespace pcphys
