// The inside of a world: tables, ids, and the host-side columns that no kernel reads.
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "pcphys/world.h"
#include "world/contact_drops.h"
#include "world/id_pool.h"
#include "world/own_properties.h"
#include "world/seen_changes.h"
#include "world/tables.h"

namespace pcphys {

/// Host columns of a body row.
struct BodyRecord {
  std::uint32_t index = 0;  // of its id
  BodyKind kind = BodyKind::fixed;
  bool frozen = false;                // see World::frozen; its mass waits in WorldState::frozen
  std::vector<std::uint32_t> shapes;  // shape indices
  std::vector<std::uint32_t> forces;  // force indices, ascending: sums are taken in this order
  std::vector<std::uint32_t> joints;  // id indices of joints and springs

  std::size_t memory_bytes() const { return bytes_of(shapes, forces, joints); }
};
struct JointRecord {
  std::uint32_t index = 0;
  std::uint32_t body_a = 0, body_b = 0;  // id indices
  JointDef def;                          // of a spring: bodies and anchors
  std::optional<SpringDef> spring;       // between two points, in place of a joint
  /// Whether it has a motor or a spring, or is one that pulls or damps.
  bool driven() const {
    const auto acts = [](double x) { return normal<double>(x) > 0; };
    if (spring) return acts(spring->stiffness) || acts(spring->damping);
    return acts(def.motor.torque) || acts(def.spring.stiffness) || acts(def.spring.damping);
  }
};
/// Host columns of a shape; the shape table's row is index + 1 (row 0 pads).
struct ShapeRecord {
  std::uint32_t body = 0;  // id index
  Filter filter;
  ShapeDef def;
  bool alive = false;
};
struct ForceRecord {
  std::uint32_t body = 0;  // id index
  Wrench wrench;
  ForceCallback callback;
};

/// Which shapes a contact row is between (shape_a < shape_b), the body rows, and its points' features.
/// In ascending order of the key; `ends` follows the contact's normal, which points from a to b.
struct ContactKey {
  std::uint32_t shape_a = 0, shape_b = 0;
  friend auto operator<=>(const ContactKey&, const ContactKey&) = default;
};
struct ContactColumns {
  std::vector<ContactKey> keys;                    // by row; row 0 pads
  std::vector<std::array<std::uint32_t, 2>> ends;  // body rows
  std::vector<std::array<std::uint32_t, 4>> features;

  std::size_t memory_bytes() const { return bytes_of(keys, ends, features); }
};

/// Why two bodies never touch, besides filters.
struct NoCollide {
  std::uint32_t joints = 0;  // between them, that forbid it
  bool asked = false;        // by set_collide
  bool any() const { return joints > 0 || asked; }
};

/// What a joint holds, into joint_frame or joint_solved.
void write_frames(Tables& tables, Buffer buffer, std::uint32_t row, const JointDef& def);

void write_material(Tables& tables, std::uint32_t row, const Material& material);

/// Of three moments neither the smallest nor the largest; of equal ones any.
int middle_axis(Vec3 moments);

inline constexpr double frozen_phase = -2;  // of a frozen body: what snapshots and hashes know it by
/// Where its properties stand in a row of Buffer::rest.
enum RestField : std::uint32_t { rest_quiet_time, rest_asleep, rest_stirred, rest_can_sleep, rest_fields };
/// Whether a body sleeps, as far as what acts on it must do the same: not if it stands,
/// nor if the next step wakes both.
enum class Rest : std::uint8_t { awake, asleep, any };
inline Rest rest_of(bool stands, bool stirred, bool asleep) {
  return stands || stirred ? Rest::any : asleep ? Rest::asleep : Rest::awake;
}
/// Whether bodies of these may act on each other.
inline bool rest_together(Rest a, Rest b) { return a == b || a == Rest::any || b == Rest::any; }

struct WorldState {
  explicit WorldState(const WorldDef& def);

  /// Gives back what none of its objects needs; no result follows from it.
  void shrink();
  std::size_t memory_bytes() const {
    return bytes_of(tables, body_ids, joint_ids, force_ids, bodies, joints, shapes, free_shapes, forces, contacts,
                    drops, frozen, no_collide, asked_apart);
  }

  // another for each world of the process: what a stepper remembers is of one of them
  std::uint64_t serial;
  std::atomic<bool> stepping{false};  // some stepper steps it: nothing else may change it
  /// As ids carry it.
  std::uint32_t id_world() const { return std::uint32_t(serial % 0xffffffffu) + 1; }
  Tables tables;
  Vec3 gravity;
  double last_substep = 0;  // h of the last step [s]; 0 before the first
  double soft_substep = 0;  // that soft rows were made for in it, at least as long [s] (plan/infos.h)

  IdPool body_ids{id_world()}, joint_ids{id_world()}, force_ids{id_world()};
  std::vector<BodyRecord> bodies;          // by row
  std::vector<JointRecord> joints;         // by row; row 0 pads
  std::uint32_t springs = 0;               // how many of them are springs between two points
  std::vector<ShapeRecord> shapes;         // by shape index
  std::vector<std::uint32_t> free_shapes;  // min-heap
  std::vector<ForceRecord> forces;         // by force index
  std::uint32_t callbacks = 0;             // how many of them are callbacks
  ContactColumns contacts;
  ContactDrops drops;  // bodies that were destroyed since
  OwnProperties own;
  std::unordered_map<std::uint32_t, MassProperties> frozen;  // by body index
  std::unordered_map<std::uint64_t, NoCollide> no_collide;   // by pair_key; only pairs with a reason
  // by body index with which others set_collide forbade it
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> asked_apart;

  /// One of each stepper that has kernels of the host's own for this world.
  std::vector<std::weak_ptr<const char>> kernel_holds;

  /// Counters that a stepper compares with what it saw last.
  std::uint64_t structure_version = 1;      // objects, kinds, filters
  std::uint64_t restores = 0;               // of snapshots: rows hold what they held then
  std::uint64_t joint_changes = 0;          // how many of these were of joints alone
  std::uint32_t kinematic = 0;              // bodies of that kind
  double settling = 0;                      // the largest of the bodies' property of that name
  std::uint32_t sleepers = 0, stirred = 0;  // bodies of which that property is not 0
  bool rests = false;                       // some body has a property of rest that is not as it was made
  std::uint64_t rest_version = 1;           // who sleeps, and who is stirred
  std::uint64_t removals = 0;               // of properties and tables of the host's own
  std::uint64_t contacts_version = 1;       // which contacts there are
  SeenChanges seen;                         // of the last walk over the invariants

  /// Body rows of a contact: the first is the one that moves, so that arms are short.
  std::array<std::uint32_t, 2> ends_of(const ContactKey& key) const;
  /// Removes an object's row; the last row of the table takes its place.
  template <class Record> void remove_row(Table table, std::vector<Record>& records, IdPool& ids, std::uint32_t row) {
    const std::uint32_t index = records[row].index, last = std::uint32_t(records.size()) - 1;
    if (row != last) {
      tables.copy_row(table, last, row);
      records[row] = std::move(records[last]);
      ids.set_row(records[row].index, row);
    }
    records.pop_back();
    tables.resize(table, last);
    ids.release(index);
    structure_version++;
  }
  /// Of a body that was just placed: what holds it is not known yet.
  void let_settle(std::uint32_t row);
  /// Whether it will still once the next step has begun.
  bool settles(std::uint32_t row) const { return tables.get(Buffer::velocity_parts, row, place::settling) > 1; }
  /// Whether its properties of rest are those that it was made with.
  bool never_rested(std::uint32_t row) const {
    return tables.get3(Buffer::rest, row, rest_quiet_time) == Vec3{};  // the three that are state
  }
  bool asleep(std::uint32_t row) const { return sleepers > 0 && tables.get(Buffer::rest, row, rest_asleep) > 0; }
  /// Of a joint: whether the bodies that it joins do.
  bool asleep(const JointRecord& joint) const {
    return sleepers > 0 && (asleep(body_ids.row(joint.body_a)) || asleep(body_ids.row(joint.body_b)));
  }
  /// Whether steps move it.
  bool goes(std::uint32_t row) const { return !stands(row) && !asleep(row); }
  /// The host has changed it: if it sleeps, it is to wake; if it stands, whatever it touches or is joined to.
  void stir(std::uint32_t row);
  /// The same of one that does not stand: what touches one that does may sleep on.
  void stir_moving(std::uint32_t row) {
    if (!stands(row)) stir(row);
  }
  /// All bodies: something has changed that any of them may depend on.
  void stir_all();
  /// A kernel of the host's own may read it of this body or joint, or of all bodies that of a table of one row.
  void stir_reader(Table table, std::uint32_t row);
  /// Nobody sleeps, and nobody has rested.
  void forget_rest();
  /// The step has looked at who was stirred.
  void calm();
  /// Of a body that goes.
  void forget_rest(std::uint32_t row);
  /// Counts who sleeps and who is stirred, after their rows came from elsewhere.
  void count_rest();
  /// Memory for objects that are to come, and for all that there are to go.
  void make_room(std::uint32_t bodies, std::uint32_t joints, std::uint32_t shapes);
  /// Removes a body, with all that hangs on it; `drops` has room for it.
  void remove_body(std::uint32_t row);
  /// Removes a joint or spring.
  void remove_joint(std::uint32_t row);
  /// Removes the contacts of bodies that were destroyed; what touched them is to wake.
  void settle_contacts();

  std::uint32_t contact_rows() const { return tables.rows(Table::contact); }
  static std::uint64_t pair_key(std::uint32_t a, std::uint32_t b) {
    return std::uint64_t(a < b ? a : b) << 32 | (a < b ? b : a);
  }

  /// stale_id where there is none.
  Result<Table> table_of(TableId id) const;

  /// Whether forces and impulses act on it.
  bool responds(std::uint32_t row) const { return bodies[row].kind == BodyKind::dynamic && !bodies[row].frozen; }
  bool stands(std::uint32_t row) const { return bodies[row].kind == BodyKind::fixed || bodies[row].frozen; }
  /// From now on as a fixed body, at rest where it is.
  void freeze(std::uint32_t row);
  /// As it was made; its velocity is for the caller to set.
  void thaw(std::uint32_t row);
  /// Before the host changes it: one that was frozen thaws, one that sleeps is to wake.
  void change(std::uint32_t row) {
    stir(row);
    thaw(row);
  }
  /// Freezes or thaws a body as its state says, which a snapshot has just brought.
  void follow_mark(std::uint32_t row);

  // borders of a row, in double
  Pose pose(std::uint32_t row) const;
  void set_position(std::uint32_t row, Vec3 position);
  Quat orientation(std::uint32_t row) const;
  /// Twice its largest radius of gyration [m]; 0 of a body that does not rotate, or that no impulse moves.
  double size(std::uint32_t row) const;
  void set_orientation(std::uint32_t row, Quat q);
  Vec3 velocity(std::uint32_t row) const;
  Vec3 momentum_of_rotation(std::uint32_t row) const;
  Vec3 angular_velocity(std::uint32_t row) const;
  /// What a body with this angular momentum spins with [rad/s].
  Vec3 spin_of(std::uint32_t row, Vec3 angular_momentum) const;
  /// Makes the stored velocities those in phase with the position, so that one of them may be set.
  void bring_in_phase(std::uint32_t row);
  void set_angular_velocity(std::uint32_t row, Vec3 w);
  void set_mass(std::uint32_t row, const MassProperties& mass);
  /// BodyDef::rotates: the moments of others are stored as zero, and so are their inverses.
  bool rotates(std::uint32_t row) const {
    const Vec3 moments = bodies[row].frozen ? frozen.at(bodies[row].index).moments : tables.get3(Buffer::mass, row, 0);
    return bodies[row].kind != BodyKind::dynamic || moments.x > 0;
  }
  /// Takes a force out of the world's list, not out of its body's.
  void drop_force(std::uint32_t force);
  /// Of constants and callbacks. Where kernels of the host's own make forces (`gathered`), they begin with these.
  struct Gathered {
    Buffer force, torque;
    // there are columns for what some of them make once a step, too (pc_held_force, pc_held_torque)
    bool holds = false;
  };
  std::optional<Gathered> gathered;
  Vec3 given_force(std::uint32_t row) const {
    return gathered ? tables.get3(gathered->force, row, 0) : tables.get3(Buffer::force, row, 0);
  }
  Vec3 given_torque(std::uint32_t row) const {
    return gathered ? tables.get3(gathered->torque, row, 0) : tables.get3(Buffer::force, row, 4);
  }
  void give_forces(std::uint32_t row, Vec3 force, Vec3 torque);
  /// Writes the sum of a body's constant forces into the table.
  void sum_forces(std::uint32_t row);
  /// The same when the host has changed them: they act from now on.
  void change_forces(std::uint32_t row);
  /// Acceleration and torque change by so much from now on. The stored velocities lag half a sub-step, which the
  /// old ones would have filled: they move by half a kick, what is read stays.
  void kick(std::uint32_t row, Vec3 acceleration, Vec3 torque);
};

}  // namespace pcphys
