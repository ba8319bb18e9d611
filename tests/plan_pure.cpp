// Pins the plan as data: a pure function of what a world holds and of the settings, with a name and a reason
// for all that is left out, kept from step to step, and printed whole.
#include "pcphys/constants.h"
#include "plan/plan.h"
#include "support_world.h"

using namespace worldtest;

namespace {

/// Every signature there is, for two numbers of sub-steps.
template <class Visit> void for_all_signatures(Visit&& visit) {
  for (const Mix& mix : mixes())
    for (unsigned bits = 0; bits < 2048; bits++)
      for (std::uint32_t substeps : {1u, 4u}) {
        PlanSignature s;
        s.substeps = substeps;
        s.places = mix.places;
        s.bodies = bits & 1;
        s.free_joints = bits & 2;
        s.shapes = bits & 4;
        s.free_contacts = bits & 8;
        s.restitution = bits & 16;
        s.drag = bits & 32;
        s.gyroscopic = bits & 64;
        s.trees = bits & 128;
        s.tree_contacts = s.trees && bits & 256;
        s.tree_joints = s.trees && bits & 512;
        s.friction = bits & 1024;
        s.sleep = bits & 3;
        s.body_events = bits & 5;
        s.contact_events = bits & 9;
        s.touches = s.contact_events && s.contacts();
        visit(s);
      }
}

std::string reason(const StepPlan& plan, std::string_view what) {
  for (const LeftOut& l : plan.left_out)
    if (l.what == what) return l.why;
  return "";
}

}  // namespace

TEST_CASE("the plan is a pure function of its signature") {
  for_all_signatures([](const PlanSignature& s) {
    const StepPlan a = make_plan(s), b = make_plan(s);
    CHECK(a == b);
    CHECK(a.substeps == s.substeps);
  });
}

TEST_CASE("equal worlds have equal plans, whatever was stepped before") {
  for (const char* name : {"balls", "ragdolls", "chain", "door"}) {
    const SceneWorld a = scene_world(name, 2);
    SceneWorld b = scene_world(name, 2), other = scene_world("stack", 3);
    Stepper fresh, used;
    run(other.world, used, 3);
    const StepPlan planned = must(fresh.plan_for(a.world, frame));
    CHECK(planned == must(used.plan_for(b.world, frame)));
    CHECK(must(used.plan_for(b.world, frame)) == must(used.plan_for(b.world, frame)));
    const auto before = fingerprint(b.world);
    (void)must(used.plan_for(b.world, frame));
    CHECK((fingerprint(b.world) == before));
  }
}

TEST_CASE("plan_for asks the world, not what was stepped before, for trees and loops") {
  const SceneWorld chain = scene_world("chain", 2), stack = scene_world("stack", 3), door = scene_world("door", 1);
  SceneWorld stepped_chain = scene_world("chain", 2);
  Stepper fresh, used;
  run(stepped_chain.world, used, 1);
  for (Stepper* stepper : {&fresh, &used}) {
    CHECK(runs(must(stepper->plan_for(chain.world, frame)), "tree_solve") == 4);
    CHECK(runs(must(stepper->plan_for(chain.world, frame)), "joint_solve") == 0);
    CHECK(runs(must(stepper->plan_for(stack.world, frame)), "tree_solve") == 0);
    CHECK(reason(must(stepper->plan_for(stack.world, frame)), "joints") == "the world has no joints");
    CHECK(runs(must(stepper->plan_for(door.world, frame)), "joint_solve") == 0);  // its pins are one hinge
  }
}

TEST_CASE("plan_for refuses what a step would") {
  World world;
  Stepper stepper;
  CHECK_REFUSED(world, stepper.plan_for(world, 0), ErrorCode::bad_time_step, "The time step is 0.000000 s");
  StepSettings none;
  none.substeps = 0;
  Stepper bad(none);
  CHECK_REFUSED(world, bad.plan_for(world, frame), ErrorCode::bad_time_step, "The number of sub-steps is 0");
}

TEST_CASE("left out: nothing that moves") {
  World world;
  (void)must(world.create_body(fixed_box({}, {1, 1, 1})));
  Stepper stepper;
  run(world, stepper, 1);
  CHECK(stepper.plan().entries.empty());
  CHECK(reason(stepper.plan(), "integrate") == "no body moves");
  CHECK(reason(stepper.plan(), "joints") == "the world has no joints");
  CHECK(reason(stepper.plan(), "collision") == "no two shapes could ever touch");
  CHECK(reason(stepper.plan(), "impulses") == "no two shapes could ever touch");
}

TEST_CASE("left out: no joints, nothing touching, and what comes when they do") {
  World world;
  (void)must(world.create_body(fixed_box({0, -0.5, 0}, {5, 0.5, 5})));
  const BodyId body = must(world.create_body(ball({0, 1, 0})));
  Stepper stepper;
  run(world, stepper, 1);
  CHECK(reason(stepper.plan(), "integrate") == "");
  CHECK(reason(stepper.plan(), "joints") == "the world has no joints");
  CHECK(reason(stepper.plan(), "collision") == "");
  CHECK(reason(stepper.plan(), "impulses") == "nothing touches in this step");
  CHECK(stepper.plan().flight);
  CHECK(stepper.plan().entries.size() == 1);
  CHECK(runs(stepper.plan(), "fly_round") == 1);
  must(world.set_pose(body, {{0, 0.5, 0}, {}}));
  run(world, stepper, 1);
  CHECK(reason(stepper.plan(), "impulses") == "");
  CHECK(runs(stepper.plan(), "integrate") == 4);
  CHECK(reason(stepper.plan(), "restitution") == "no contact has a restitution above zero");
  CHECK(runs(stepper.plan(), "contact_solve") == 8);
  CHECK(std::ranges::count(stepper.plan().entries, PlanEntry::Kind::collide, &PlanEntry::kind) == 4);
  CHECK(runs(stepper.plan(), "contact_prepare") == 4);
  CHECK(runs(stepper.plan(), "contact_store") == 1);
  CHECK(runs(stepper.plan(), "contact_restitution") == 0);
  CHECK(runs(stepper.plan(), "joint_solve") == 0);
  CHECK(runs(stepper.plan(), "tree_solve") == 0);
  must(world.set_material(body, {0.5, 0.5, 0.5}));
  run(world, stepper, 1);
  CHECK(reason(stepper.plan(), "restitution") == "");
  CHECK(runs(stepper.plan(), "contact_restitution") == 1);
  JointDef joint;
  joint.a = world.ground();
  joint.b = body;
  joint.frame_a.position = {0, 0.5, 0};
  (void)must(world.create_joint(joint));
  run(world, stepper, 1);
  CHECK(reason(stepper.plan(), "joints") == "");
  CHECK(reason(stepper.plan(), "joint rows") == "no joint closes a loop");
  CHECK(runs(stepper.plan(), "tree_solve") == 4);
  CHECK(runs(stepper.plan(), "joint_prepare") == 0);
  joint.frame_a.position = {0.1, 0.5, 0};  // a second hold on the same body, which is no pin, elsewhere: a loop
  joint.frame_b.position = {0.1, 0, 0};
  joint.freedom = AngleFreedom::cone_and_twist(1, 1);
  (void)must(world.create_joint(joint));
  run(world, stepper, 1);
  CHECK(reason(stepper.plan(), "joint rows") == "");
  CHECK(runs(stepper.plan(), "tree_solve") == 4);
  CHECK(runs(stepper.plan(), "joint_prepare") == 4);
  CHECK(runs(stepper.plan(), "joint_solve") == 8);
}

TEST_CASE("left out: drag and gyroscopic terms, until a body needs them") {
  World world;
  const BodyId body = must(world.create_body(ball({})));
  Stepper stepper;
  run(world, stepper, 1);
  CHECK(reason(stepper.plan(), "drag") == "no body has any");
  CHECK(reason(stepper.plan(), "gyroscopic terms") == "every body has three equal moments of inertia");
  must(world.set_drag(body, 0, 0.1));
  run(world, stepper, 1);
  CHECK(reason(stepper.plan(), "drag") == "");
  must(world.set_mass_properties(body, {1, {1, 1, 1.5}}));
  run(world, stepper, 1);
  CHECK(reason(stepper.plan(), "gyroscopic terms") == "");
}

TEST_CASE("left out: shapes that could never touch") {
  const auto plan_of = [](auto&& build) {
    World world;
    build(world);
    Stepper stepper;
    run(world, stepper, 1);
    return stepper.plan();
  };
  CHECK(reason(plan_of([](World& w) { (void)must(w.create_body(ball({}))); }), "collision") ==
        "no two shapes could ever touch");
  CHECK(reason(plan_of([](World& w) {
                 BodyDef def;
                 def.mass = 1;
                 def.moments = Vec3{1, 1, 1};
                 for (int i = 0; i < 3; i++) (void)must(w.create_body(def));
               }),
               "collision") == "no two shapes could ever touch");
  CHECK(reason(plan_of([](World& w) {
                 for (int i = 0; i < 3; i++) must(w.set_filter(must(w.create_body(ball({}))), {1, 0, 0}));
               }),
               "collision") == "no two shapes could ever touch");
  CHECK(reason(plan_of([](World& w) {
                 (void)must(w.create_body(ball({})));
                 (void)must(w.create_body(ball({5, 0, 0})));
               }),
               "collision") == "");
}

TEST_CASE("the original's scheme takes other kernels, and says what it lacks") {
  for_all_signatures([](PlanSignature s) {
    s.integrator = Integrator::seed;
    const StepPlan plan = make_plan(s);
    const int n = s.bodies ? int(s.substeps) : 0;
    CHECK(runs(plan, "begin_seed") == (s.bodies ? 1 : 0));
    CHECK(runs(plan, s.drag ? "integrate_seed" : "integrate") == n);
    CHECK(runs(plan, s.gyroscopic ? "advance_seed" : "advance_round") == n);
    CHECK(runs(plan, "remember") + runs(plan, "synchronise") + runs(plan, "synchronise_drag") == 0);
    if (s.bodies) CHECK(reason(plan, "gyroscopic terms") != "");
  });
}

TEST_CASE("left out names have a reason, a sentence a reader can use") {
  for_all_signatures([](const PlanSignature& s) {
    const StepPlan plan = make_plan(s);
    CHECK((reason(plan, "integrate") != "") == !s.bodies);
    CHECK((reason(plan, "joints") != "") == (!s.joints() && !s.trees));
    CHECK((reason(plan, "joint rows") != "") == (!s.joints() && s.trees));
    CHECK((reason(plan, "collision") != "") == !s.shapes);
    CHECK((reason(plan, "impulses") != "") == !s.contacts());
    CHECK((reason(plan, "restitution") != "") == (s.contacts() && !s.restitution));
    CHECK((reason(plan, "drag") != "") == (s.bodies && !s.drag));
    CHECK((reason(plan, "sleeping") != "") == !s.sleep);
    CHECK((reason(plan, "events of contacts") != "") == !s.touches);
    CHECK((reason(plan, "events of bodies") != "") == !s.body_events);
    CHECK(reason(plan, "kernels of the host's own") == "none was added");
    CHECK((reason(plan, "gyroscopic terms") != "") == (s.bodies && !s.gyroscopic));
    if (s.bodies && !plan.flight) CHECK(runs(plan, s.drag ? "integrate_drag" : "integrate") == int(s.substeps));
    if (s.bodies && !plan.flight) CHECK(runs(plan, s.gyroscopic ? "advance" : "advance_round") == int(s.substeps));
    CHECK(runs(plan, "joint_prepare") == (s.bodies && s.joints() ? int(s.substeps) : 0));
    CHECK(runs(plan, "joint_warm") == (s.bodies && s.free_joints ? int(s.substeps) : 0));
    CHECK(runs(plan, "joint_solve") == (s.bodies && s.free_joints ? 2 * int(s.substeps) : 0));
    for (const char* kernel : {"tree_joint_warm", "tree_joint_mass", "tree_joint_arms"})
      CHECK(runs(plan, kernel) == (s.bodies && s.tree_joints ? int(s.substeps) : 0));
    CHECK(runs(plan, "tree_joint_solve") == (s.bodies && s.tree_joints ? 2 * int(s.substeps) : 0));
    for (const char* kernel : {"tree_prepare", "tree_solve", "tree_again", "tree_relax"})
      CHECK(runs(plan, kernel) == (s.bodies && s.trees ? int(s.substeps) : 0));
    if (!s.contacts()) CHECK(runs(plan, "contact_prepare") + runs(plan, "contact_store") == 0);
    CHECK((reason(plan, "friction") != "") == s.frictionless());
    for (const std::string kernel : {"contact_warm", "contact_solve"}) {
      CHECK((runs(plan, kernel) > 0) == (s.bodies && s.free_contacts && !s.frictionless()));
      CHECK((runs(plan, kernel + "_frictionless") > 0) == (s.bodies && s.frictionless()));
    }
    CHECK(runs(plan, s.frictionless() ? "contact_refresh_frictionless" : "contact_refresh") ==
          (s.bodies && s.free_contacts && s.gyroscopic ? 2 * int(s.substeps) : 0));
    const int on_limbs = s.bodies && s.tree_contacts ? int(s.substeps) : 0;
    CHECK(runs(plan, "tree_contact_warm") == on_limbs);
    CHECK(runs(plan, "tree_contact_prepare") == 2 * on_limbs);
    CHECK(runs(plan, "tree_contact_solve") == 3 * on_limbs);
    const bool on_trees = s.bodies && (s.tree_contacts || s.tree_joints);
    for (const char* kernel : {"tree_collect", "tree_respond"})
      CHECK(runs(plan, kernel) == (on_trees ? int(s.substeps) : 0));
    CHECK(runs(plan, "tree_flush") == (on_trees ? (s.tree_contacts ? 4 : 2) * int(s.substeps) : 0));
    CHECK(runs(plan, "push_back") == (s.bodies && s.tree_contacts ? int(s.substeps) + 1 : 0));
    if (!s.bodies) CHECK(plan.entries.empty());
  });
}

TEST_CASE("the plan is kept: repeated steps run the same one") {
  SceneWorld s = scene_world("stack", 3);
  Stepper stepper;
  run(s.world, stepper, constants::rounds);
  const StepPlan* first = &stepper.plan();
  const StepPlan copy = *first;
  for (int i = 0; i < 20; i++) {
    run(s.world, stepper, 1);
    CHECK(&stepper.plan() == first);
  }
  CHECK(stepper.plan() == copy);
  // another signature, and back: equal again
  StepSettings more = stepper.settings();
  more.substeps = 2;
  must(stepper.configure(more));
  run(s.world, stepper, 1);
  CHECK(stepper.plan().substeps == 2);
  more.substeps = 4;
  must(stepper.configure(more));
  run(s.world, stepper, 1);
  CHECK(stepper.plan() == copy);
}

TEST_CASE("before the first step there is no plan") {
  const Stepper stepper;
  CHECK(stepper.plan() == StepPlan{});
}

TEST_CASE("the plan as text: a line an entry, each with its names, and what was left out") {
  for_all_signatures([](const PlanSignature& s) {
    const StepPlan plan = make_plan(s);
    std::vector<std::string> lines;
    std::string text = to_text(plan);
    CHECK(text.back() == '\n');
    for (std::size_t at = 0, end; (end = text.find('\n', at)) != std::string::npos; at = end + 1)
      lines.push_back(text.substr(at, end - at));
    REQUIRE(lines.size() == 2 + plan.entries.size() + plan.left_out.size());
    CHECK(lines[0] == "sub-steps " + std::to_string(s.substeps));
    const auto holds = [](const std::string& line, std::string_view word) {
      return line.find(word) != std::string::npos;
    };
    for (std::size_t i = 0; i < plan.entries.size(); i++) {
      const PlanEntry& e = plan.entries[i];
      const std::string& line = lines[i + 2];
      bool all =
          holds(line, name(e.place)) && holds(line, stage_name(e)) && line.starts_with(std::to_string(e.substep));
      if (!e.transfers()) {
        all &= holds(line, kernel_name(e)) && holds(line, phase_name(e));
        for (const auto& list : {reads(e), writes(e)})
          for (std::string_view buffer : list) all &= holds(line, buffer);
      } else {
        all &= holds(line, e.kind == PlanEntry::Kind::upload ? "upload " : "download ") && holds(line, buffer_name(e));
      }
      all &= line.ends_with("  B") == e.barrier;
      CHECK_MESSAGE(all, line);
    }
    for (std::size_t i = 0; i < plan.left_out.size(); i++)
      CHECK(lines[2 + plan.entries.size() + i] ==
            "left out: " + plan.left_out[i].what + ", since " + plan.left_out[i].why);
  });
}

TEST_CASE("names of places") {
  CHECK(std::string(name(Place::cpu)) == "cpu");
  CHECK(std::string(name(Place::gl)) == "gl");
}
