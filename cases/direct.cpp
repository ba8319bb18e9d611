#include "direct.h"

#include "parts.h"
#include "plan/infos.h"
#include "plan/plan.h"
#include "step/processor_state.h"
#include "step/runner.h"
#include "world/state.h"

namespace pcphys::cases {
namespace {

bool is_box(const SphereContact& c) { return dot(c.half2, c.half2) > 0; }

void write_contact_row(WorldState& s, const SphereContact& c, double gap) {
  s.tables.resize(Table::contact, 2);
  s.contacts.keys = {{}, {0, 1}};
  s.contacts.ends = {{}, {1, 2}};
  s.contacts.features.resize(2);
  s.tables.set3(Buffer::contact, 1, 0, c.normal);
  s.tables.set(Buffer::contact, 1, 3, 1);
  s.tables.set3(Buffer::contact, 1, 4, c.radius1 * c.normal);
  s.tables.set(Buffer::contact, 1, 7, gap);
  s.tables.set(Buffer::contact, 1, 28, c.friction);
  s.tables.set(Buffer::contact, 1, 29, c.friction);
  s.tables.set(Buffer::contact, 1, 30, c.restitution);
  s.tables.set3(Buffer::contact, 1, 32, s.pose(2).position - s.pose(1).position);
  s.contacts_version++;
}

Result<World> make_world(const SphereContact& c, Precision precision) {
  World world({precision, {}});
  const bool box = is_box(c);
  const Vec3 centre1 = (box ? c.at2 : -c.radius2 * c.normal) - c.radius1 * c.normal;
  BodyDef second = ball(c.mass2, c.radius2, {}, c.v2, c.w2);
  if (box) second.shapes = {ShapeDef::box(c.half2)};
  for (const BodyDef& def : {ball(c.mass1, c.radius1, centre1, c.v1, c.w1), second})
    if (auto made = world.create_body(def); !made) return made.error();
  return world;
}

StepPlan plan_of_contact(Place place, const SphereContact& c) {
  PlanSignature signature;
  signature.substeps = 1;
  signature.places.fill(place);
  signature.bodies = signature.shapes = signature.free_contacts = signature.friction = true;
  signature.gyroscopic = is_box(c);
  signature.restitution = signature.impacts = c.restitution > 0;
  return make_plan(signature);
}

/// One run of the plan; the world's tables hold the contact.
Status run_plan(const StepSettings& settings, const StepPlan& plan, double dt, World& world) {
  WorldState& s = world.state();
  Schedule schedule;
  schedule.update_structure(s);
  schedule.update_contacts(s);
  static Runner runner;  // keeps its backends: a GL context is slow to make
  InfoOf<float> single[phase_count];
  InfoOf<double> twice[phase_count];
  const InfoInputs from(settings, {}, dt, 0, dt);
  fill_infos(from, single);
  fill_infos(from, twice);
  const void* infos = world.precision() == Precision::f64 ? static_cast<const void*>(twice) : single;
  StepReport report;
  const FlushSubnormals flush;
  runner.forget();
  if (auto status = runner.prepare(settings, world.precision()); !status) return status;
  if (auto status = runner.bind(settings, plan, s, schedule); !status) return status;
  return runner.run(s, schedule, infos, report);
}

}  // namespace

double direct_step(Precision precision) { return precision == Precision::f64 ? 1e-18 : 1e-12; }

Status resolve(SphereContact& c, Precision precision, Place place, std::uint32_t lanes) {
  constexpr double gap = 1e-30;  // closed far within the step
  auto world = make_world(c, precision);
  if (!world) return world.error();
  write_contact_row(world->state(), c, gap);
  StepSettings settings;
  settings.set_all(place);
  settings.lanes = lanes;
  settings.substeps = 1;
  settings.timings = false;
  settings.restitution_threshold = 0;
  if (auto status = run_plan(settings, plan_of_contact(place, c), direct_step(precision), *world); !status)
    return status;
  const std::vector<BodyId> ids = world->bodies();
  c.v1 = *world->velocity(ids[0]);
  c.v2 = *world->velocity(ids[1]);
  c.w1 = *world->angular_velocity(ids[0]);
  c.w2 = *world->angular_velocity(ids[1]);
  return {};
}

}  // namespace pcphys::cases
