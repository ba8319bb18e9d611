// Pins the bytes that a plan names: those of each transfer are the buffer's in that world, their sum is what a first
// step then moves, and a kernel of the host's own that has only one side shows what it costs to leave the others'
// place.
#include <algorithm>

#include "pcphys/write_kernel.h"
#include "plan/plan.h"
#include "support_world.h"
#include "world/state.h"

using namespace worldtest;

namespace {

/// Makes a kick by a library function, so that it has no text for a GPU.
PCPHYS_CPU_KERNEL(kick, (PC_IN(Vec3) position, PC_INOUT(Vec3) force),
                  { force.y = force.y + std::max(position.y, Real(0)); })

std::vector<const PlanEntry*> transfers(const StepPlan& plan, PlanEntry::Kind kind, std::string_view buffer) {
  std::vector<const PlanEntry*> found;
  for (const PlanEntry& e : plan.entries)
    if (e.kind == kind && buffer_name(e) == buffer) found.push_back(&e);
  return found;
}

/// Until contacts stay the same for a while; how many they are.
std::uint32_t come_to_rest(World& world, Stepper& stepper) {
  std::uint32_t contacts = 0;
  for (int steps = 0, same = 0; steps < 1200 && same < 60; steps++) {
    const std::uint32_t now = stepper.step(world, frame).contacts;
    same = now == contacts ? same + 1 : 0;
    contacts = now;
  }
  return contacts;
}

}  // namespace

TEST_CASE("what the plan of a world says that a step moves, a first step moves") {
  require_gl();
  for (const char* name : {"stack", "chain", "dominoes", "ragdolls"})
    for (const Precision precision : {Precision::f32, Precision::f64})
      for (const Mix& mix : mixes()) {
        INFO(std::string(name) << ", " << mix.text());
        SceneWorld s = scene_world(name, 2, precision);
        Stepper before;
        const std::uint32_t contacts = come_to_rest(s.world, before);
        StepSettings settings = mix.settings();
        settings.refinement = 1;
        Stepper fresh(settings);
        const StepPlan plan = must(fresh.plan_for(s.world, frame));
        const TransferBytes all = transfer_bytes(plan);
        const StepReport& report = fresh.step(s.world, frame);
        REQUIRE_MESSAGE(bool(report), report.error.message);
        REQUIRE(report.contacts == contacts);
        const std::uint64_t down = report.transfer_bytes - report.upload_bytes;
        // what could come and does not: contacts without trees, and impacts, whose bodies would have to go up once more
        const bool foreseen =
            std::string_view(name) == "ragdolls" || (mix.places[0] == Place::gl && mix.places[2] == Place::cpu);
        if (foreseen) {
          CHECK(report.upload_bytes <= all.up);
          CHECK(down <= all.down);
        } else {
          CHECK(report.upload_bytes == all.up);
          CHECK(down == all.down);
        }
        const bool some = std::ranges::any_of(plan.entries, [](const PlanEntry& e) { return e.transfers(); });
        CHECK((all.up + all.down > 0) == some);
        const std::string sums = "transfers: up to " + std::to_string(all.up) + " bytes to the device";
        CHECK((to_text(plan).find(sums) != std::string::npos) == some);
        CHECK(some == std::ranges::any_of(plan.bindings, [](const PlanBinding& b) { return b.place == Place::gl; }));
      }
}

TEST_CASE("bytes grow with the world, by its rows") {
  StepSettings settings;
  settings.set_all(Place::gl);
  for (const int count : {10, 1000}) {
    SceneWorld s = scene_world("ballistic", count);
    Stepper stepper(settings);
    const StepPlan plan = must(stepper.plan_for(s.world, frame));
    const auto poses = transfers(plan, PlanEntry::Kind::download, "pose");
    REQUIRE(poses.size() == 1);
    const Tables& tables = s.world.state().tables;
    CHECK(poses[0]->bytes == tables.row_bytes(Buffer::pose) * (s.world.body_count() + 1));  // and the ground
    CHECK(to_text(plan).find("download pose, " + std::to_string(poses[0]->bytes) + " bytes") != std::string::npos);
  }
}

TEST_CASE("a kernel with a C++ side alone runs there, and the plan shows the transfers and their bytes") {
  require_gl();
  StepSettings settings;
  settings.set_all(Place::gl);
  SceneWorld s = scene_world("balls", 20);
  Stepper with(settings), without(settings);
  const StepPlan plain = must(without.plan_for(s.world, frame));
  must(with.add_kernel(s.world, {.text = kick::text()}));
  const StepPlan plan = must(with.plan_for(s.world, frame));
  const auto kernel = std::ranges::find_if(plan.entries, [](const PlanEntry& e) { return kernel_name(e) == "kick"; });
  REQUIRE(kernel != plan.entries.end());
  CHECK(kernel->place == Place::cpu);
  // positions come down for it in each sub-step but the first, and the force goes up after it
  const std::size_t rows = s.world.body_count() + 1;
  const Tables& tables = s.world.state().tables;
  const auto down = transfers(plan, PlanEntry::Kind::download, "pose"),
             up = transfers(plan, PlanEntry::Kind::upload, "force");
  CHECK(down.size() == settings.substeps);    // the last for the host
  CHECK(up.size() == settings.substeps + 1);  // before the first it goes up for what the library adds
  for (const PlanEntry* e : down) CHECK(e->bytes == rows * tables.row_bytes(Buffer::pose));
  for (const PlanEntry* e : up) CHECK(e->bytes == rows * tables.row_bytes(Buffer::force));
  CHECK(transfer_bytes(plan).down > transfer_bytes(plain).down);
  CHECK(to_text(plan).find("upload force, " + std::to_string(up[0]->bytes) + " bytes") != std::string::npos);
  const StepReport& report = with.step(s.world, frame);
  REQUIRE_MESSAGE(bool(report), report.error.message);
  CHECK(report.upload_bytes <= transfer_bytes(plan).up);
}
