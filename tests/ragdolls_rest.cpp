// Pins how a heap of ragdolls comes to rest: by the damping of its joints within seconds, by drag, and, where joints
// turn freely and nothing drags, slowly if at all: single limbs swing on for long. Its energy is not monotone, since
// what limits and overlaps hold as springs is not in the sum, but never rises by more than a ten-thousandth or two of
// what there is (docs/joint-trees.md).
#include <algorithm>
#include <limits>

#include "support_world.h"

using namespace worldtest;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int second = 60;  // steps

struct Rest {
  double at_5 = 0;            // energy at 5 s
  double highest = 0;         // after that
  double rise = 0, late = 0;  // most that it stood above the least before, from 5 s and from 15 s on
  double moving[3] = {};      // kinetic energy at 5, 10 and 20 s
  double potential = 0;       // at the end; zero at the floor [J], all of these
};

enum class Calmed { by_joints, by_drag, by_nothing };

Rest come_to_rest(Precision precision, int count, std::uint64_t seed, Calmed calmed) {
  const double drag = calmed == Calmed::by_drag ? 0.5 : 0;
  World world({precision});
  scenes::SceneOptions options;
  options.count = count;
  options.seed = seed;
  if (calmed != Calmed::by_joints) options.joint_damping = 0;
  must(scenes::make("ragdolls", options, world));
  for (const BodyId body : world.bodies())
    if (drag > 0 && must(world.mass_properties(body)).mass > 0) must(world.set_drag(body, drag, drag));
  Stepper stepper;
  run(world, stepper, 5 * second);
  const auto energy = [&] { return world.kinetic_energy() + world.potential_energy(); };
  Rest rest;
  rest.at_5 = rest.highest = energy();
  rest.moving[0] = world.kinetic_energy();
  double least = rest.at_5, least_late = infinity;
  for (int i = 5 * second + 1; i <= 20 * second; i++) {
    run(world, stepper, 1);
    const double now = energy();
    least = std::min(least, now);
    if (i > 15 * second) least_late = std::min(least_late, now);
    rest.highest = std::max(rest.highest, now);
    rest.rise = std::max(rest.rise, now - least);
    rest.late = std::max(rest.late, now - least_late);
    if (i == 10 * second) rest.moving[1] = world.kinetic_energy();
  }
  rest.moving[2] = world.kinetic_energy();
  rest.potential = world.potential_energy();
  return rest;
}

Rest tell(Precision precision, int count, std::uint64_t seed, Calmed calmed) {
  const Rest r = come_to_rest(precision, count, seed, calmed);
  MESSAGE(count << " ragdolls, " << std::string(precision == Precision::f32 ? "single" : "double") << ", seed " << seed
                << std::string(calmed == Calmed::by_joints ? ""
                               : calmed == Calmed::by_drag ? ", free joints, drag 0.5"
                                                           : ", free joints")
                << ": kinetic energy at 5, 10, 20 s " << r.moving[0] << ", " << r.moving[1] << ", " << r.moving[2]
                << " J; energy rose again by " << r.rise << " J from 5 s on, by " << r.late
                << " J from 15 s on, above that at 5 s by " << r.highest - r.at_5 << " J, of " << r.potential << " J");
  return r;
}

}  // namespace

// What still falls after 5 s is thrown back by limits and overlaps, which hold energy that is not in the sum: of 150
// heaps with free joints (seeds 101 to 175, with drag and without) 9 by more than 2.5e-4 and 2 by more than 2e-3 of
// what there is, at most 2.8e-3; when contacts were found once a step 4 and 1.
TEST_CASE("ragdolls at rest: of 8 energy rises by no more than 2.5e-4 but in few heaps, and they come to rest") {
  int heaps = 0, thrown_back = 0, thrown_far = 0;
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6})
      for (const Calmed calmed : {Calmed::by_joints, Calmed::by_drag, Calmed::by_nothing}) {
        CAPTURE(seed);
        CAPTURE(int(calmed));
        const Rest r = tell(precision, 8, seed, calmed);
        heaps++;
        if (r.rise > 2.5e-4 * r.potential) thrown_back++;
        if (r.rise > 2e-3 * r.potential) thrown_far++;
        CHECK(r.rise <= 5e-3 * r.potential);
        CHECK(r.moving[2] <= (calmed == Calmed::by_joints ? 0.005
                              : calmed == Calmed::by_drag ? 0.05
                                                          : 1.5));  // of 96 seeds with free joints at most 1.3
      }
  CHECK(thrown_back <= heaps / 9);
  CHECK(thrown_far <= 1);
}

// (Of 16 heaps with damped joints, seeds 1 to 16, an arm slips in one, so that more moves after 20 s than after 10; in
// another version in two.)
TEST_CASE("ragdolls at rest: 100") {
  int thrown_back = 0, slipped = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4})
    for (const Calmed calmed : {Calmed::by_joints, Calmed::by_nothing}) {
      if (seed > 2 && calmed == Calmed::by_nothing) continue;
      const Rest r = tell(Precision::f32, 100, seed, calmed);
      if (r.rise > 1.5e-4 * r.potential) thrown_back++;
      CHECK(r.rise <= 2.5e-4 * r.potential);
      if (calmed == Calmed::by_joints) {
        CHECK(r.moving[1] < r.moving[0]);
        if (!(r.moving[2] < std::max(r.moving[1], 1e-3))) slipped++;  // less than that is at rest: 0.5 mm/s of each
        CHECK(r.moving[2] <= 0.02);
      } else {
        CHECK(r.moving[2] <= 4);  // pendulums without friction; of 12 seeds 0.7 to 3.6 and one of 8.4
      }
    }
  CHECK(thrown_back <= 1);  // what still falls after 5 s, as above
  CHECK(slipped <= 1);
}
