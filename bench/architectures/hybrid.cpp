// (c) The original's hybrid of hierarchy and components: a RigidBody is a game object that holds its state and points
// to its parts (forces, collider, scene node); a Ragdoll is a tree of bones and joints that is walked for each
// constraint update; collisions are a list that the collision tree hands to RigidBody.
#define PC_SCALAR float
#define PC_LANES 1
#define PC_NAMESPACE hybrid
#include "cpu/prelude.h"
#include "design.h"
#include "extras.h"

namespace pcphys::hybrid::objects {

using namespace architectures;

struct Io;
struct RigidBone;

struct GameObject {
  virtual ~GameObject() = default;
#define K(kernel) virtual void kernel(const Io& io) = 0;
  PCPHYS_BODY_KERNELS(K)
#undef K
};
// parts of a body
struct Forces : Fields<Buffer::force, Buffer::drag_terms> {};
struct Collider : Fields<Buffer::material> {
  explicit Collider(ShapeKind kind) : shape(kind) {}
  virtual ~Collider() = default;
  ShapeKind shape;
  float area = 0;  // [property]
};
struct SceneNode {
  float transform[16] = {};
};

struct RigidBody final
    : GameObject,
      Fields<Buffer::motion, Buffer::pose, Buffer::velocity_parts, Buffer::mass, Buffer::inertia, Buffer::delta> {
  explicit RigidBody(const BodyInit& init);
#define K(kernel) void kernel(const Io& io) override;
  PCPHYS_BODY_KERNELS(K)
#undef K
  // [force]
  void blow(const float wind[3]) {
    wind_drag(Field<Buffer::motion>::reals, collider->area, forces->Field<Buffer::force>::reals, wind);
  }
  // [end]
  std::size_t place = 0;
  std::unique_ptr<Forces> forces = std::make_unique<Forces>();
  std::unique_ptr<Collider> collider;
  std::unique_ptr<SceneNode> node = std::make_unique<SceneNode>();
  RigidBone* bone = nullptr;
};
struct RigidJoint : Fields<Buffer::joint_solved, Buffer::joint_impulse, Buffer::joint_rows> {
  RigidBone* parent = nullptr;
  std::unique_ptr<RigidBone> child;
};
struct RigidBone {
  RigidBody* body = nullptr;
  std::vector<std::unique_ptr<RigidJoint>> children;
};
struct Collision : Fields<Buffer::contact, Buffer::contact_rows, Buffer::contact_impulses> {
  RigidBody *a = nullptr, *b = nullptr;
};
// [constraint]
struct Rope {
  RigidBody *a, *b;
  float length;
  void hold(float inverse_h) {
    hold_rope(a->Field<Buffer::pose>::reals, b->Field<Buffer::pose>::reals, length, a->Field<Buffer::motion>::reals,
              b->Field<Buffer::motion>::reals, inverse_h);
  }
};
// [end]

// what the kernels' text calls things
struct Index {
  void* object;
};
struct Slot {
  void* object;
};

template <Buffer b> Scalar* find(void* object) {
  const auto reals = [](auto& part) { return part.template Field<b>::reals; };
  if constexpr (std::is_base_of_v<Field<b>, RigidBody>)
    return reals(*static_cast<RigidBody*>(object));
  else if constexpr (std::is_base_of_v<Field<b>, Forces>)
    return reals(*static_cast<RigidBody*>(object)->forces);
  else if constexpr (std::is_base_of_v<Field<b>, Collider>)
    return reals(*static_cast<RigidBody*>(object)->collider);
  else if constexpr (std::is_base_of_v<Field<b>, RigidJoint>)
    return reals(*static_cast<RigidJoint*>(object));
  else
    return reals(*static_cast<Collision*>(object));
}
struct Io {
  const Info* info;
  template <Buffer b> Scalar* at(Index i) const { return find<b>(i.object); }
  template <Buffer b> Scalar* rows(Slot s) const { return find<b>(s.object); }
  template <Buffer b> Index end(Slot s, uint side) const {
    if constexpr (b == Buffer::joint_ends) {
      const RigidJoint& joint = *static_cast<RigidJoint*>(s.object);
      return {side == 0 ? joint.parent->body : joint.child->body};
    } else {
      const Collision& collision = *static_cast<Collision*>(s.object);
      return {side == 0 ? collision.a : collision.b};
    }
  }
  Index record(Slot s) const { return {s.object}; }
};
#include "kernel_text.inl"

#define K(kernel) \
  void RigidBody::kernel(const Io& io) { kernel::pc_kernel(io, {this}); }
PCPHYS_BODY_KERNELS(K)
#undef K

RigidBody::RigidBody(const BodyInit& init) : collider(std::make_unique<Collider>(init.shape)) {
  write(init, {find<Buffer::motion>(this), find<Buffer::pose>(this), find<Buffer::mass>(this),
               find<Buffer::force>(this), find<Buffer::material>(this)});
  collider->area = float(init.area);  // [property]
}

/// Depth first, as the original's constraintUpdate.
template <class Visit> void walk(RigidBone& bone, Visit visit) {
  for (const auto& joint : bone.children) {
    visit(*joint);
    walk(*joint->child, visit);
  }
}

class Hybrid final : public Design {
 public:
  Handle ground() const override { return handle(ground_.get()); }
  Handle create_body(const BodyInit& init) override {
    auto body = std::make_unique<RigidBody>(init);
    const Handle made = handle(body.get());
    body->place = bodies_.size();
    bodies_.push_back(std::move(body));
    return made;
  }
  void destroy_body(Handle handle) override {
    const std::size_t place = body_of(handle).place;
    std::swap(bodies_[place], bodies_.back());
    rigid(*bodies_[place]).place = place;
    bodies_.pop_back();
  }
  void create_joint(Handle a, Handle b, const JointInit& init) override {
    RigidBone* parent = body_of(a).bone;
    if (parent == nullptr) {  // the root of another ragdoll
      parent = ragdolls_.emplace_back(std::make_unique<RigidBone>()).get();
      parent->body = &body_of(a);
    }
    RigidJoint& joint = *parent->children.emplace_back(std::make_unique<RigidJoint>());
    joint.parent = parent;
    joint.child = std::make_unique<RigidBone>();
    joint.child->body = &body_of(b);
    body_of(b).bone = joint.child.get();
    write(init, joint.Field<Buffer::joint_solved>::reals);
  }
  void create_contact(Handle a, Handle b, const ContactInit& init) override {
    Collision& made = collisions_.emplace_back();
    made.a = &body_of(a), made.b = &body_of(b);
    write(init, made.Field<Buffer::contact>::reals);
  }
  // [constraint]
  void create_rope(Handle a, Handle b, const RopeInit& init) override {
    ropes_.push_back({&body_of(a), &body_of(b), float(init.length)});
  }
  // [end]

  void run(Kernel kernel, const Info& info) override {
    const Io io{&info};
    switch (kernel) {
#define K(name)                                      \
  case Kernel::name:                                 \
    for (const auto& body : bodies_) body->name(io); \
    return;
      PCPHYS_BODY_KERNELS(K)
#undef K
#define K(name) \
  case Kernel::name: return each_joint([&](RigidJoint& joint) { name::pc_kernel(io, {&joint}); });
      PCPHYS_JOINT_KERNELS(K)
#undef K
#define K(name)                                                                  \
  case Kernel::name:                                                             \
    for (Collision & collision : collisions_) name::pc_kernel(io, {&collision}); \
    return;
      PCPHYS_CONTACT_KERNELS(K)
#undef K
      default: return;
    }
  }
  // [force]
  void run_wind(const float wind[3]) override {
    for (const auto& body : bodies_) rigid(*body).blow(wind);
  }
  // [constraint]
  void run_ropes(float inverse_h) override {
    for (Rope& rope : ropes_) rope.hold(inverse_h);
  }
  // [gather]
  void gather(float* packed) const override {
    for (const auto& body : bodies_) {
      RigidBody& b = rigid(*body);
      pack(find<Buffer::pose>(&b), find<Buffer::mass>(&b), find<Buffer::motion>(&b), packed);
      packed += packed_reals;
    }
  }
  void scatter(const float* packed) override {
    for (const auto& body : bodies_) {
      RigidBody& b = rigid(*body);
      unpack(packed, find<Buffer::pose>(&b), find<Buffer::motion>(&b));
      packed += packed_reals;
    }
  }
  // [end]
  void state(Handle body, float* state) const override {
    read_state(find<Buffer::pose>(&body_of(body)), find<Buffer::motion>(&body_of(body)), state);
  }

 private:
  static RigidBody& rigid(GameObject& object) { return static_cast<RigidBody&>(object); }
  template <class Visit> void each_joint(Visit visit) {
    for (const auto& root : ragdolls_) walk(*root, visit);
  }
  static Handle handle(RigidBody* body) { return reinterpret_cast<Handle>(body); }
  static RigidBody& body_of(Handle handle) { return *reinterpret_cast<RigidBody*>(handle); }

  std::unique_ptr<RigidBody> ground_ = std::make_unique<RigidBody>(BodyInit{});
  std::vector<std::unique_ptr<GameObject>> bodies_;  // the game's objects; here all are bodies
  std::vector<std::unique_ptr<RigidBone>> ragdolls_;
  std::vector<Collision> collisions_;
  std::vector<Rope> ropes_;  // [constraint]
};

}  // namespace pcphys::hybrid::objects

std::unique_ptr<pcphys::architectures::Design> pcphys::architectures::make_hybrid() {
  return std::make_unique<hybrid::objects::Hybrid>();
}
