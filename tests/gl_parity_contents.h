// Random but plausible contents for everything a kernel binds, in logical order (rows, slots, nodes of trees).
#pragma once
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "gl_parity_trees.h"
#include "pcphys/constants.h"
#include "pcphys/math.h"
#include "plan/tree_paths.h"
#include "step/backend.h"
#include "world/schema.h"

namespace parity {
using namespace pcphys;

inline Table table_of(Buffer buffer) { return schema(buffer).table; }
inline bool is_index(Buffer buffer) { return schema(buffer).reals == 0; }
inline bool is_tree_rows(Buffer buffer) { return buffer == Buffer::tree_rows || buffer == Buffer::tree_drive_rows; }
inline bool is_rows(Buffer buffer) {
  return buffer == Buffer::contact_rows || buffer == Buffer::frictionless_rows || buffer == Buffer::contact_impulses ||
         buffer == Buffer::joint_rows || is_tree_rows(buffer) || buffer == Buffer::contact_reach;
}
inline bool is_ends(Buffer buffer) { return buffer == Buffer::contact_ends || buffer == Buffer::joint_ends; }

/// Values of one size: what a kind of scene puts into kernels. `distance` is from the origin.
struct Mood {
  const char* name;
  double speed, spin, distance, mass, impulse;
  double tree_spin;   // of bodies in trees
  bool loops = true;  // whether joints close loops among them
};
inline constexpr Mood moods[] = {
    {"plausible", 3, 2, 5, 1, 0.5, 2},
    {"many turns and far away", 50, 4000, 5000, 0.05, 1, 100},
    {"whirling trees", 50, 4000, 5, 0.05, 1, 4000, false},  // loops leave the range of numbers: a world freezes them
    {"small", 1e-6, 1e-7, 0.01, 1e-3, 1e-8, 1e-7},
    {"heavy", 20, 300, 50, 1e6, 1e5, 30},  // at 300 rad/s tree_again ends at 1e9 m/s, see analytic_tree_limits.cpp
};

template <class Scalar> struct State {
  std::array<std::vector<Scalar>, buffer_count> reals;
  std::array<std::vector<std::uint32_t>, buffer_count> indices;  // ends: a and b of slot 0, of slot 1, ...
  // biased of a step's first sub-step, relax, biased of others
  std::array<InfoOf<Scalar>, 3> infos;
  std::vector<Range> contact_colours, joint_colours;  // in slots
  std::uint32_t tree_colours = 0;                     // of contacts and joints with trees, which come first
  Forest trees;                                       // of joints of their own
  TreeNodes nodes;
};

template <class Scalar> class Maker {
 public:
  Maker(std::uint64_t seed, const Mood& mood) : random_(seed), mood_(mood) {}
  State<Scalar> make();

 private:
  // trees have bodies of their own: others are torn at by more than what would hold them together
  static constexpr std::uint32_t loose_bodies = 640, fixed_bodies = 6, kinematic_bodies = 6;
  const std::uint32_t free_bodies = loose_bodies + tree_bodies();
  const std::uint32_t body_count = 1 + free_bodies + fixed_bodies + kinematic_bodies;

  double real(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double either(double size) { return real(-size, size); }
  std::uint32_t below(std::uint32_t n) { return std::uint32_t(random_() % n); }
  bool rarely() { return below(8) == 0; }
  void put(Buffer buffer, std::uint32_t row, std::initializer_list<double> values) {
    Scalar* at = state_.reals[std::size_t(buffer)].data() + std::size_t(row) * schema(buffer).reals;
    for (const double value : values) *at++ = Scalar(value);
  }
  std::array<double, 4> turn(int components) {
    std::array<double, 4> q{};
    double sum = 0;
    for (int i = 0; i < components; i++) q[std::size_t(i)] = either(1), sum += q[std::size_t(i)] * q[std::size_t(i)];
    for (double& x : q) x = x / std::sqrt(sum);
    return q;
  }
  void body(std::uint32_t row);
  void contact(std::uint32_t row);
  void joint(std::uint32_t row);
  void drive(std::uint32_t row);
  void slots(Buffer ends, Buffer order, std::vector<Range>& colours, std::uint32_t colour_count, std::uint32_t blocks);
  void trees();
  void tree_slots(Buffer ends, Buffer order, std::vector<Range>& colours);
  void assemble(std::span<const TreeNode> tree);
  void infos();

  static constexpr std::uint32_t colour_count = 4, contact_blocks = 8, joint_blocks = 4;
  static constexpr std::uint32_t tree_colour_count = 2, tree_blocks = 2;
  static constexpr std::uint32_t coloured_joints = (colour_count * joint_blocks + tree_colour_count * tree_blocks) * 32;

  std::mt19937_64 random_;
  Mood mood_;
  State<Scalar> state_;
};

template <class Scalar> void Maker<Scalar>::body(std::uint32_t row) {
  const bool ground = row == 0, dynamic = row > 0 && row <= free_bodies, kinematic = row > free_bodies + fixed_bodies;
  const double speed = ground || !(dynamic || kinematic) || rarely() ? 0 : mood_.speed;
  const double mass = mood_.mass * real(0.1, 3);
  double moments[3] = {mass * real(0.01, 0.1), mass * real(0.1, 0.2), mass * real(0.2, 0.3)};
  if (rarely()) moments[1] = moments[2] = moments[0];
  const std::uint32_t middle = below(3);
  std::swap(moments[1], moments[middle]);
  const double spin =
      speed == 0 ? 0 : (dynamic && row > loose_bodies ? mood_.tree_spin : mood_.spin) * (dynamic ? moments[1] : 1);
  const double x = dynamic ? 1 : 0;
  put(Buffer::motion, row,
      {either(speed), either(speed), either(speed), dynamic ? 1 / mass : 0, either(spin), either(spin), either(spin),
       dynamic ? double(int(below(3)) - 1) : 0});
  const auto q = ground || rarely() ? std::array<double, 4>{0, 0, 0, 1} : turn(4);
  const double far = ground ? 0 : mood_.distance, near = ground ? 0 : 3,
               low = far * std::numeric_limits<Scalar>::epsilon() / 4,
               unit_low = ground ? 0 : std::numeric_limits<Scalar>::epsilon() / 4;
  put(Buffer::pose, row,
      {far + either(near), either(near), either(near) - far, 0, q[0], q[1], q[2], q[3], either(low), either(low),
       either(low), 0, either(unit_low), either(unit_low), either(unit_low), either(unit_low)});
  const double change = speed / 100, lost = speed * std::numeric_limits<Scalar>::epsilon() / 4;
  put(Buffer::velocity_parts, row,
      {either(change), either(change), either(change), 0, either(change), either(change), either(change), 0,  //
       either(lost), either(lost), either(lost), 0, either(lost), either(lost), either(lost), 0});
  put(Buffer::mass, row,
      {x * moments[0], x * moments[1], x * moments[2], x * mass, dynamic ? 1 / moments[0] : kinematic,
       dynamic ? 1 / moments[1] : kinematic, dynamic ? 1 / moments[2] : kinematic, double(middle)});
  const double drags[] = {0, 0.25, 5, 300};
  const double push = ground || rarely() ? 0 : mood_.mass * 10;
  put(Buffer::force, row,
      {either(push), either(push), either(push), drags[below(4)], either(push), either(push), either(push),
       drags[below(4)]});
  const double moved = ground ? 0 : speed / 1000;
  put(Buffer::inertia, row,
      {x / moments[0], x * either(0.1) / moments[2], x * either(0.1) / moments[2], x / moments[1],
       x * either(0.1) / moments[2], x / moments[2], x, 0});
  put(Buffer::delta, row,
      {either(moved), either(moved), either(moved), 0, either(moved), either(moved), either(moved), 0});
}

template <class Scalar> void Maker<Scalar>::contact(std::uint32_t row) {
  if (row == 0) return;
  const auto n = rarely() ? std::array<double, 4>{0, 1, 0, 0} : turn(3);
  put(Buffer::contact, row, {n[0], n[1], n[2], double(below(5))});
  for (std::uint32_t point = 0; point < 4; point++) {
    Scalar* at =
        state_.reals[std::size_t(Buffer::contact)].data() + row * schema(Buffer::contact).reals + 4 + point * 4;
    for (int i = 0; i < 3; i++) at[i] = Scalar(either(0.5));
    at[3] = Scalar(rarely() ? 0 : either(0.01));
  }
  Scalar* at = state_.reals[std::size_t(Buffer::contact)].data() + row * schema(Buffer::contact).reals + 20;
  const bool fresh = rarely();
  for (int i = 0; i < 4; i++) at[i] = Scalar(fresh ? 0 : real(0, mood_.impulse));
  for (int i = 4; i < 8; i++) at[i] = Scalar(fresh ? 0 : either(mood_.impulse / 4));
  at[8] = Scalar(rarely() ? 0 : real(0, 1.2));
  at[9] = Scalar(at[8] * Scalar(real(0.5, 1)));
  at[10] = Scalar(rarely() ? 0 : real(0.5, 1));
  // meets within the sub-step, rests, hangs on joints
  at[11] = Scalar(rarely() ? real(0, 1.0 / 240) : -double(below(2)));
  Scalar* const contact = state_.reals[std::size_t(Buffer::contact)].data() + row * schema(Buffer::contact).reals;
  for (int i = 0; i < 3; i++) contact[place::apart + i] = Scalar(either(1));  // from one body to the other
  contact[place::found_anew] = Scalar(rarely() ? 2 : below(2));  // its rows act no longer, stand, were found anew
  for (int i = 0; i < 4; i++) contact[place::from_point + i] = Scalar(below(5));  // which point each was
}

template <class Scalar> void Maker<Scalar>::joint(std::uint32_t row) {
  if (row == 0) {
    for (const Buffer b : {Buffer::joint_frame, Buffer::joint_solved})
      put(b, row, {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 1});
    put(Buffer::joint_drive, row, {0, 0, 0, 1});
    return;
  }
  drive(row);
  const auto p = turn(4), q = turn(4);
  // a world keeps free angles as 1e9: trees multiply slacks by 0 where a row does not act
  const double infinity = row > coloured_joints ? constants::free_angle : std::numeric_limits<double>::infinity();
  double lower[3], upper[3];
  for (int i = 0; i < 3; i++) {
    lower[i] = real(-2, 1);
    upper[i] = rarely() ? lower[i] : lower[i] + real(0, 2);
    if (rarely()) lower[i] = -infinity, upper[i] = infinity;
  }
  const std::initializer_list<double> frame = {either(0.5), either(0.5), either(0.5), double(below(3)),
                                               p[0],        p[1],        p[2],        p[3],
                                               either(0.5), either(0.5), either(0.5), 0,
                                               q[0],        q[1],        q[2],        q[3],
                                               lower[0],    lower[1],    lower[2],    0,
                                               upper[0],    upper[1],    upper[2],    0};
  for (const Buffer b : {Buffer::joint_frame, Buffer::joint_solved}) put(b, row, frame);
  const double push = rarely() ? 0 : mood_.impulse;
  const auto axes = turn(4);
  // principal moments about the pin, the middle one in the middle; a hinge has one alone
  const double light = 1 / mood_.mass;
  const bool hinge = rarely();
  put(Buffer::joint_pivot, row,
      {light * real(3, 5), hinge ? 0 : light * real(2, 3), hinge ? 0 : light * real(1, 2), 1, axes[0], axes[1], axes[2],
       axes[3], either(0.5), either(0.5), either(0.5), mood_.mass * real(0.1, 3)});
  put(Buffer::joint_impulse, row,
      {either(push), either(push), either(push), 0, either(push), either(push), either(push), 0});
}

/// Motors and springs, strong and weak, on every second joint; some coloured ones are springs between two points.
template <class Scalar> void Maker<Scalar>::drive(std::uint32_t row) {
  const std::uint32_t kind = below(2) == 0 ? 0 : row <= coloured_joints && below(3) == 0 ? 2 : 1;
  const auto rest = rarely() ? std::array<double, 4>{0, 0, 0, 1} : turn(4);
  const double strength = mood_.impulse * std::pow(10, either(4)),
               turning = kind == 1 && !rarely() ? 10 * mood_.impulse : 0;
  put(Buffer::joint_drive, row,
      {rest[0], rest[1], rest[2], rest[3], either(mood_.tree_spin), turning * real(0, 1), rarely() ? 0 : strength,
       rarely() ? 0 : strength * real(0, 0.1), double(kind), rarely() ? 0 : real(0, 1), 0, 0});
}

/// Colours: within one, no dynamic body stands in two slots. The last slots of each are padding.
template <class Scalar>
void Maker<Scalar>::slots(Buffer ends, Buffer order, std::vector<Range>& colours, std::uint32_t colour_count,
                          std::uint32_t blocks) {
  std::uint32_t record = 1;  // the next that no slot has yet
  for (const std::uint32_t used : state_.indices[std::size_t(order)]) record = std::max(record, used + 1);
  for (std::uint32_t c = 0; c < colour_count; c++) {
    std::vector<std::uint32_t> bodies(loose_bodies);
    for (std::uint32_t i = 0; i < loose_bodies; i++) bodies[i] = i + 1;
    std::shuffle(bodies.begin(), bodies.end(), random_);
    const std::uint32_t count = blocks * 32, begin = std::uint32_t(state_.indices[std::size_t(order)].size());
    for (std::uint32_t slot = 0; slot < count; slot++) {
      const bool padding = slot + 5 >= count;
      std::uint32_t a = bodies[2 * slot], b = bodies[2 * slot + 1];
      if (below(4) == 0) (below(2) ? a : b) = free_bodies + 1 + below(fixed_bodies + kinematic_bodies);
      if (mood_.distance < 10 && rarely()) a = 0;  // the ground stands at the origin
      for (const std::uint32_t end : {padding ? 0 : a, padding ? 0 : b})
        state_.indices[std::size_t(ends)].push_back(end);
      state_.indices[std::size_t(order)].push_back(padding ? 0 : record++);
    }
    colours.push_back({begin, begin + count});
  }
}

/// Contacts or joints with bodies of trees, in colours of their own before all others: within one, no tree and no free
/// body stands in two slots. Between two bodies of a tree, with something fixed, with a free body, between two trees.
template <class Scalar> void Maker<Scalar>::tree_slots(Buffer ends_of, Buffer order_of, std::vector<Range>& colours) {
  std::uint32_t record = 1;
  std::vector<std::uint32_t>&ends = state_.indices[std::size_t(ends_of)],
  &order = state_.indices[std::size_t(order_of)];
  for (std::uint32_t c = 0; c < tree_colour_count; c++) {
    std::vector<std::size_t> trees(state_.trees.trees());
    for (std::size_t i = 0; i < trees.size(); i++) trees[i] = i;
    std::shuffle(trees.begin(), trees.end(), random_);
    std::uint32_t loose = 1 + c * 64;
    const auto some_body = [&](std::size_t tree) {
      const auto nodes = state_.trees.tree(tree);
      const std::uint32_t body = nodes[below(std::uint32_t(nodes.size()))].body;
      return state_.nodes.node(body) ? body : nodes[1].body;
    };
    const std::uint32_t begin = std::uint32_t(order.size()), count = tree_blocks * 32;
    for (std::uint32_t slot = 0; slot < count; slot++) {
      const bool padding = trees.size() < 2 || slot + 5 >= count;
      std::uint32_t a = 0, b = 0;
      if (!padding) {
        const std::size_t tree = trees.back();
        trees.pop_back();
        a = some_body(tree);
        const std::uint32_t kind = below(4);
        if (kind == 0) b = some_body(tree);
        if (kind == 1 || b == a) b = free_bodies + 1 + below(fixed_bodies + kinematic_bodies);
        if (kind == 2) b = loose++;
        if (kind == 3) b = some_body(trees.back()), trees.pop_back();
      }
      ends.push_back(a);
      ends.push_back(b);
      order.push_back(padding ? 0 : record++);
    }
    colours.push_back({begin, begin + count});
  }
  state_.tree_colours = tree_colour_count;
}

/// Moves bodies to where their pins meet, nearly.
template <class Scalar> void Maker<Scalar>::assemble(std::span<const TreeNode> tree) {
  const auto row = [&](Buffer b, std::uint32_t i) { return state_.reals[std::size_t(b)].data() + i * schema(b).reals; };
  const auto pin = [&](std::uint32_t body, const Scalar* frame) {
    const Scalar *pose = row(Buffer::pose, body), *q = pose + 4;
    const pcphys::Vec3 arm = rotate(pcphys::Quat{double(q[0]), double(q[1]), double(q[2]), double(q[3])},
                                    {double(frame[0]), double(frame[1]), double(frame[2])});
    return pcphys::Vec3{double(pose[0]), double(pose[1]), double(pose[2])} + arm;
  };
  for (const TreeNode& node : tree.subspan(1)) {
    const Scalar *frame = row(Buffer::joint_frame, node.joint), *b = frame + 8;
    const pcphys::Vec3 gap =
        pin(tree[node.parent].body, node.flipped ? b : frame) - pin(node.body, node.flipped ? frame : b);
    Scalar* at = row(Buffer::pose, node.body);
    at[0] += Scalar(gap.x + either(0.02)), at[1] += Scalar(gap.y + either(0.02)), at[2] += Scalar(gap.z + either(0.02));
  }
}

/// Trees of joints that stand in no colour.
template <class Scalar> void Maker<Scalar>::trees() {
  std::vector<std::uint32_t> anchors, ids(body_count);
  for (std::uint32_t row = free_bodies + 1; row < body_count; row++) anchors.push_back(row);
  if (mood_.distance < 10) anchors.push_back(0);  // the ground stands at the origin
  std::vector<double> masses(body_count);
  for (std::uint32_t row = 0; row < body_count; row++) {
    ids[row] = row;
    masses[row] = double(state_.reals[std::size_t(Buffer::mass)][row * schema(Buffer::mass).reals + 3]);
  }
  state_.trees.build(tree_links(1 + coloured_joints, 1 + loose_bodies, anchors, random_), masses, ids);
  for (std::size_t tree = 0; tree < state_.trees.trees(); tree++)
    if (state_.trees.tree(tree).size() == 2 && masses[state_.trees.tree(tree)[0].body] == 0)
      state_.trees.set_pivot(tree);
  state_.nodes.build(state_.trees, masses);
  for (const Buffer buffer : {Buffer::node_operator, Buffer::node_response, Buffer::node_pending})
    state_.reals[std::size_t(buffer)].resize(state_.nodes.rows() * schema(buffer).reals);
  for (std::size_t tree = 0; tree < state_.trees.trees(); tree++) assemble(state_.trees.tree(tree));
  for (const Buffer buffer : {Buffer::tree_rows, Buffer::tree_drive_rows})
    state_.reals[std::size_t(buffer)].resize(lay_out(state_.trees, 1).size * schema(buffer).reals);
}

template <class Scalar> void Maker<Scalar>::infos() {
  for (int phase = 0; phase < 3; phase++) {
    const bool relax = phase == 1;
    const double h = 1.0 / 240;
    InfoOf<Scalar> info;
    info.begins = Scalar(phase == 0 ? 1 : 0);
    info.h = Scalar(h);
    info.inverse_h = Scalar(1 / h);
    info.gravity_x = Scalar(0.3);
    info.gravity_y = Scalar(-9.81);
    info.gravity_z = Scalar(0.1);
    info.h_change = Scalar(0.2);
    info.h_before = Scalar(h / 0.8);
    info.impulse_ratio = Scalar(0.8);
    info.soft_rate = Scalar(relax ? 0 : 48);
    info.soft_impulse_scale = Scalar(relax ? 0 : 0.1);
    info.contact_preload = Scalar(0.1);
    info.load_ahead = Scalar(relax ? 1 : 0);
    info.push_speed = Scalar(4);
    info.row_push_speed = Scalar(0.2);
    info.tree_push_speed = Scalar(0.1);
    info.soft_mass_scale = Scalar(relax ? 1 : 0.95);
    info.joint_push_speed = Scalar(8);
    info.loop_give = Scalar(1e-5);
    info.spin_floor = Scalar(6e-5);
    info.stale_share = Scalar(0.1);
    info.locked_interval = Scalar(1e-6);
    info.limit_stiffness = Scalar(20);
    info.lock_stiffness = Scalar(1e4);
    info.tree_damping = Scalar(0.25);
    info.restitution_threshold = Scalar(mood_.speed / 10);
    info.rounding = Scalar(1e-3);
    info.substeps = Scalar(3);
    info.largest_state = Scalar(1e4);   // some bodies are beyond it
    info.largest_momentum = Scalar(1);  // some contacts are
    state_.infos[std::size_t(phase)] = info;
  }
}

template <class Scalar> State<Scalar> Maker<Scalar>::make() {
  std::uint32_t rows[table_count] = {};
  rows[std::size_t(Table::body)] = body_count;
  rows[std::size_t(Table::joint)] = 1 + coloured_joints + tree_joints();
  rows[std::size_t(Table::contact)] = 1 + (colour_count * contact_blocks + tree_colour_count * tree_blocks) * 32;
  rows[std::size_t(Table::touch)] = rows[std::size_t(Table::contact)];
  for (std::size_t i = 0; i < buffer_count; i++) {
    const Buffer buffer = Buffer(i);
    if (is_tree_rows(buffer) || table_of(buffer) == Table::node) continue;  // as many as nodes, below
    if (buffer == Buffer::contact_reach) continue;                          // when the contacts' bodies are known
    const std::uint32_t slots =
        buffer == Buffer::joint_rows ? coloured_joints : rows[std::size_t(table_of(buffer))] - 1;
    if (!is_index(buffer))
      state_.reals[i].resize(std::size_t(is_rows(buffer) ? slots : rows[std::size_t(table_of(buffer))]) *
                             schema(buffer).reals);
  }
  for (std::uint32_t row = 0; row < rows[std::size_t(Table::body)]; row++) body(row);
  for (std::uint32_t row = 0; row < rows[std::size_t(Table::contact)]; row++) contact(row);
  for (std::uint32_t row = 0; row < rows[std::size_t(Table::joint)]; row++) joint(row);
  for (std::uint32_t row = 1; row < body_count; row++) state_.indices[std::size_t(Buffer::bodies)].push_back(row);
  while (state_.indices[std::size_t(Buffer::bodies)].size() % 32 != 0)
    state_.indices[std::size_t(Buffer::bodies)].push_back(0);
  trees();
  tree_slots(Buffer::contact_ends, Buffer::contact_order, state_.contact_colours);
  tree_slots(Buffer::joint_ends, Buffer::joint_order, state_.joint_colours);
  slots(Buffer::contact_ends, Buffer::contact_order, state_.contact_colours, colour_count, contact_blocks);
  slots(Buffer::joint_ends, Buffer::joint_order, state_.joint_colours, colour_count, joint_blocks);
  infos();
  return state_;
}

}  // namespace parity
