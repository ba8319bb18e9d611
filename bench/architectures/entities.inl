// (b) Bodies, joints and contacts as entities of a component store (entity_store.h); a kernel is a system over a view.
// Included by entity_views.cpp, which finds each component by its entity, and by entity_groups.cpp (PCPHYS_GROUPS),
// where the components of bodies stand in one order, so that a place serves for all of them.
#include "cpu/prelude.h"
#include "design.h"
#include "entity_store.h"
#include "extras.h"

namespace pcphys::PC_NAMESPACE::systems {

using namespace architectures;

// components
template <Buffer b> using C = Field<b>;
template <Buffer> struct Ends {  // of a joint or of a contact
  Entity bodies[2];
};
// [property]
struct Area {
  float area;
};
// [constraint]
struct Rope {
  Entity a, b;
  float length;
};
// [end]

using Store =
    Registry<C<Buffer::motion>, C<Buffer::pose>, C<Buffer::velocity_parts>, C<Buffer::mass>, C<Buffer::force>,
             C<Buffer::drag_terms>, C<Buffer::inertia>, C<Buffer::delta>, C<Buffer::material>,
             Area,  // [property]
             Rope,  // [constraint]
             Ends<Buffer::joint_ends>, C<Buffer::joint_solved>, C<Buffer::joint_impulse>, C<Buffer::joint_rows>,
             Ends<Buffer::contact_ends>, C<Buffer::contact>, C<Buffer::contact_rows>, C<Buffer::contact_impulses>>;

// what the kernels' text calls things: an entity, or a place in the pools of its group
struct Index {
  std::uint32_t i;
};
struct Slot {
  std::uint32_t i;
};
struct Io {
  const Info* info;
  Store* store;
#ifdef PCPHYS_GROUPS
  template <Buffer b> Scalar* find(std::uint32_t place) const { return store->pool<C<b>>().at(place).reals; }
  template <Buffer b> Index end(Slot s, uint side) const {
    return {store->pool<C<Buffer::motion>>().place(store->pool<Ends<b>>().at(s.i).bodies[side])};
  }
#else
  template <Buffer b> Scalar* find(std::uint32_t entity) const { return store->pool<C<b>>().of(entity).reals; }
  template <Buffer b> Index end(Slot s, uint side) const { return {store->pool<Ends<b>>().of(s.i).bodies[side]}; }
#endif
  template <Buffer b> Scalar* at(Index i) const { return find<b>(i.i); }
  template <Buffer b> Scalar* rows(Slot s) const { return find<b>(s.i); }
  Index record(Slot s) const { return {s.i}; }
};
#include "kernel_text.inl"

class Entities final : public Design {
 public:
  Entities() { ground_ = Entity(create_body({})); }
  Handle ground() const override { return ground_; }
  Handle create_body(const BodyInit& init) override {
    const Entity body = store_.create();
    C<Buffer::motion>& motion = store_.add<C<Buffer::motion>>(body);
    C<Buffer::pose>& pose = store_.add<C<Buffer::pose>>(body);
    C<Buffer::mass>& mass = store_.add<C<Buffer::mass>>(body);
    C<Buffer::force>& force = store_.add<C<Buffer::force>>(body);
    C<Buffer::material>& material = store_.add<C<Buffer::material>>(body);
    store_.add<C<Buffer::velocity_parts>>(body);
    store_.add<C<Buffer::drag_terms>>(body);
    store_.add<C<Buffer::inertia>>(body);
    store_.add<C<Buffer::delta>>(body);
    store_.add<Area>(body) = {float(init.area)};  // [property]
    write(init, {motion.reals, pose.reals, mass.reals, force.reals, material.reals});
    return body;
  }
  void destroy_body(Handle body) override { store_.destroy(Entity(body)); }
  void create_joint(Handle a, Handle b, const JointInit& init) override {
    const Entity joint = constrain<Buffer::joint_ends>(a, b);
    write(init, store_.add<C<Buffer::joint_solved>>(joint).reals);
    store_.add<C<Buffer::joint_impulse>>(joint);
    store_.add<C<Buffer::joint_rows>>(joint);
  }
  void create_contact(Handle a, Handle b, const ContactInit& init) override {
    const Entity contact = constrain<Buffer::contact_ends>(a, b);
    write(init, store_.add<C<Buffer::contact>>(contact).reals);
    store_.add<C<Buffer::contact_rows>>(contact);
    store_.add<C<Buffer::contact_impulses>>(contact);
  }
  // [constraint]
  void create_rope(Handle a, Handle b, const RopeInit& init) override {
    store_.add<Rope>(store_.create()) = {Entity(a), Entity(b), float(init.length)};
  }
  // [end]

  void run(Kernel kernel, const Info& info) override {
    const Io io{&info, &store_};
    switch (kernel) {
#define K(name) \
  case Kernel::name: return bodies([&](std::uint32_t i) { name::pc_kernel(io, {i}); });
      PCPHYS_BODY_KERNELS(K)
#undef K
#define K(name)      \
  case Kernel::name: \
    return constraints<Buffer::joint_solved, Buffer::joint_ends>([&](std::uint32_t i) { name::pc_kernel(io, {i}); });
      PCPHYS_JOINT_KERNELS(K)
#undef K
#define K(name)      \
  case Kernel::name: \
    return constraints<Buffer::contact, Buffer::contact_ends>([&](std::uint32_t i) { name::pc_kernel(io, {i}); });
      PCPHYS_CONTACT_KERNELS(K)
#undef K
      default: return;
    }
  }
  // [force]
  void run_wind(const float wind[3]) override {
    store_.view<C<Buffer::motion>, C<Buffer::force>, Area>([&](Entity e) {
      wind_drag(find<Buffer::motion>(e), store_.pool<Area>().of(e).area, find<Buffer::force>(e), wind);
    });
  }
  // [constraint]
  void run_ropes(float inverse_h) override {
    store_.view<Rope>([&](Entity e) {
      const auto& [a, b, length] = store_.pool<Rope>().of(e);
      hold_rope(find<Buffer::pose>(a), find<Buffer::pose>(b), length, find<Buffer::motion>(a), find<Buffer::motion>(b),
                inverse_h);
    });
  }
  // [gather]
  void gather(float* packed) const override {
    const Io io{nullptr, &store_};
    bodies([&](std::uint32_t i) {
      pack(io.find<Buffer::pose>(i), io.find<Buffer::mass>(i), io.find<Buffer::motion>(i), packed);
      packed += packed_reals;
    });
  }
  void scatter(const float* packed) override {
    const Io io{nullptr, &store_};
    bodies([&](std::uint32_t i) {
      unpack(packed, io.find<Buffer::pose>(i), io.find<Buffer::motion>(i));
      packed += packed_reals;
    });
  }
  // [end]
  void state(Handle body, float* state) const override {
    read_state(find<Buffer::pose>(Entity(body)), find<Buffer::motion>(Entity(body)), state);
  }

 private:
#ifdef PCPHYS_GROUPS
  template <class Visit> void bodies(Visit visit) const {
    store_.group<C<Buffer::motion>>([&](std::uint32_t place) {
      if (place > 0) visit(place);  // the ground has been there first
    });
  }
  template <Buffer first, Buffer, class Visit> void constraints(Visit visit) const { store_.group<C<first>>(visit); }
#else
  template <class Visit> void bodies(Visit visit) const {
    store_.view<C<Buffer::motion>, C<Buffer::pose>, C<Buffer::mass>, C<Buffer::force>>([&](Entity entity) {
      if (entity != ground_) visit(entity);
    });
  }
  template <Buffer first, Buffer ends, class Visit> void constraints(Visit visit) const {
    store_.view<C<first>, Ends<ends>>(visit);
  }
#endif
  template <Buffer b> Scalar* find(Entity entity) const { return store_.pool<C<b>>().of(entity).reals; }
  template <Buffer ends> Entity constrain(Handle a, Handle b) {
    const Entity made = store_.create();
    store_.add<Ends<ends>>(made) = {{Entity(a), Entity(b)}};
    return made;
  }

  mutable Store store_;
  Entity ground_;
};

}  // namespace pcphys::PC_NAMESPACE::systems
