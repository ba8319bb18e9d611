// The scenes that all designs are measured with, what a step of them runs, and the two histories of a heap.
#pragma once
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "design.h"

namespace pcphys::architectures {

/// flight: free bodies with drag. chains: of ten links that hang from the ground, with cones and twists. pairs: two
/// balls that forces press together. wind, ropes: what was added to the designs; flight in wind, and the same of bodies
/// on a rope two by two.
enum class SceneKind : std::uint8_t { flight, chains, pairs, wind, ropes };
inline constexpr SceneKind measured_scenes[] = {SceneKind::flight, SceneKind::chains, SceneKind::pairs};
std::string_view name(SceneKind kind);

/// fresh: objects made in order, in a heap and in tables without holes. churned: as late in a game; as many other
/// bodies were there before, and came and went while those of the scene were made, in random order.
enum class History : std::uint8_t { fresh, churned };
std::string_view name(History history);

/// Body `i` of the scene of free flight.
BodyInit flying_body(std::size_t i);
/// Makes `count` bodies, rounded down to whole chains or pairs; answers their handles,
/// in the same order for every history.
std::vector<Handle> build(SceneKind kind, std::size_t count, History history, Design& design);

using StageTimes = std::array<double, stage_count>;  // [s]

using Clock = double (*)();  // [s]
double wall_time();
/// Of this thread: what else the machine does is not in it. It costs more to read, so it is for long steps.
double processor_time();

/// Steps of one sub-step of 1/240 s, as the plan of such a world has them.
class Steps {
 public:
  explicit Steps(Clock clock = wall_time);
  /// `times`, if given, grows by what each stage takes.
  void step(SceneKind kind, Design& design, StageTimes* times = nullptr) const;

 private:
  Clock clock_;
  InfoOf<float> infos_[phase_count];
};
inline constexpr double substep = 1.0 / 240;          // [s]
inline constexpr float wind_velocity[3] = {5, 0, 1};  // [m/s]

}  // namespace pcphys::architectures
