#include "world/invariants.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>
#include <vector>

#include "world/state.h"

namespace pcphys {
namespace {

/// Marks, kept from walk to walk: a warmed-up step allocates nothing, in debug builds either.
struct Marks {
  std::vector<std::uint8_t> of;
  std::vector<std::uint32_t> sorted;
  std::vector<std::uint64_t> pairs;
};
thread_local Marks marks;

/// Each part ends with the first thing that it finds, since what stands behind it may follow indices that are wrong.
class Walk {
 public:
  explicit Walk(const WorldState& state) : s_(state), t_(state.tables) {}

  std::string find() {
    using Part = void (Walk::*)();
    for (const Part part :
         {&Walk::walk_ids, &Walk::walk_rows, &Walk::walk_shapes, &Walk::walk_forces, &Walk::walk_joints,
          &Walk::walk_counts, &Walk::walk_frozen, &Walk::walk_joints_apart, &Walk::walk_asked_apart,
          &Walk::walk_contacts, &Walk::walk_rest, &Walk::walk_islands, &Walk::walk_numbers, &Walk::walk_own}) {
      (this->*part)();
      if (!broken_.empty()) break;
    }
    return std::move(broken_);
  }

 private:
  /// Whether it holds; the first that does not is what is said of number `at` of those objects.
  bool holds(bool so, std::string_view object, std::size_t at, const char* predicate) {
    if (!so && broken_.empty()) broken_ = std::string(object) + " " + std::to_string(at) + " " + predicate;
    return so;
  }
  /// The same of the whole world.
  bool holds(bool so, const char* sentence) {
    if (!so && broken_.empty()) broken_ = sentence;
    return so;
  }
  static std::vector<std::uint8_t>& unmarked(std::size_t count) {
    marks.of.assign(count, 0);
    return marks.of;
  }

  void walk_ids() {
    walk_ids(s_.body_ids, "body id");
    walk_ids(s_.joint_ids, "joint id");
    walk_ids(s_.force_ids, "force id");
  }
  void walk_ids(const IdPool& pool, const char* id) {
    std::vector<std::uint8_t>& is_free = unmarked(pool.size());
    for (const std::uint32_t i : pool.free_indices()) {
      if (!holds(i < pool.size(), id, i, "is free, and was never used")) return;
      if (!holds(is_free[i] == 0, id, i, "is free twice")) return;
      if (!holds(!pool.alive(i), id, i, "is free, and alive")) return;
      if (!holds(pool.generation(i) != IdPool::last_generation, id, i, "is free, and its generations are used up"))
        return;
      is_free[i] = 1;
    }
    std::uint32_t alive = 0;
    for (std::uint32_t i = 0; i < pool.size(); i++) {
      if (!holds(pool.generation(i) > 0, id, i, "has generation 0")) return;
      const bool used_up = pool.generation(i) == IdPool::last_generation;
      if (!holds(pool.alive(i) || is_free[i] || used_up, id, i, "is neither alive nor free")) return;
      alive += pool.alive(i);
    }
    holds(alive == pool.count(), id, alive, "is counted wrong: so many are alive");
    holds(std::ranges::is_heap(pool.free_indices(), std::greater<>()),
          "Free ids are not handed out from the smallest on");
  }

  void walk_rows() {
    walk_rows(s_.bodies, s_.body_ids, 0, Table::body, "body row");
    walk_rows(s_.joints, s_.joint_ids, 1, Table::joint, "joint row");
    holds(t_.rows(Table::shape) == s_.shapes.size() + 1, "The table of shapes has other rows than there are shapes");
    holds(s_.forces.size() == s_.force_ids.size(), "There are other forces than ids of forces");
    holds(t_.are_long_enough(), "A buffer is not as long as the rows of its table");
  }
  /// Rows from `first` on are of one living id each, and each living id is of one row.
  template <class Record>
  void walk_rows(const std::vector<Record>& records, const IdPool& pool, std::uint32_t first, Table table,
                 const char* row_of) {
    for (std::uint32_t row = first; row < records.size(); row++) {
      const std::uint32_t index = records[row].index;
      if (!holds(index < pool.size() && pool.alive(index), row_of, row, "is of an id that is not alive")) return;
      if (!holds(pool.row(index) == row, row_of, row, "is of an id that names another row")) return;
    }
    holds(records.size() == pool.count() + first, row_of, records.size(),
          "would be the next, and another number of ids is alive");
    holds(t_.rows(table) == records.size(), row_of, records.size(),
          "would be the next, and the table has another number");
  }

  bool is_body(std::uint32_t index) const { return index < s_.body_ids.size() && s_.body_ids.alive(index); }

  void walk_shapes() {
    constexpr std::uint8_t free = 1, listed = 2;
    std::vector<std::uint8_t>& seen = unmarked(s_.shapes.size());
    for (const std::uint32_t shape : s_.free_shapes) {
      if (!holds(shape < seen.size() && !seen[shape], "shape", shape, "is free twice, or was never used")) return;
      seen[shape] = free;
    }
    for (std::uint32_t row = 0; row < s_.bodies.size(); row++)
      for (const std::uint32_t shape : s_.bodies[row].shapes) {
        if (!holds(shape < seen.size() && !seen[shape], "shape", shape, "is in two lists of bodies, or free")) return;
        if (!holds(s_.shapes[shape].body == s_.bodies[row].index, "shape", shape,
                   "is in the list of a body that is not its own"))
          return;
        seen[shape] = listed;
      }
    for (std::uint32_t shape = 0; shape < seen.size(); shape++) {
      const ShapeRecord& record = s_.shapes[shape];
      if (!holds(seen[shape] == (record.alive ? listed : free), "shape", shape,
                 "is alive and in no list, or gone and not free"))
        return;
      if (!holds(record.alive || !record.def.convex, "shape", shape, "is gone, and holds a hull")) return;
    }
  }

  void walk_forces() {
    std::uint32_t listed = 0;
    for (const BodyRecord& body : s_.bodies) {
      for (std::size_t i = 0; i < body.forces.size(); i++) {
        const std::uint32_t force = body.forces[i];
        const bool alive = force < s_.force_ids.size() && s_.force_ids.alive(force);
        if (!holds(alive && s_.forces[force].body == body.index, "force", force,
                   "is in the list of a body that is not its own"))
          return;
        if (!holds(i == 0 || body.forces[i - 1] < force, "force", force, "is in its body's list before a smaller one"))
          return;
      }
      listed += std::uint32_t(body.forces.size());
    }
    holds(listed == s_.force_ids.count(), "A force is in no body's list");
  }

  void walk_joints() {
    constexpr std::uint8_t by_a = 1, by_b = 2;
    for (std::uint32_t row = 1; row < s_.joints.size(); row++) {
      const JointRecord& joint = s_.joints[row];
      const bool both = is_body(joint.body_a) && is_body(joint.body_b) && joint.body_a != joint.body_b;
      if (!holds(both, "joint row", row, "is not between two bodies")) return;
      const auto is_dynamic = [&](std::uint32_t body) {
        return s_.bodies[s_.body_ids.row(body)].kind == BodyKind::dynamic;
      };
      if (!holds(is_dynamic(joint.body_a) || is_dynamic(joint.body_b), "joint row", row,
                 "is between bodies that never move"))
        return;
    }
    std::vector<std::uint8_t>& seen = unmarked(s_.joints.size());
    for (const BodyRecord& body : s_.bodies)
      for (const std::uint32_t index : body.joints) {
        if (!holds(index < s_.joint_ids.size() && s_.joint_ids.alive(index), "joint id", index,
                   "is gone, and in a body's list"))
          return;
        const std::uint32_t row = s_.joint_ids.row(index);
        const JointRecord& joint = s_.joints[row];
        const std::uint8_t by = joint.body_a == body.index ? by_a : joint.body_b == body.index ? by_b : 0;
        if (!holds(by && !(seen[row] & by), "joint row", row, "is twice in a body's list, or in that of another"))
          return;
        seen[row] |= by;
      }
    for (std::uint32_t row = 1; row < s_.joints.size(); row++)
      if (!holds(seen[row] == (by_a | by_b), "joint row", row, "is not in the lists of both its bodies")) return;
  }

  void walk_counts() {
    const auto is_kinematic = [](const BodyRecord& body) { return body.kind == BodyKind::kinematic; };
    const auto is_spring = [](const JointRecord& joint) { return joint.spring.has_value(); };
    const auto calls = [](const ForceRecord& force) { return bool(force.callback); };
    holds(std::ranges::count_if(s_.bodies, is_kinematic) == s_.kinematic, "Kinematic bodies are counted wrong");
    holds(std::ranges::count_if(s_.joints, is_spring) == s_.springs, "Springs are counted wrong");
    holds(std::ranges::count_if(s_.forces, calls) == s_.callbacks, "Callbacks are counted wrong");
    holds(s_.joint_changes <= s_.structure_version, "Joints changed more often than all objects");
  }

  /// Whether its rows are here, and there are any.
  bool is_here(Buffer buffer) const { return t_.rows(t_.table_of(buffer)) > 1 && !t_.keeper(buffer); }

  void walk_frozen() {
    const bool marked = is_here(Buffer::motion);
    std::size_t count = 0;
    for (std::uint32_t row = 0; row < s_.bodies.size(); row++) {
      const BodyRecord& body = s_.bodies[row];
      if (!holds(s_.frozen.contains(body.index) == body.frozen, "body row", row,
                 "is frozen, and its mass is lost, or kept for nothing"))
        return;
      if (!holds(!body.frozen || body.kind != BodyKind::fixed, "body row", row, "is frozen, and fixed")) return;
      const bool mark = marked && t_.get(Buffer::motion, row, place::phase) == frozen_phase;
      if (!holds(!marked || mark == body.frozen, "body row", row,
                 "is frozen, and its phase does not say so, or says so for nothing"))
        return;
      count += body.frozen;
    }
    holds(s_.frozen.size() == count, "A mass is kept of a body that is gone");
  }

  /// Pairs that joints keep apart are counted by their joints.
  void walk_joints_apart() {
    marks.pairs.clear();
    for (std::uint32_t row = 1; row < s_.joints.size(); row++) {
      const JointRecord& joint = s_.joints[row];
      if (!joint.def.collide) marks.pairs.push_back(WorldState::pair_key(joint.body_a, joint.body_b));
    }
    std::ranges::sort(marks.pairs);
    std::size_t counted = 0;
    for (const auto& [pair, why] : s_.no_collide) {
      const std::uint32_t low = std::uint32_t(pair >> 32), high = std::uint32_t(pair);
      if (!holds(low <= high && is_body(low) && is_body(high), "body id", high,
                 "is kept apart from another, and one of them is gone"))
        return;
      if (!holds(why.any(), "body id", high, "is kept apart from another for no reason")) return;
      const auto first = std::ranges::lower_bound(marks.pairs, pair),
                 last = std::ranges::upper_bound(marks.pairs, pair);
      if (!holds(std::size_t(last - first) == why.joints, "body id", high,
                 "is kept apart from another by more or fewer joints than there are"))
        return;
      counted += why.joints;
    }
    holds(counted == marks.pairs.size(), "A joint does not keep its bodies apart");
  }

  void walk_asked_apart() {
    std::size_t listed = 0, asked = 0;
    for (const auto& [body, others] : s_.asked_apart) {
      if (!holds(is_body(body) && !others.empty(), "body id", body,
                 "is gone or asked apart from nobody, and has a list of them"))
        return;
      marks.sorted.assign(others.begin(), others.end());
      std::ranges::sort(marks.sorted);
      for (std::size_t i = 0; i < marks.sorted.size(); i++) {
        const std::uint32_t other = marks.sorted[i];
        const auto pair = s_.no_collide.find(WorldState::pair_key(body, other));
        if (!holds(pair != s_.no_collide.end() && pair->second.asked, "body id", body,
                   "is listed apart from one that it may touch"))
          return;
        if (!holds(other == body || i == 0 || marks.sorted[i - 1] != other, "body id", body,
                   "is listed apart from one twice"))
          return;
      }
      listed += others.size();
    }
    for (const auto& [pair, why] : s_.no_collide) asked += why.asked;
    holds(listed == 2 * asked, "Two bodies that were asked apart are not in the lists of both");
  }

  /// Contacts of bodies that were destroyed are there until somebody looks; their rows are those of before.
  void walk_contacts() {
    const std::uint32_t rows = s_.contact_rows();
    const auto& [keys, ends, features] = s_.contacts;
    if (!holds(keys.size() == rows && ends.size() == rows && features.size() == rows,
               "Contacts have columns of other lengths"))
      return;
    if (!holds(!s_.drops.any() || rows > 1, "Contacts are to be dropped, and there are none") || s_.drops.any()) return;
    const bool points = is_here(Buffer::contact);
    for (std::uint32_t row = 1; row < rows; row++) {
      const auto& [low, high] = keys[row];
      const bool shapes = low < high && high < s_.shapes.size() && s_.shapes[low].alive && s_.shapes[high].alive;
      if (!holds(shapes, "contact row", row, "is not between two shapes, the lower first")) return;
      if (!holds(row == 1 || keys[row - 1] < keys[row], "contact row", row,
                 "stands before one of lower shapes, or twice"))
        return;
      const std::uint32_t a = s_.body_ids.row(s_.shapes[low].body), b = s_.body_ids.row(s_.shapes[high].body);
      const bool same_ends = (ends[row][0] == a && ends[row][1] == b) || (ends[row][0] == b && ends[row][1] == a);
      if (!holds(same_ends && a != b, "contact row", row, "names other bodies than those of its shapes")) return;
      const double count = points ? t_.get(Buffer::contact, row, place::point_count) : 0;
      if (!holds(count == 0 || count == 1 || count == 2 || count == 3 || count == 4, "contact row", row,
                 "has no number of points"))
        return;
    }
  }

  /// Impulses of joints may pass what numbers hold, where masses near the largest hang on them: the next step freezes
  /// what they act on.
  void walk_numbers() {
    for (std::size_t k = 0; k < table_buffer_count; k++) {
      const Buffer buffer = Buffer(k);
      if (!pcphys::holds(buffer, Role::state) || t_.table_of(buffer) == Table::joint || !is_here(buffer)) continue;
      t_.precision() == Precision::f32 ? walk_numbers<float>(buffer) : walk_numbers<double>(buffer);
    }
  }
  template <class Scalar> void walk_numbers(Buffer buffer) {
    const std::size_t reals = t_.row_bytes(buffer) / sizeof(Scalar), all = t_.rows(t_.table_of(buffer)) * reals;
    const Scalar* const first = t_.data<Scalar>(buffer);
    const Scalar* const bad = std::find_if_not(first, first + all, [](Scalar x) { return std::isfinite(x); });
    holds(bad == first + all, schema(buffer).name, std::size_t(bad - first) / reals,
          "holds a number that is not finite");
  }

  double rest(std::uint32_t row, RestField field) const { return t_.get(Buffer::rest, row, field); }

  void walk_rest() {
    if (!is_here(Buffer::rest)) return;
    const bool moves = is_here(Buffer::motion) && is_here(Buffer::velocity_parts);
    std::uint32_t sleepers = 0, stirred = 0;
    for (std::uint32_t row = 0; row < s_.bodies.size(); row++) {
      const bool sleeps = rest(row, rest_asleep) > 0, stirs = rest(row, rest_stirred) > 0;
      if (!holds(s_.rests || s_.never_rested(row), "body row", row, "has rested, and the world says that none has"))
        return;
      if (!holds(!sleeps || !s_.stands(row), "body row", row, "sleeps, and stands")) return;
      const bool still =
          !moves || (t_.get3(Buffer::motion, row, 0) == Vec3{} && t_.get3(Buffer::motion, row, 4) == Vec3{} &&
                     t_.get3(Buffer::velocity_parts, row, 0) == Vec3{});
      if (!holds(!sleeps || stirs || still, "body row", row, "sleeps, and moves")) return;
      sleepers += sleeps;
      stirred += stirs;
    }
    holds(sleepers == s_.sleepers, "Bodies that sleep are counted wrong");
    holds(stirred == s_.stirred, "Bodies that are stirred are counted wrong");
  }

  /// What acts on what sleeps sleeps too, unless one of both was stirred: the next step wakes it.
  void walk_islands() {
    if (s_.sleepers == 0 || !is_here(Buffer::rest)) return;
    const auto of = [&](std::uint32_t row) {
      return rest_of(s_.stands(row), rest(row, rest_stirred) > 0, s_.asleep(row));
    };
    const auto is_closed = [&](std::uint32_t a, std::uint32_t b) { return rest_together(of(a), of(b)); };
    for (std::uint32_t row = 1; row < s_.joints.size(); row++) {
      const JointRecord& joint = s_.joints[row];
      if (!holds(is_closed(s_.body_ids.row(joint.body_a), s_.body_ids.row(joint.body_b)), "joint row", row,
                 "is between one that sleeps and one that does not"))
        return;
    }
    for (std::uint32_t row = 1; row < s_.contact_rows() && !s_.drops.any(); row++)
      if (!holds(is_closed(s_.contacts.ends[row][0], s_.contacts.ends[row][1]), "contact row", row,
                 "is between one that sleeps and one that does not"))
        return;
  }

  void walk_own() {
    for (std::size_t k = 0; k < s_.own.tables.size(); k++) {
      const OwnTable& table = s_.own.tables[k];
      if (table.used && !holds(t_.rows(table.table) > 0 && table.generation > 0, "table", k,
                               "of the host's own has no row, or generation 0"))
        return;
    }
    for (std::size_t k = 0; k < s_.own.list.size(); k++) {
      const OwnProperty& property = s_.own.list[k];
      if (!property.used) continue;
      if (!holds(t_.table_of(property.buffer) == property.table && t_.rows(property.table) > 0, "property", k,
                 "of the host's own has a buffer of another table"))
        return;
      if (!holds(t_.row_bytes(property.buffer) == own_row_bytes(property.type, t_.real_bytes()), "property", k,
                 "of the host's own has rows of another length"))
        return;
      const auto is_same = [&](const OwnProperty& other) { return other.used && other.name == property.name; };
      if (!holds(std::ranges::count_if(s_.own.list, is_same) == 1, "property", k,
                 "of the host's own has the name of another"))
        return;
    }
  }

  const WorldState& s_;
  const Tables& t_;
  std::string broken_;
};

}  // namespace

std::string broken_invariant(WorldState& state) {
  std::string broken = Walk(state).find();
  if (!broken.empty()) return broken;
  const char* const uncounted = find_uncounted(state);
  return uncounted ? uncounted : broken;
}

}  // namespace pcphys
