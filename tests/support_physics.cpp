#include "support_physics.h"

#include "step/backend.h"

namespace physics {

std::string Mode::name() const {
  std::string text = is_double() ? "f64 " : "f32 ";
  text += place == Place::gl ? "gl" : "cpu";
  if (lanes) text += ", lanes " + std::to_string(lanes);
  return text;
}

std::vector<Mode> precisions() { return {{Precision::f64}, {Precision::f32}}; }

std::vector<Mode> everywhere() {
  std::vector<Mode> modes = {{Precision::f64, Place::cpu, 1}, {Precision::f32, Place::cpu, 1}};
  // wider lanes where the processor has them
  for (const Mode& wide :
       {Mode{Precision::f64, Place::cpu, 4}, Mode{Precision::f32, Place::cpu, 4}, Mode{Precision::f32, Place::cpu, 8}})
    if (make_cpu_backend(wide.precision, wide.lanes)) modes.push_back(wide);
  modes.push_back({Precision::f64, Place::gl});
  modes.push_back({Precision::f32, Place::gl});
  return modes;
}

Run::Run(const Mode& mode, Vec3 gravity_, std::uint32_t substeps) : world({mode.precision, gravity_}) {
  StepSettings settings;
  settings.set_all(mode.place);
  settings.lanes = mode.lanes;
  settings.substeps = substeps;
  settings.timings = false;
  REQUIRE(stepper.configure(settings));
}

BodyId Run::add(const BodyDef& def) {
  auto made = world.create_body(def);
  if (!made) FAIL(made.error().message);
  return *made;
}

void Run::step(double dt, long count) {
  for (long i = 0; i < count; i++) {
    const StepReport& report = stepper.step(world, dt);
    if (!report) FAIL(report.error.message);
  }
}

void Run::set_substeps(std::uint32_t substeps) {
  StepSettings settings = stepper.settings();
  settings.substeps = substeps;
  REQUIRE(stepper.configure(settings));
}

double order(double coarse_error, double fine_error, double dt_ratio) {
  return std::log(coarse_error / fine_error) / std::log(dt_ratio);
}

// ---- conserved quantities ------------------------------------------------------------------------------

namespace {
void add(Momenta& sum, double mass, Vec3 position, Vec3 velocity, Vec3 spin_momentum) {
  const Vec3 p = mass * velocity;
  sum.linear = sum.linear + p;
  sum.angular = sum.angular + cross(position, p) + spin_momentum;
  sum.linear_scale += length(p);
  sum.angular_scale += length(position) * length(p) + length(spin_momentum);
}
}  // namespace

Momenta momenta_in_phase(const World& world) {
  Momenta sum;
  for (BodyId id : world.bodies())
    if (*world.kind(id) == BodyKind::dynamic)
      add(sum, world.mass_properties(id)->mass, world.pose(id)->position, *world.velocity(id),
          *world.angular_momentum(id));
  return sum;
}

Momenta momenta_stored(const World& world) {
  const PropertyView velocity = *world.view("displacement_rate"), spin = *world.view("angular_momentum");
  Momenta sum;
  for (BodyId id : world.bodies()) {
    if (*world.kind(id) != BodyKind::dynamic) continue;
    const std::uint32_t row = *world.row_of(id);
    add(sum, world.mass_properties(id)->mass, world.pose(id)->position,
        {velocity.at(row, 0), velocity.at(row, 1), velocity.at(row, 2)},
        {spin.at(row, 0), spin.at(row, 1), spin.at(row, 2)});
  }
  return sum;
}

void resolve(SphereContact& contact, const Mode& mode) {
  REQUIRE(cases::resolve(contact, mode.precision, mode.place, mode.lanes));
}

}  // namespace physics
