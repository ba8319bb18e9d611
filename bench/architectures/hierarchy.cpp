// (a) A class hierarchy with virtual updates. Everything that a body, joint or contact has stands in the object, which
// new has put somewhere; lists of pointers say what there is.
#define PC_SCALAR float
#define PC_LANES 1
#define PC_NAMESPACE hierarchy
#include "cpu/prelude.h"
#include "design.h"
#include "extras.h"

namespace pcphys::hierarchy::objects {

using namespace architectures;

struct Object {
  virtual ~Object() = default;
};
// what the kernels' text calls things
struct Index {
  Object* object;
};
struct Slot {
  Object* object;
};
struct Io;

struct Body : Object,
              Fields<Buffer::motion, Buffer::pose, Buffer::velocity_parts, Buffer::mass, Buffer::force,
                     Buffer::drag_terms, Buffer::inertia, Buffer::delta, Buffer::material> {
  std::size_t place = 0;  // in the list of bodies
  float area = 0;         // [property]
#define K(kernel) virtual void kernel(const Io& io) = 0;
  PCPHYS_BODY_KERNELS(K)
#undef K
  // [force]
  void blow(const float wind[3]) { wind_drag(Field<Buffer::motion>::reals, area, Field<Buffer::force>::reals, wind); }
  // [end]
};
struct Constraint : Object {
  Body* bodies[2] = {};
};
struct Joint : Constraint, Fields<Buffer::joint_solved, Buffer::joint_impulse, Buffer::joint_rows> {
#define K(kernel) virtual void kernel(const Io& io);
  PCPHYS_JOINT_KERNELS(K)
#undef K
};
struct Contact : Constraint, Fields<Buffer::contact, Buffer::contact_rows, Buffer::contact_impulses> {
#define K(kernel) virtual void kernel(const Io& io);
  PCPHYS_CONTACT_KERNELS(K)
#undef K
};
// [constraint]
struct Rope final : Constraint {
  float length = 0;
  void hold(float inverse_h) {
    Body &a = *bodies[0], &b = *bodies[1];
    hold_rope(a.Field<Buffer::pose>::reals, b.Field<Buffer::pose>::reals, length, a.Field<Buffer::motion>::reals,
              b.Field<Buffer::motion>::reals, inverse_h);
  }
};
// [end]

template <Buffer b, class Of> constexpr bool has = std::is_base_of_v<Field<b>, Of>;
template <Buffer b>
using Owner = std::conditional_t<has<b, Body>, Body, std::conditional_t<has<b, Joint>, Joint, Contact>>;
template <Buffer b> Scalar* find(Object* object) { return static_cast<Owner<b>*>(object)->Field<b>::reals; }

struct Io {
  const Info* info;
  template <Buffer b> Scalar* at(Index i) const { return find<b>(i.object); }
  template <Buffer b> Scalar* rows(Slot s) const { return find<b>(s.object); }
  template <Buffer> Index end(Slot s, uint side) const { return {static_cast<Constraint*>(s.object)->bodies[side]}; }
  Index record(Slot s) const { return {s.object}; }
};
#include "kernel_text.inl"

/// A class for each kind of body, as such hierarchies have.
template <ShapeKind> struct Shaped final : Body {
#define K(kernel) \
  void kernel(const Io& io) override { kernel::pc_kernel(io, {this}); }
  PCPHYS_BODY_KERNELS(K)
#undef K
};
#define K(kernel) \
  void Joint::kernel(const Io& io) { kernel::pc_kernel(io, {this}); }
PCPHYS_JOINT_KERNELS(K)
#undef K
#define K(kernel) \
  void Contact::kernel(const Io& io) { kernel::pc_kernel(io, {this}); }
PCPHYS_CONTACT_KERNELS(K)
#undef K

class Hierarchy final : public Design {
 public:
  Handle ground() const override { return handle(ground_.get()); }
  Handle create_body(const BodyInit& init) override {
    std::unique_ptr<Body>& body = bodies_.emplace_back(make(init));
    body->place = bodies_.size() - 1;
    return handle(body.get());
  }
  void destroy_body(Handle handle) override {
    const std::size_t place = body_of(handle).place;
    std::swap(bodies_[place], bodies_.back());
    bodies_[place]->place = place;
    bodies_.pop_back();
  }
  void create_joint(Handle a, Handle b, const JointInit& init) override {
    write(init, add(joints_, a, b).Field<Buffer::joint_solved>::reals);
  }
  void create_contact(Handle a, Handle b, const ContactInit& init) override {
    write(init, add(contacts_, a, b).Field<Buffer::contact>::reals);
  }
  void create_rope(Handle a, Handle b, const RopeInit& init) override {
    add(ropes_, a, b).length = float(init.length);
  }  // [constraint]

  void run(Kernel kernel, const Info& info) override {
    const Io io{&info};
    switch (kernel) {
#define K(name) \
  case Kernel::name: return each(bodies_, [&](Body& body) { body.name(io); });
      PCPHYS_BODY_KERNELS(K)
#undef K
#define K(name) \
  case Kernel::name: return each(joints_, [&](Joint& joint) { joint.name(io); });
      PCPHYS_JOINT_KERNELS(K)
#undef K
#define K(name) \
  case Kernel::name: return each(contacts_, [&](Contact& contact) { contact.name(io); });
      PCPHYS_CONTACT_KERNELS(K)
#undef K
      default: return;
    }
  }
  // [force]
  void run_wind(const float wind[3]) override {
    each(bodies_, [&](Body& body) { body.blow(wind); });
  }
  // [constraint]
  void run_ropes(float inverse_h) override {
    each(ropes_, [&](Rope& rope) { rope.hold(inverse_h); });
  }
  // [gather]
  void gather(float* packed) const override {
    each(bodies_, [&](const Body& body) {
      pack(body.Field<Buffer::pose>::reals, body.Field<Buffer::mass>::reals, body.Field<Buffer::motion>::reals, packed);
      packed += packed_reals;
    });
  }
  void scatter(const float* packed) override {
    each(bodies_, [&](Body& body) {
      unpack(packed, body.Field<Buffer::pose>::reals, body.Field<Buffer::motion>::reals);
      packed += packed_reals;
    });
  }
  // [end]
  void state(Handle body, float* state) const override {
    read_state(body_of(body).Field<Buffer::pose>::reals, body_of(body).Field<Buffer::motion>::reals, state);
  }

 private:
  template <class List, class Visit> static void each(const List& list, Visit visit) {
    for (const auto& object : list) visit(*object);
  }
  static Handle handle(Body* body) { return reinterpret_cast<Handle>(body); }
  static Body& body_of(Handle handle) { return *reinterpret_cast<Body*>(handle); }
  static std::unique_ptr<Body> make(const BodyInit& init) {
    std::unique_ptr<Body> body;
    if (init.shape == ShapeKind::box)
      body = std::make_unique<Shaped<ShapeKind::box>>();
    else if (init.shape == ShapeKind::capsule)
      body = std::make_unique<Shaped<ShapeKind::capsule>>();
    else
      body = std::make_unique<Shaped<ShapeKind::sphere>>();
    write(init, {find<Buffer::motion>(body.get()), find<Buffer::pose>(body.get()), find<Buffer::mass>(body.get()),
                 find<Buffer::force>(body.get()), find<Buffer::material>(body.get())});
    body->area = float(init.area);  // [property]
    return body;
  }
  template <class T> static T& add(std::vector<std::unique_ptr<T>>& list, Handle a, Handle b) {
    T& made = *list.emplace_back(std::make_unique<T>());
    made.bodies[0] = &body_of(a), made.bodies[1] = &body_of(b);
    return made;
  }

  std::unique_ptr<Body> ground_ = make({});
  std::vector<std::unique_ptr<Body>> bodies_;
  std::vector<std::unique_ptr<Joint>> joints_;
  std::vector<std::unique_ptr<Contact>> contacts_;
  std::vector<std::unique_ptr<Rope>> ropes_;  // [constraint]
};

}  // namespace pcphys::hierarchy::objects

std::unique_ptr<pcphys::architectures::Design> pcphys::architectures::make_hierarchy() {
  return std::make_unique<hierarchy::objects::Hierarchy>();
}
