// Pins sub-step classes of a step in which nobody moves though some had asked for more: the class is octave 0, not
// none. (A try of a step that asked for more sub-steps, and the bodies frozen since: the number of sub-steps was
// shifted by 2^32 - 1.)
#include <doctest/doctest.h>

#include "plan/octaves.h"
#include "step/schedule.h"
#include "support_world.h"

using namespace worldtest;

TEST_CASE("octaves: where nobody moves all is of octave 0") {
  World world(WorldDef{.gravity = {}});
  const std::vector<BodyId> links = add_chain(world, {0, 0, 0}, 3, true, {});
  WorldState& state = world.state();
  Schedule schedule;
  Octaves octaves;
  const auto choose = [&] {
    schedule.update_structure(state);
    const TreeSlots& trees = schedule.trees;
    octaves.update_structure(state, trees.solved(), trees.closing(), trees.parallel());
    (void)octaves.choose(state, trees.forest(), trees.nodes(), false, {}, false, {}, frame);
    return octaves.used();
  };
  octaves.begin();
  CHECK(choose() == 1);
  for (const BodyId link : links) must(world.set_angular_velocity(link, {300, 0, 0}));
  REQUIRE(octaves.find_tighter(state, schedule.trees.forest(), nullptr));
  CHECK(choose() > 1);
  for (const BodyId link : links) state.freeze(must(world.row_of(link)));
  CHECK(choose() == 1);
}
