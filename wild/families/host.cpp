// A host that changes its world between the steps: random calls, each of them legal.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "wild/families/common.h"
#include "wild/scene.h"
#include "wild/shapes.h"

namespace pcphys::wild {
namespace {

/// The walls' category, which no mask leaves out: nothing falls through the floor.
constexpr std::uint32_t wall = 1u << 31;

/// What is there at the moment, so that no call names what was destroyed.
class Host {
 public:
  explicit Host(Builder& b) : b_(b), dice_(b.dice), half_(b.dice.between(1.5, 4)), height_(b.dice.between(2, 5)) {}

  using Act = void (Host::*)();

  void build() {
    Room{half_, height_, random_material(dice_), {wall, 0xffffffffu, 0}}.build(b_);
    kinematic_ = dice_.chance(0.4);
    size_ = dice_.by_ratio(0.1, 0.4);
    const int count = 5 + dice_.one_of(21);
    const int across = int(2 * half_ / (2.2 * size_));
    for (int i = 0; i < count; i++) {
      const int layer = i / (across * across), cell = i % (across * across);
      const Vec3 place{(cell % across - 0.5 * (across - 1)) * 2.2 * size_, (1.2 + 2.2 * layer) * size_,
                       (cell / across - 0.5 * (across - 1)) * 2.2 * size_};
      if (place.y + size_ < height_) make_body(place);
    }
    join_neighbours();
    if (dice_.chance(0.3)) b_.scene.settings.sleep = true;
    b_.scene.settings.substeps = random_substeps(dice_);
    settings_ = b_.scene.settings;
  }

  void play(std::span<const Act> acts) {
    const double even = random_dt(dice_), other = random_dt(dice_);
    const int pace = dice_.one_of(4);  // the same dt, two in turns, one that changes, any
    double dt = even;
    int left = 60 + dice_.one_of(91);
    while (left > 0) {
      const int now = std::min(left, 1 + dice_.one_of(5));
      for (int i = 0; i < now; i++) {
        if (pace == 1) dt = (left - i) % 2 == 0 ? even : other;
        if (pace == 3) dt = dice_.by_ratio(1.0 / 240, 1.0 / 30);
        b_.steps(1, dt);
      }
      left -= now;
      if (pace == 2 && dice_.chance(0.1)) dt = random_dt(dice_);
      (this->*acts[std::size_t(dice_.one_of(int(acts.size())))])();
    }
    set_rules();
  }

  void place() {
    if (bodies_.empty()) return;
    const Body& body = any_body();
    // Where it is now is not known here: it comes to lie anywhere, in others too.
    const Vec3 where = any_place();
    b_.call(SetPose{body.number, {where, dice_.orientation()}});
    overlaps_ = true;
    if (body.jointed) opened_ = true;
  }
  void push() {
    Body* body = any_of([](const Body& one) { return one.kind != BodyKind::fixed; });
    if (!body) return;
    const Vec3 velocity = random_vector(dice_, 0.01, body->kind == BodyKind::kinematic ? 5 : 20);
    const Vec3 spin = dice_.chance(0.5) ? random_vector(dice_, 0.01, 30) : Vec3{};
    b_.call(SetVelocity{body->number, velocity, body->rotates ? spin : Vec3{}});
  }
  void stop() {
    if (Body* body = any_of([](const Body& one) { return one.kind != BodyKind::fixed; }))
      b_.call(SetVelocity{body->number, {}, {}});
  }
  void make() {
    if (bodies_.size() >= 40) return;
    make_body(any_place());
    overlaps_ = true;
    saved_ = false;
  }
  void destroy_body() {
    if (bodies_.size() < 3) return;
    const std::size_t i = std::size_t(dice_.one_of(int(bodies_.size())));
    const int number = bodies_[i].number;
    b_.call(Destroy{Object::body, number});
    const auto hangs_on = [&](const Link& link) { return link.a == number || link.b == number; };
    std::erase_if(joints_, hangs_on);
    std::erase_if(springs_, hangs_on);
    std::erase_if(forces_, hangs_on);
    bodies_.erase(bodies_.begin() + std::ptrdiff_t(i));
    saved_ = false;
  }
  void make_joint() {
    Body* body = any_of(is_free);
    Body* other = any_of([&](const Body& one) { return &one != body && one.rotates; });
    if (!body || !other || !body->rotates) return;
    JointDef def;
    def.frame_a.position = random_vector(dice_, 0.1, 1) * other->radius;
    def.frame_b.position = random_vector(dice_, 0.1, 1) * body->radius;
    def.frame_b.orientation = dice_.orientation();
    def.freedom = random_freedom(dice_);
    def.collide = dice_.chance(0.5);
    add_joint(*other, *body, def);
    opened_ = overlaps_ = true;
    saved_ = false;
  }
  void make_spring() {
    Body* body = any_of(is_free);
    Body* other = any_of([&](const Body& one) { return &one != body; });
    if (!body || !other) return;
    SpringDef def;
    def.anchor_a = random_vector(dice_, 0.1, 1) * other->radius;
    def.anchor_b = random_vector(dice_, 0.1, 1) * body->radius;
    random_law(*body, def);
    springs_.push_back({b_.add(other->number, body->number, def), other->number, body->number});
    saved_ = false;
  }
  void destroy_joint() {
    if (destroy_one(joints_, Object::joint)) overlaps_ = true;
  }
  void destroy_spring() { (void)destroy_one(springs_, Object::spring); }
  void add_force() {
    Body* body = any_of(is_free);
    if (!body) return;
    const double weight = body->mass.mass * earth;
    const Vec3 force = random_vector(dice_, 0.1, 30) * weight;
    const Vec3 torque = dice_.chance(0.4) ? random_vector(dice_, 0.1, 10) * (weight * body->radius) : Vec3{};
    forces_.push_back({b_.add(body->number, Wrench{force, torque}), body->number, body->number});
  }
  void remove_force() {
    const bool kept = saved_;  // forces are no objects of a snapshot
    (void)destroy_one(forces_, Object::force);
    saved_ = kept;
  }
  void weigh() {
    Body* body = any_of(is_free);
    if (!body) return;
    const double share = dice_.by_ratio(0.1, 10);
    body->mass = {body->mass.mass * share, body->mass.moments * share};
    b_.call(SetMass{body->number, body->mass});
  }
  void coat() {
    if (!bodies_.empty()) b_.call(SetMaterial{any_body().number, random_material(dice_)});
  }
  void drag() {
    if (bodies_.empty()) return;
    const double linear = dice_.chance(0.3) ? 0 : dice_.by_ratio(0.01, 100);
    const double angular = dice_.chance(0.3) ? 0 : dice_.by_ratio(0.01, 100);
    b_.call(SetDrag{any_body().number, linear, angular});
  }
  void filter() {
    if (bodies_.empty()) return;
    Filter filter;
    filter.category = 1u << dice_.one_of(4);
    filter.mask = wall | (dice_.chance(0.4) ? 0xfu : 1u << dice_.one_of(4));
    filter.group = dice_.chance(0.3) ? dice_.one_of(5) - 2 : 0;
    b_.call(SetFilter{any_body().number, filter});
    overlaps_ = true;
  }
  void part() {
    if (bodies_.size() < 2) return;
    const int a = any_body().number, c = any_body().number;
    if (a == c) return;
    b_.call(SetCollide{a, c, dice_.chance(0.5)});
    overlaps_ = true;
  }
  void drive() {
    if (joints_.empty()) return;
    const int joint = joints_[std::size_t(dice_.one_of(int(joints_.size())))].number;
    const double couple = dice_.by_ratio(1e-3, 1e4);
    if (dice_.chance(0.5)) {
      b_.call(SetMotor{joint, {dice_.between(-20, 20), dice_.chance(0.2) ? 0 : couple}});
      return;
    }
    const double damping = dice_.chance(0.5) ? 0 : dice_.by_ratio(1e-3, 1e2);
    b_.call(SetJointSpring{joint, {couple, damping, dice_.orientation()}});
  }
  void retune() {
    if (springs_.empty()) return;
    const Link& spring = springs_[std::size_t(dice_.one_of(int(springs_.size())))];
    SpringDef def;
    for (const Body& one : bodies_)
      if (one.number == spring.b) random_law(one, def);
    b_.call(SetSpring{spring.number, def.rest_length, def.stiffness, def.damping});
  }
  void fall_otherwise() {
    Vec3 gravity{0, -earth, 0};
    if (dice_.chance(0.2)) gravity = {};
    if (dice_.chance(0.3)) gravity = random_vector(dice_, 0.5, 50);
    b_.call(SetGravity{gravity});
  }
  void configure() {
    settings_.substeps = 1u + std::uint32_t(dice_.one_of(8));
    settings_.refinement = dice_.chance(0.5) ? 16 : 1u << dice_.one_of(6);
    settings_.order = dice_.chance(0.1) ? 4 : 2;
    settings_.sleep = dice_.chance(0.4);
    if (dice_.chance(0.3)) settings_.sleep_time = dice_.by_ratio(0.02, 1);
    if (dice_.chance(0.3)) settings_.sleep_speed = dice_.by_ratio(1e-3, 0.1);
    if (dice_.chance(0.3)) settings_.sleep_spin = dice_.by_ratio(1e-3, 0.2);
    if (dice_.chance(0.3)) settings_.push_speed = dice_.by_ratio(0.1, 10);
    if (dice_.chance(0.3)) settings_.restitution_threshold = dice_.chance(0.3) ? 0 : dice_.by_ratio(0.05, 2);
    if (dice_.chance(0.3)) settings_.contact_margin = dice_.chance(0.5) ? 0 : dice_.by_ratio(1e-3, 0.05);
    b_.call(Configure{settings_});
  }
  void keep_awake() {
    if (!bodies_.empty()) b_.call(SetCanSleep{any_body().number, dice_.chance(0.6)});
  }
  void wake() {
    if (!bodies_.empty()) b_.call(Wake{any_body().number});
  }
  void save() {
    b_.call(Save{});
    saved_ = true;
  }
  void restore() {
    if (saved_) b_.call(Restore{});
  }

 private:
  struct Body {
    int number;
    BodyKind kind;
    MassProperties mass;
    double radius;
    bool rotates, jointed;
    Pose made_at;
  };
  /// A joint, a spring or a force, and what it acts on.
  struct Link {
    int number, a, b;
  };

  static bool is_free(const Body& one) { return one.kind == BodyKind::dynamic; }

  Body& any_body() { return bodies_[std::size_t(dice_.one_of(int(bodies_.size())))]; }
  /// Null where there is none.
  template <class Wanted> Body* any_of(Wanted wanted) {
    std::vector<Body*> found;
    for (Body& one : bodies_)
      if (wanted(one)) found.push_back(&one);
    return found.empty() ? nullptr : found[std::size_t(dice_.one_of(int(found.size())))];
  }
  Vec3 any_place() {
    const double side = half_ - size_, top = height_ - size_;
    return {dice_.between(-side, side), dice_.between(size_, top), dice_.between(-side, side)};
  }

  /// Of one shape, or in every sixth draw of two.
  BodyDef random_def() {
    const double radius = size_ * dice_.by_ratio(0.3, 1);
    const bool pair = dice_.chance(0.17);
    BodyDef def = loose_body(dice_, pair ? 0.5 * radius : radius);
    const int roll = dice_.one_of(20);
    def.kind = roll < 2 ? BodyKind::fixed : roll < 4 && kinematic_ ? BodyKind::kinematic : BodyKind::dynamic;
    if (pair) {
      def.shapes.push_back(random_shape(dice_, 0.5 * radius));
      def.shapes[1].local = {{0.5 * radius, 0, 0}, dice_.orientation()};
      (void)make_compound(def);
    }
    def.rotates = !dice_.chance(0.05);
    def.can_sleep = !dice_.chance(0.1);
    if (dice_.chance(0.2)) def.linear_drag = def.angular_drag = dice_.by_ratio(0.01, 10);
    if (def.kind == BodyKind::fixed) return def;
    def.velocity = random_vector(dice_, 0.01, def.kind == BodyKind::dynamic ? 10 : 2);
    const Vec3 spin = random_vector(dice_, 0.01, 20);
    if (def.rotates) def.angular_velocity = spin;
    return def;
  }
  void make_body(Vec3 place) {
    BodyDef def = random_def();
    def.pose.position = place;
    Body body{0, def.kind, {}, 0, def.rotates, false, def.pose};
    for (const ShapeDef& shape : def.shapes)
      body.radius = std::max(body.radius, length(shape.local.position) + outer_radius(shape));
    if (def.mass)
      body.mass = {*def.mass, *def.moments};
    else
      body.mass = *mass_properties(def.shapes[0], def.density);
    body.number = b_.add(std::move(def));
    bodies_.push_back(body);
  }

  void add_joint(Body& a, Body& c, const JointDef& def) {
    joints_.push_back({b_.add(a.number, c.number, def), a.number, c.number});
    a.jointed = c.jointed = true;
  }
  void random_law(const Body& body, SpringDef& def) {
    def.rest_length = dice_.chance(0.2) ? 0 : dice_.by_ratio(0.05, 2);
    def.stiffness = dice_.by_ratio(1, 1e6);
    def.damping =
        dice_.chance(0.4) ? 0 : dice_.between(0, 4) * std::sqrt(def.stiffness * std::max(body.mass.mass, 1e-3));
  }
  template <class List> bool destroy_one(List& list, Object object) {
    if (list.empty()) return false;
    const std::size_t i = std::size_t(dice_.one_of(int(list.size())));
    b_.call(Destroy{object, list[i].number});
    list.erase(list.begin() + std::ptrdiff_t(i));
    saved_ = false;
    return true;
  }
  /// Pairs that stand beside each other, so that joints are closed and make no loops.
  void join_neighbours() {
    for (std::size_t i = 0; i + 1 < bodies_.size(); i += 2) {
      Body &a = bodies_[i], &c = bodies_[i + 1];
      const Vec3 way = c.made_at.position - a.made_at.position;
      const bool one_moves = a.kind == BodyKind::dynamic || c.kind == BodyKind::dynamic;
      if (!one_moves || length(way) > 3 * size_) continue;
      const int roll = dice_.one_of(3);  // a joint, a spring, or neither
      const Vec3 point = a.made_at.position + way * 0.5;
      JointDef joint = joint_at(a.made_at, c.made_at, point, dice_.orientation());
      joint.freedom = random_freedom(dice_);
      if (roll == 0 && a.rotates && c.rotates) add_joint(a, c, joint);
      if (roll != 1) continue;
      SpringDef spring;
      random_law(c, spring);
      springs_.push_back({b_.add(a.number, c.number, spring), a.number, c.number});
    }
  }
  void set_rules() {
    Rules& rules = b_.scene.rules;
    rules.overlaps = overlaps_;
    rules.joints_may_yield = opened_ || kinematic_;
    // What springs and joints pull may be drawn into a wall, and kinematic bodies go where they want and push others.
    const double margin = kinematic_ ? 1e30 : 3;
    rules.lower = rules.lower - Vec3{1, 1, 1} * margin;
    rules.upper = rules.upper + Vec3{1, 1, 1} * margin;
  }

  Builder& b_;
  Dice& dice_;
  double half_, height_, size_ = 0;  // of the room, and of bodies at most [m]
  bool kinematic_ = false, saved_ = false, overlaps_ = false, opened_ = false;
  StepSettings settings_;
  std::vector<Body> bodies_;
  std::vector<Link> joints_, springs_, forces_;
};

constexpr Host::Act of_state[] = {&Host::place, &Host::push,    &Host::stop,
                                  &Host::save,  &Host::restore, &Host::add_force};
constexpr Host::Act of_structure[] = {&Host::make,        &Host::destroy_body,  &Host::make_joint,
                                      &Host::make_spring, &Host::destroy_joint, &Host::destroy_spring};
/// None of them makes an overlap or opens a joint.
constexpr Host::Act of_settings[] = {&Host::configure, &Host::fall_otherwise, &Host::keep_awake, &Host::wake,
                                     &Host::coat,      &Host::drag,           &Host::save,       &Host::restore};
constexpr Host::Act of_forces[] = {&Host::drive,     &Host::retune,       &Host::weigh,
                                   &Host::add_force, &Host::remove_force, &Host::push};
constexpr Host::Act of_pairs[] = {&Host::filter, &Host::part, &Host::coat, &Host::make_joint, &Host::destroy_joint};
constexpr Host::Act all_acts[] = {
    &Host::place,      &Host::push,  &Host::stop,        &Host::make,          &Host::destroy_body,
    &Host::make_joint, &Host::drive, &Host::make_spring, &Host::destroy_joint, &Host::destroy_spring,
    &Host::add_force,  &Host::weigh, &Host::coat,        &Host::remove_force,  &Host::drag,
    &Host::filter,     &Host::part,  &Host::retune,      &Host::configure,     &Host::fall_otherwise,
    &Host::keep_awake, &Host::wake,  &Host::save,        &Host::restore,
};
constexpr std::span<const Host::Act> kinds_of_calls[] = {all_acts,    all_acts,  of_state, of_structure,
                                                         of_settings, of_forces, of_pairs};

}  // namespace

void draw_host(Builder& b) {
  Host host(b);
  host.build();
  host.play(kinds_of_calls[b.dice.one_of(int(std::size(kinds_of_calls)))]);
}

}  // namespace pcphys::wild
