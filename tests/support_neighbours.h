// What the tests of bad input share: neighbours that must not notice, and what they are told bit for bit.
#pragma once
#include <cstring>
#include <vector>

#include "support_physics.h"

namespace physics {

inline constexpr double frame = 1.0 / 60;  // [s]

/// A floor, a stack of two boxes, a rolling ball and two pinned bodies: neighbours that must not notice.
struct Neighbours {
  Run run;
  std::vector<BodyId> bodies;
  JointId joint;
  std::size_t count = 0;

  explicit Neighbours(const Mode& mode) : run(mode, {0, -gravity, 0}, 4) {
    BodyDef floor;
    floor.kind = BodyKind::fixed;
    floor.shapes = {ShapeDef::plane()};
    add(floor);
    BodyDef def;
    def.shapes = {ShapeDef::box({0.5, 0.25, 0.5})};
    for (double y : {0.25, 0.75}) {
      def.pose.position = {0, y, 0};
      add(def);
    }
    def.shapes = {ShapeDef::sphere(0.3)};
    def.pose.position = {3, 0.3, 0};
    def.velocity = {1, 0, 0};
    add(def);
    def.velocity = {};
    def.shapes = {ShapeDef::capsule(0.1, 0.3)};
    def.pose.position = {-3, 3, 0};
    add(def);
    def.pose.position = {-3, 2, 0};
    add(def);
    JointDef pin;
    pin.a = bodies[4];
    pin.b = bodies[5];
    pin.frame_a.position = {0, -0.5, 0};
    pin.frame_b.position = {0, 0.5, 0};
    joint = *run.world.create_joint(pin);
    run.step(frame, 5);
    count = bodies.size();
  }
  void add(const BodyDef& def) { bodies.push_back(run.add(def)); }
  World& world() { return run.world; }

  /// All stored state of the neighbours, bit for bit.
  std::vector<double> state() const {
    std::vector<double> out;
    for (const char* name :
         {"displacement_rate", "angular_momentum", "phase", "position", "orientation", "position_low",
          "orientation_low", "velocity_half_change", "momentum_half_change", "velocity_low", "momentum_low"}) {
      const PropertyView view = *run.world.view(name);
      for (std::size_t i = 0; i < count; i++)
        for (std::uint32_t c = 0; c < view.components; c++) out.push_back(view.at(*run.world.row_of(bodies[i]), c));
    }
    return out;
  }
};

inline bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

/// What a world was told that never heard of the bad input.
inline std::vector<double> untouched(const Mode& mode, long steps) {
  Neighbours n(mode);
  n.run.step(frame, steps);
  return n.state();
}

template <class R> ErrorCode code(const R& result) { return result ? ErrorCode::none : result.error().code; }
template <class R> bool has_sentence(const R& result) {
  return !result && result.error().message.size() > 20 && result.error().message.back() == '.';
}

/// One that is as it should be.
inline BodyDef good_body() {
  BodyDef def;
  def.shapes = {ShapeDef::box({0.2, 0.2, 0.2})};
  def.pose.position = {0, 5, 4};
  return def;
}

}  // namespace physics
