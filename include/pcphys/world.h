// The world: tables of properties, ids, and nothing else. It holds no algorithm; a Stepper moves it on.
//
// Every function that takes an id answers a stale one with ErrorCode::stale_id, every one that takes
// numbers answers NaN and infinity with ErrorCode::not_finite, and a refused call leaves the world exactly
// as it was. While a step of it runs, which callbacks see, every change is ErrorCode::busy. Nothing but a destructor
// and an assignment may be called of a world that was moved from: that ends the process with a sentence. A world is
// used by one thread at a time.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "pcphys/ids.h"
#include "pcphys/math.h"
#include "pcphys/property.h"
#include "pcphys/result.h"
#include "pcphys/types.h"

namespace pcphys {

struct WorldState;
class World;

/// A manifold between two bodies, as the last step left it. World axes, SI units.
struct Contact {
  struct Point {
    /// On the light body's surface, midway between equal ones; as found, from a where a is now [m].
    Vec3 position;
    double separation = 0;  // negative when the shapes overlap [m]
    double impulse = 0;     // along the normal, of the last sub-step [N s]
  };
  BodyId a, b;
  Vec3 normal;  // from a to b
  std::vector<Point> points;
};

struct WorldDef {
  Precision precision = Precision::f32;
  Vec3 gravity{0, -9.81, 0};  // [m/s^2]; there is no preferred up axis
};

using ForceId = Id<struct ForceTag>;
/// Evaluated once a step, before anything moves. It may read the world, not change it.
/// What it throws makes the step fail.
using ForceCallback = std::function<Wrench(const World&, BodyId)>;

class World {
 public:
  explicit World(const WorldDef& def = {});
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  // ---- objects ---------------------------------------------------------------------------------------
  /// The fixed body at the origin that every world has: what joints "to the world" hold on to.
  BodyId ground() const;
  Result<BodyId> create_body(const BodyDef& def);
  Result<JointId> create_joint(const JointDef& def);
  /// The two bodies may collide. Stiffness, damping and rest length below zero are ErrorCode::bad_joint.
  Result<SpringId> create_spring(const SpringDef& def);
  /// Pins what stands at a point of the world [m] of a dynamic body to a kinematic one, a hand, by at most 100 times
  /// the weight of all that hangs together with the body by joints (of gravity, or where there is none of the earth's).
  /// ErrorCode::bad_joint of other kinds.
  Result<JointId> grab(BodyId hand, BodyId body, Vec3 point);
  /// Bones and joints of a ragdoll whose frame stands at `pose`; all bones move with `velocity`.
  Result<Ragdoll> create_ragdoll(const RagdollDef& def, const Pose& pose, Vec3 velocity = {});
  /// Takes the body's shapes, joints, springs and forces with it.
  Status destroy(BodyId body);
  /// All of them, or none: where one is not there, or twice in the list, that is ErrorCode::stale_id.
  Status destroy(std::span<const BodyId> bodies);
  Status destroy(JointId joint);
  Status destroy(SpringId spring);

  bool valid(BodyId body) const;
  bool valid(JointId joint) const;
  bool valid(SpringId spring) const;
  /// All bodies in ascending id order, the ground excluded.
  std::vector<BodyId> bodies() const;
  std::vector<JointId> joints() const;
  std::vector<SpringId> springs() const;
  std::size_t body_count() const;  // the ground excluded
  std::size_t joint_count() const;
  std::size_t contact_count() const;  // manifolds with points, of the last step
  /// What touched in the last step, in an order that depends on the shapes' ids alone. `view` shows the same
  /// without copying.
  std::vector<Contact> contacts() const;

  // ---- state -----------------------------------------------------------------------------------------
  Result<Pose> pose(BodyId body) const;
  Status set_pose(BodyId body, const Pose& pose);
  /// In phase with the position: second order accurate in free flight, zero at rest [m/s].
  Result<Vec3> velocity(BodyId body) const;
  Status set_velocity(BodyId body, Vec3 velocity);
  /// World axes [rad/s].
  Result<Vec3> angular_velocity(BodyId body) const;
  Status set_angular_velocity(BodyId body, Vec3 angular_velocity);
  Result<Vec3> angular_momentum(BodyId body) const;
  /// The original's last position and last orientation, one sub-step `h` ago: derived from what is stored,
  /// p - h u and exp(-h w) q. Writing them sets the velocity so that the next read gives them back.
  Result<Vec3> position_last(BodyId body) const;
  Status set_position_last(BodyId body, Vec3 position);
  Result<Quat> orientation_last(BodyId body) const;
  Status set_orientation_last(BodyId body, Quat orientation);

  /// Whether a step found numbers of this body that it cannot go on with: NaN, or beyond constants::largest_state
  /// within the step. It stands since then as a fixed body, at its last pose, and others go on. Setting its pose, a
  /// velocity, mass or drag, or changing its forces lets it move again, at rest unless a velocity is set.
  Result<bool> frozen(BodyId body) const;

  /// Whether it sleeps: its step left it out, and so will the next (docs/sleeping.md).
  Result<bool> is_asleep(BodyId body) const;
  /// Wakes its island at the next step, and lets no body rest on what it was before. What the functions of this class
  /// change wakes by itself; this is for what they do not see, such as a change of what a kernel
  /// of the host's own does.
  Status wake(BodyId body);
  Result<bool> can_sleep(BodyId body) const;
  Status set_can_sleep(BodyId body, bool can_sleep);

  // ---- inputs ----------------------------------------------------------------------------------------
  Vec3 gravity() const;
  Status set_gravity(Vec3 gravity);
  Result<BodyKind> kind(BodyId body) const;
  Result<MassProperties> mass_properties(BodyId body) const;
  Status set_mass_properties(BodyId body, const MassProperties& mass);
  Result<Material> material(BodyId body) const;
  Status set_material(BodyId body, const Material& material);
  Status set_drag(BodyId body, double linear, double angular);
  /// Adds to the body's list of forces and torques; a constant, or a callback.
  Result<ForceId> add_force(BodyId body, const Wrench& wrench);
  Result<ForceId> add_force(BodyId body, ForceCallback callback);
  Status remove(ForceId force);
  /// The shapes as they were given at creation.
  Result<std::vector<ShapeDef>> shapes(BodyId body) const;
  Status set_filter(BodyId body, const Filter& filter);
  /// Whether two bodies may never collide, besides what joints and filters say.
  /// Twice the same body is ErrorCode::bad_argument.
  Status set_collide(BodyId a, BodyId b, bool collide);
  Result<JointDef> joint(JointId joint) const;
  /// From the next step on. Speed in [rad/s], torque in [N m]; a torque below zero is ErrorCode::bad_joint.
  Status set_motor(JointId joint, const Motor& motor);
  Status set_spring(JointId joint, const AngularSpring& spring);
  Result<SpringDef> spring(SpringId spring) const;
  /// Rest length [m], stiffness [N/m] and damping [N s/m] from the next step on.
  Status set_spring(SpringId spring, double rest_length, double stiffness, double damping);

  // ---- measures --------------------------------------------------------------------------------------
  /// Kinetic energy, velocities in phase with positions [J].
  double kinetic_energy() const;
  /// In the uniform gravity field, zero at the origin [J].
  double potential_energy() const;
  /// Stored in the springs of joints and between points [J].
  double spring_energy() const;
  /// Of the velocities as they are stored, half a sub-step behind the positions: what impulses between bodies
  /// leave unchanged to rounding. Gravity's share of that half sub-step is not in it [kg m/s].
  Vec3 momentum() const;
  /// The same about the origin [kg m^2/s].
  Vec3 angular_momentum() const;
  /// Distance between the two pins of a joint [m].
  Result<double> joint_separation(JointId joint) const;

  // ---- tables ----------------------------------------------------------------------------------------
  Precision precision() const;
  /// A view of a property by name: "position", "angular_momentum", ... (docs/properties.md lists all), or one of the
  /// host's own. Valid until an object of its table is created or destroyed. Row 0 is the padding row;
  /// `row_of` finds a body's.
  Result<PropertyView> view(std::string_view property) const;
  Result<std::uint32_t> row_of(BodyId body) const;
  Result<std::uint32_t> row_of(JointId joint) const;
  /// What its tables and objects take.
  std::size_t memory_bytes() const;
  /// Gives back memory that none of its objects needs, such as that of many which were destroyed; what comes of steps
  /// is the same.
  Status shrink();

  /// A property of the host's own, of bodies, of joints (and springs), or of a table of its own: T is Real, float,
  /// double, std::int32_t, std::uint32_t, Vec3, Vec4, Quat, Mat3 or SymMat3. Every row, present and to come, starts
  /// with `initial`. Until a kernel of some stepper names it, it is the host's alone: to set it wakes nobody, and the
  /// hash does not hold it unless its role is `state`. Snapshots hold it if its role is `host` or `state`. The name
  /// must be one that a kernel's text can use: letters, digits and underscores,
  /// not that of another property (ErrorCode::name_taken).
  template <PropertyValue T>
  Result<Property<T>> add_property(std::string_view name, const T& initial = {}, std::string_view unit = "1",
                                   TableId table = body_table, Role role = Role::host) {
    const PropertyNumbers numbers(initial);
    return handle<T>(add_property(name, property_type<T>, numbers.x, unit, table, role));
  }
  /// Its values are gone, and what names it is stale.
  Status remove_property(std::string_view name);
  /// One that is there, of the library's or the host's own; ErrorCode::wrong_type where it holds no T.
  template <PropertyValue T> Result<Property<T>> property(std::string_view name) const {
    return handle<T>(find_property(name, property_type<T>));
  }
  /// The value of one object, or of one row of a table of the host's own. What the library derives from others or keeps
  /// in step with them (any of its own that is no `input`) can be read, not set: that is ErrorCode::bad_argument.
  template <PropertyValue T> Result<T> get(Property<T> property, RowOf object) const {
    PropertyNumbers numbers;
    if (Status ok = read({property.index, property.generation, property.world}, object, numbers.x); !ok)
      return ok.error();
    return numbers.as<T>();
  }
  template <PropertyValue T> Status set(Property<T> property, RowOf object, const T& value) {
    const PropertyNumbers numbers(value);
    return write({property.index, property.generation, property.world}, object, numbers.x);
  }
  /// All of them, the library's first, then the host's own in the order of their handles.
  /// Names stand as long as the properties.
  std::vector<PropertyInfo> properties() const;

  /// A table of the host's own with rows 1 to `rows`, at most 2^28; row 0 pads, as in every table.
  Result<TableId> add_table(std::string_view name, std::uint32_t rows = 0);
  /// New rows hold each property's initial value; rows beyond are gone. Errors: bad_argument above 2^28, buffer_full
  /// where there is no memory for them; then the table is as it was.
  Status resize(TableId table, std::uint32_t rows);
  Result<std::uint32_t> rows(TableId table) const;
  /// Takes its properties with it.
  Status remove(TableId table);

  /// FNV-1a, 64 bit, over state and solver memory in ascending id order; -0 counts as +0. A property of role `host` is
  /// in it since a kernel of some stepper has named it: what comes of steps may follow from it.
  std::uint64_t hash() const;
  /// All properties of role `state` or `host`, as bytes; restored bit for bit into a world with the same objects.
  std::vector<std::byte> snapshot() const;
  Status restore(std::span<const std::byte> snapshot);

  /// The inside, for the library's own stages.
  WorldState& state(const char* call = __builtin_FUNCTION()) {
    if (!state_) detail::moved_from("World", call);
    return *state_;
  }
  const WorldState& state(const char* call = __builtin_FUNCTION()) const {
    if (!state_) detail::moved_from("World", call);
    return *state_;
  }
  /// The same with contacts and rest as they are after what was destroyed.
  const WorldState& settled(const char* call = __builtin_FUNCTION()) const;

 private:
  using AnyProperty = Id<struct AnyPropertyTag>;
  template <class T> static Result<Property<T>> handle(const Result<AnyProperty>& found) {
    if (!found) return found.error();
    return Property<T>{found->index, found->generation, found->world};
  }
  Result<AnyProperty> add_property(std::string_view name, PropertyType type, const double* initial,
                                   std::string_view unit, TableId table, Role role);
  Result<AnyProperty> find_property(std::string_view name, PropertyType type) const;
  Status read(AnyProperty property, RowOf object, double* numbers) const;
  Status write(AnyProperty property, RowOf object, const double* numbers);
  /// Whether no step of it runs, and the object is there.
  Status changeable(const char* call = __builtin_FUNCTION()) const;
  Status changeable(BodyId body, const char* call = __builtin_FUNCTION()) const;
  Status changeable(JointId joint, const char* call = __builtin_FUNCTION()) const;
  Status changeable(SpringId spring, const char* call = __builtin_FUNCTION()) const;

  std::unique_ptr<WorldState> state_;
};

/// Mass and moments of one shape about its own centre (the original's getInertiaMat), for a density [kg/m^3].
Result<MassProperties> mass_properties(const ShapeDef& shape, double density);

/// Several shapes as one body: finds the common centre of mass and principal axes, moves the shapes into
/// that frame and `def.pose` with them, and fills in mass and moments. `def.shapes` are in the frame of
/// `def.pose` before, in the principal frame after.
Status make_compound(BodyDef& def);

}  // namespace pcphys
