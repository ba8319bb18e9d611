// Pins transfers and barriers, by following in this file where every buffer's newest contents are: in all eight
// mixes of places every kernel finds what it uses, nothing is copied that is there already or that nobody
// uses, what the host reads is on the host in the end, and on GL nothing is used after it was written, or
// written after it was read, without a barrier between.
#include <map>
#include <set>

#include "plan/plan.h"
#include "support_world.h"

using namespace worldtest;

namespace {

bool scratch_of_solver(Buffer b) { return b >= Buffer::table_buffers && schema(b).reals > 0; }
std::string text_of(Buffer b) { return std::string(schema(b).name); }

struct Copy {
  std::size_t entry;  // of the transfer
  bool used = false;
};

/// Where the newest contents of a buffer are.
struct Holder {
  bool on[2] = {true, false};  // by Place; a step begins with everything on the host
  std::map<Place, Copy> copies;
};

void follow(const PlanSignature& signature, const StepPlan& plan) {
  std::map<Buffer, Holder> holders;
  std::map<Buffer, Place> homes;   // of the solver's scratch
  std::set<Buffer> written, read;  // on GL since the last barrier
  std::set<std::size_t> unused;    // transfers that nobody has used yet
  const auto here = [](Place p) { return std::size_t(p); };
  holders[Buffer::island_labels].on[1] = true;  // kernels there begin anew

  for (std::size_t i = 0; i < plan.entries.size(); i++) {
    const PlanEntry& e = plan.entries[i];
    INFO("entry " << i << ": " << std::string(kernel_name(e)) << std::string(buffer_name(e)) << " on "
                  << std::string(name(e.place)));
    CHECK(e.substep < std::max(signature.substeps, 1u));
    if (e.transfers()) {
      CHECK((e.place == Place::gl) == (e.kind == PlanEntry::Kind::upload));
      CHECK_FALSE(scratch_of_solver(e.buffer));
      if (e.kind == PlanEntry::Kind::download)
        CHECK((e.buffer < Buffer::table_buffers || e.buffer == Buffer::island_labels));
      Holder& h = holders[e.buffer];
      const Place from = e.place == Place::gl ? Place::cpu : Place::gl;
      CHECK_MESSAGE(h.on[here(from)], text_of(e.buffer) << " is copied from where it is old");
      CHECK_MESSAGE(!h.on[here(e.place)], text_of(e.buffer) << " is copied to where it is current");
      h.on[here(e.place)] = true;
      h.copies[e.place] = {i};
      unused.insert(i);
      if (e.kind == PlanEntry::Kind::download) {  // waits for everything
        CHECK(e.barrier);
        written.clear();
        read.clear();
      }
      continue;
    }

    const std::span<const Access> accessed = accesses(e);
    if (e.kind == PlanEntry::Kind::kernel) {
      const Stage of = schema(e.kernel).stage;
      CHECK(e.place == (of == Stage::islands ? Place::gl : signature.places[std::size_t(of)]));
    } else {
      CHECK(e.place == Place::cpu);
    }
    bool hazard = false;
    for (const Access& a : accessed) {
      if (scratch_of_solver(a.buffer)) {
        const auto [home, first] = homes.emplace(a.buffer, e.place);
        CHECK_MESSAGE(home->second == e.place, text_of(a.buffer) << " is used in two places");
        if (first) CHECK_MESSAGE(a.write, text_of(a.buffer) << " is read before anything was written");
      } else {
        Holder& h = holders[a.buffer];
        CHECK_MESSAGE(h.on[here(e.place)], text_of(a.buffer) << " is old where it is used");
        if (const auto copy = h.copies.find(e.place); copy != h.copies.end()) unused.erase(copy->second.entry);
      }
      if (e.place == Place::gl) hazard |= written.contains(a.buffer) || (a.write && read.contains(a.buffer));
    }
    if (e.place == Place::cpu) CHECK_FALSE(e.barrier);
    if (hazard) CHECK_MESSAGE(e.barrier, "no barrier before a use of what was written");
    if (e.barrier) {
      CHECK_MESSAGE(hazard, "a barrier that waits for nothing");
      written.clear();
      read.clear();
    }
    for (const Access& a : accessed) {
      if (e.place == Place::gl) (a.write ? written : read).insert(a.buffer);
      if (!a.write) continue;
      Holder& h = holders[a.buffer];
      h.on[0] = e.place == Place::cpu;
      h.on[1] = e.place == Place::gl;
      h.copies.clear();
    }
  }
  // the host reads state after the step
  for (const PropertySchema& p : properties()) {
    if (p.role != Role::state) continue;
    Holder& h = holders[p.buffer];
    CHECK_MESSAGE(h.on[0], std::string(p.name) << " is not on the host after the step");
    if (const auto copy = h.copies.find(Place::cpu); copy != h.copies.end()) unused.erase(copy->second.entry);
  }
  if (signature.islands) {
    CHECK_MESSAGE(holders[Buffer::island_labels].on[0], "who is in which island is not on the host after the step");
    unused.erase(holders[Buffer::island_labels].copies.at(Place::cpu).entry);
  }
  for (std::size_t i : unused)
    // what both sides write comes to the host in the end: the next step begins there
    CHECK_MESSAGE((plan.entries[i].buffer == Buffer::node_pending || plan.entries[i].buffer == Buffer::recalled),
                  "transfer " << i << " of " << std::string(buffer_name(plan.entries[i])) << " is used by nobody");
}

template <class Visit> void for_all_needs(Visit&& visit) {
  for (const Mix& mix : mixes())
    for (unsigned bits = 0; bits < 128; bits++)
      for (std::uint32_t substeps : {1u, 2u, 4u, 8u}) {
        PlanSignature s;
        s.substeps = substeps;
        s.places = mix.places;
        s.bodies = true;
        s.shapes = s.free_joints = bits & 1;
        s.free_contacts = bits & 2;
        s.restitution = bits & 4;
        s.trees = bits & 8;
        s.tree_contacts = s.trees && bits & 16;
        s.tree_joints = s.trees && bits & 32;
        s.friction = bits & 64;
        s.shapes |= s.contacts();
        INFO(mix.text() << ", trees " << s.trees << ", joints " << s.free_joints << s.tree_joints << ", contacts "
                        << s.free_contacts << s.tree_contacts << ", restitution " << s.restitution << ", sub-steps "
                        << substeps);
        visit(s);
      }
}

}  // namespace

TEST_CASE("every kernel finds current data; no copy is redundant; no hazard is without a barrier") {
  for_all_needs([](PlanSignature s) {
    follow(s, make_plan(s));
    s.islands = true;
    follow(s, make_plan(s));
  });
}

TEST_CASE("all on the cpu: no transfer, no barrier") {
  PlanSignature s;
  s.bodies = s.trees = s.free_joints = s.tree_joints = s.shapes = s.free_contacts = s.tree_contacts = s.restitution =
      true;
  for (const PlanEntry& e : make_plan(s).entries) {
    CHECK_FALSE(e.transfers());
    CHECK_FALSE(e.barrier);
  }
}

// The narrow phase is the host's: in each sub-step it reads where bodies are and how they move, and writes contacts.
TEST_CASE(
    "all on gl: but for what the narrow phase needs, each buffer goes up at most once, and comes down in the end") {
  PlanSignature s;
  s.places.fill(Place::gl);
  s.bodies = s.trees = s.free_joints = s.tree_joints = s.shapes = s.free_contacts = s.tree_contacts = s.restitution =
      true;
  constexpr std::array meets{Buffer::pose, Buffer::motion, Buffer::delta, Buffer::contact};
  std::set<Buffer> up;
  bool coming_down = false;
  for (const PlanEntry& e : make_plan(s).entries) {
    const bool narrow = e.transfers() && std::ranges::find(meets, e.buffer) != meets.end();
    if (e.kind == PlanEntry::Kind::upload && !narrow) CHECK(up.insert(e.buffer).second);
    if (e.kind == PlanEntry::Kind::download)
      coming_down |= !narrow;
    else if (!narrow && e.kind != PlanEntry::Kind::collide)
      CHECK_FALSE(coming_down);
  }
}

TEST_CASE("kernels run in the same order wherever they run") {
  for_all_needs([](const PlanSignature& s) {
    PlanSignature cpu = s;
    cpu.places.fill(Place::cpu);
    const auto order = [](const StepPlan& plan) {
      std::vector<std::pair<Kernel, Phase>> kernels;
      for (const PlanEntry& e : plan.entries)
        if (e.kind == PlanEntry::Kind::kernel) kernels.emplace_back(e.kernel, e.phase);
      return kernels;
    };
    CHECK((order(make_plan(s)) == order(make_plan(cpu))));
  });
}

TEST_CASE("the bytes of a step are those of its transfers") {
  require_gl();
  for (const Mix& mix : mixes()) {
    INFO(mix.text());
    SceneWorld s = scene_world("ragdolls", 1);
    Stepper stepper(mix.settings());
    run(s.world, stepper, 1);
    const bool transfers = std::any_of(stepper.plan().entries.begin(), stepper.plan().entries.end(),
                                       [](const PlanEntry& e) { return e.transfers(); });
    const bool mixed_or_gl = std::any_of(mix.places.begin(), mix.places.end(), [](Place p) { return p == Place::gl; });
    const StepReport& report = stepper.step(s.world, frame);
    CHECK((report.transfer_bytes > 0) == transfers);
    if (!mixed_or_gl) CHECK_FALSE(transfers);
  }
}
