// What every design can do, so that one program builds, steps, checks and measures them all. A design is a way to keep
// objects and to run the library's kernels over them; the kernels' text is the same (kernel_text.inl,
// or the library's own loops).
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pcphys/types.h"
#include "world/schema.h"

namespace pcphys::architectures {

// the kernels that the scenes need, by what a call of them is about
#define PCPHYS_BODY_KERNELS(K) K(begin_drag) K(remember) K(integrate_drag) K(inertia) K(advance) K(synchronise_drag)
#define PCPHYS_JOINT_KERNELS(K) K(joint_prepare) K(joint_warm) K(joint_solve)
#define PCPHYS_CONTACT_KERNELS(K) K(contact_prepare) K(contact_warm) K(contact_solve) K(contact_store)

/// Reals of a property buffer's row, or of a joint's or contact's scratch.
constexpr std::size_t length_of(Buffer buffer) {
  switch (buffer) {
#define PC_ROWS(domain, buffer, reals) \
  case Buffer::buffer:                 \
    return reals;
#include "kernels/kernels.inl"
#undef PC_ROWS
    default: return reals_of(buffer);
  }
}

/// One row of a buffer, and several of them, for designs that keep an object's properties with it.
template <Buffer buffer> struct Field {
  alignas(16) float reals[length_of(buffer)] = {};
};
template <Buffer... buffers> struct Fields : Field<buffers>... {};

using Info = InfoOf<float>;
using Handle = std::uintptr_t;  // of a body, in the design's own terms

struct BodyInit {
  ShapeKind shape = ShapeKind::sphere;
  Vec3 position, velocity, momentum;  // momentum: angular
  double mass = 0;                    // 0: fixed
  Vec3 moments;
  Vec3 force;
  double drag = 0;
  double area = 0;
};
/// A pin with cone and twist.
struct JointInit {
  Vec3 anchor_a, anchor_b;
  double cone = 0, twist = 0;
};
/// A manifold of one point.
struct ContactInit {
  Vec3 normal, arm;
  double separation = 0, friction = 0;
};
struct RopeInit {
  double length = 0;
};

// ---- rows as the kernels want them, the same in all designs ------------------------------------------
struct BodyRows {
  float *motion, *pose, *mass, *force, *material;
};
void write(const BodyInit& init, const BodyRows& rows);
void write(const JointInit& init, float* joint_solved);
void write(const ContactInit& init, float* contact);

constexpr std::size_t packed_reals = 8;  // position, mass, velocity, 0
// [gather]
inline void pack(const float* pose, const float* mass, const float* motion, float* packed) {
  for (int i = 0; i < 3; i++) packed[i] = pose[i], packed[4 + i] = motion[i];
  packed[3] = mass[3], packed[7] = 0;
}
inline void unpack(const float* packed, float* pose, float* motion) {
  for (int i = 0; i < 3; i++) pose[i] = packed[i], motion[i] = packed[4 + i];
}
// [end]

constexpr std::size_t state_reals = 13;  // position, orientation, velocity, angular momentum
inline void read_state(const float* pose, const float* motion, float* state) {
  for (int i = 0; i < 3; i++) state[i] = pose[i], state[7 + i] = motion[i], state[10 + i] = motion[4 + i];
  for (int i = 0; i < 4; i++) state[3 + i] = pose[4 + i];
}

class Design {
 public:
  virtual ~Design() = default;
  virtual Handle ground() const = 0;
  virtual Handle create_body(const BodyInit& init) = 0;
  virtual void destroy_body(Handle body) = 0;
  /// Of a chain from its anchored end on: `a` is the ground, or a body that was `b` before.
  virtual void create_joint(Handle a, Handle b, const JointInit& init) = 0;
  virtual void create_contact(Handle a, Handle b, const ContactInit& init) = 0;
  virtual void create_rope(Handle a, Handle b, const RopeInit& init) = 0;
  /// When objects have been made or destroyed, before the next step.
  virtual void settle() {}

  /// One kernel over all bodies, joints or contacts. Joints of a chain are visited from its first on.
  virtual void run(Kernel kernel, const Info& info) = 0;
  /// The force that was added later: the wind's on every body.
  virtual void run_wind(const float wind[3]) = 0;
  /// The constraint that was added later, before bodies advance.
  virtual void run_ropes(float inverse_h) = 0;

  /// Position, velocity and mass of all bodies side by side (packed_reals each), and back.
  virtual void gather(float* packed) const = 0;
  virtual void scatter(const float* packed) = 0;
  /// The same properties where they stand, when they can be uploaded from there.
  virtual std::vector<std::span<const std::byte>> blocks() const { return {}; }

  virtual void state(Handle body, float* state) const = 0;  // state_reals
};

struct NamedDesign {
  const char* name;
  std::unique_ptr<Design> (*make)();
};
/// All of them, in the order of the report.
std::span<const NamedDesign> designs();

std::unique_ptr<Design> make_hierarchy();
std::unique_ptr<Design> make_entity_views();
std::unique_ptr<Design> make_entity_groups();
std::unique_ptr<Design> make_hybrid();
std::unique_ptr<Design> make_properties(std::uint32_t lanes);

}  // namespace pcphys::architectures
