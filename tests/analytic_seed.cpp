// Pins the compatibility mode `Integrator::seed`: the original document's recurrence to rounding, its first-order
// error, what it does where 1 - h F would turn a velocity round, and equal bits wherever it runs.
#include "support_cases.h"
#include "support_world.h"

using namespace physics;

namespace {

const Vec3 start_velocity{3, -2, 8}, down{0, 0, -gravity};

struct SeedRun : Run {
  explicit SeedRun(const Mode& mode, Vec3 gravity_ = {}) : Run(mode, gravity_) {
    StepSettings settings = stepper.settings();
    settings.integrator = Integrator::seed;
    REQUIRE(stepper.configure(settings));
  }
};

BodyDef thrown_body(double drag) {
  BodyDef def = free_body(1, {0.1, 0.2, 0.25}, start_velocity);
  def.linear_drag = def.angular_drag = drag;
  return def;
}

}  // namespace

TEST_CASE("A1a: the recurrence of the original over 6000 steps, at any dt F") {
  for (const Mode& mode : precisions()) check_rows(rows_of("A1", mode, {}, "seed"));
}

TEST_CASE("A1a: the factor 1 - dt F is first order: off by -F^2 dt t / 2") {
  for (double drag : {0.25, 1.0})
    for (double dt : {1.0 / 60, 1.0 / 240, 1.0 / 1200}) {
      SeedRun run({Precision::f64});
      const BodyId id = run.add(thrown_body(drag));
      run.step(dt, std::lround(1 / dt));
      const double error = run.world.velocity(id)->x / (3 * std::exp(-drag)) - 1;
      CHECK(error == doctest::Approx(-drag * drag * dt / 2).epsilon(0.02));
    }
}

TEST_CASE("A1a: where dt F is 1 or more nothing grows: the velocity is what the forces of one step give") {
  for (const Mode& mode : everywhere())
    for (double drag : {60.0, 130.0, 1e4}) {
      CAPTURE(mode.name());
      SeedRun run(mode, down);
      BodyDef def = thrown_body(drag);
      def.angular_velocity = {1, 2, 3};
      const BodyId id = run.add(def);
      run.step(1.0 / 60, 3);
      CHECK(length(*run.world.velocity(id) - (1.0 / 60) * down) <= (mode.is_double() ? 1e-14 : 1e-6));
      CHECK(length(*run.world.angular_velocity(id)) <= (mode.is_double() ? 1e-14 : 1e-5));
    }
}

TEST_CASE("seed: p - p_last goes on as it is, whatever the step; a new force acts whole in the next step") {
  for (const Mode& mode : everywhere()) {
    CAPTURE(mode.name());
    const double tolerance = mode.is_double() ? 1e-13 : 1e-5;
    SeedRun run(mode);
    const BodyId id = run.add(thrown_body(0));
    run.step(1.0 / 60, 5);
    Vec3 p = run.position(id);
    run.step(1.0 / 240);
    CHECK(length(run.position(id) - p - (1.0 / 60) * start_velocity) <= tolerance);  // four times as fast
    p = run.position(id);
    REQUIRE(run.world.set_gravity(down));
    run.step(1.0 / 240);
    CHECK(length(run.position(id) - p - (1.0 / 60) * start_velocity - (1.0 / 240 / 240) * down) <= tolerance);
    CHECK(length(*run.world.velocity(id) - 240 * (run.position(id) - p)) <= 240 * tolerance);
  }
}

TEST_CASE("seed: the same hash in every lane width and on GL, with contacts, joints, drag and unequal moments") {
  worldtest::require_gl();
  for (const char* scene : {"balls", "ragdolls", "dominoes"})
    for (Precision precision : {Precision::f32, Precision::f64}) {
      std::vector<std::uint64_t> hashes;
      for (const Mode& mode : everywhere()) {
        if (mode.precision != precision) continue;
        worldtest::SceneWorld made = worldtest::scene_world(scene, 3, precision);
        for (const BodyId body : made.world.bodies())
          if (*made.world.kind(body) == BodyKind::dynamic) REQUIRE(made.world.set_drag(body, 0.25, 0.25));
        StepSettings settings;
        settings.set_all(mode.place);
        settings.lanes = mode.lanes;
        settings.integrator = Integrator::seed;
        Stepper stepper(settings);
        worldtest::run(made.world, stepper, 120);
        hashes.push_back(made.world.hash());
      }
      for (const std::uint64_t hash : hashes) CHECK(hash == hashes[0]);
    }
}

TEST_CASE("seed: a world that does not ask for it runs none of its kernels, and it runs none of the others") {
  worldtest::SceneWorld made = worldtest::scene_world("ragdolls", 1);
  StepSettings settings;
  const auto kernels = [&] {
    const auto plan = Stepper(settings).plan_for(made.world, worldtest::frame);
    REQUIRE(plan);
    std::string names;
    for (const PlanEntry& entry : plan->entries)
      if (entry.kind == PlanEntry::Kind::kernel) names += std::string(kernel_name(entry)) + " ";
    return names;
  };
  CHECK(kernels().find("_seed") == std::string::npos);
  settings.integrator = Integrator::seed;
  const std::string seed = kernels();
  for (const char* name : {"begin_seed ", "advance_seed ", "synchronise_seed "})
    CHECK(seed.find(name) != std::string::npos);
  for (const char* name : {"begin ", "advance ", "remember ", "synchronise "})
    CHECK(seed.find(name) == std::string::npos);
}
