#include "support_physics.h"

#include <fstream>
#include <sstream>

#include "plan/infos.h"
#include "plan/plan.h"
#include "step/processor_state.h"
#include "step/runner.h"
#include "world/state.h"

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

BodyDef free_body(double mass, Vec3 moments, Vec3 velocity) {
  BodyDef def;
  def.mass = mass;
  def.moments = moments;
  def.velocity = velocity;
  return def;
}

// ---- tables --------------------------------------------------------------------------------------------

double Csv::at(std::size_t row, const char* column) const {
  for (std::size_t c = 0; c < columns.size(); c++)
    if (columns[c] == column) return rows[row][c];
  FAIL("The table has no column " << column);
  return 0;
}

Csv read_csv(const char* file) {
  const std::string path = std::string(PCPHYS_SOURCE_DIR "/tests/data/") + file;
  std::ifstream in(path);
  if (!in) FAIL("Cannot read " << path);
  Csv csv;
  std::string line, field;
  while (std::getline(in, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream fields(line);
    if (csv.columns.empty()) {
      while (std::getline(fields, field, ',')) csv.columns.push_back(field);
      continue;
    }
    std::vector<double>& row = csv.rows.emplace_back();
    while (std::getline(fields, field, ',')) row.push_back(std::stod(field));
  }
  return csv;
}

// ---- rotations -----------------------------------------------------------------------------------------

Quat exponential(Vec3 rotation) {
  const double angle = length(rotation);
  return angle > 0 ? axis_angle((1 / angle) * rotation, angle) : Quat{};
}

double angle_between(Quat a, Quat b) {
  const Quat d = conjugate(a) * b;
  return 2 * std::atan2(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z), std::fabs(d.w));
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
      add(sum, world.mass_properties(id)->mass, world.pose(id)->position, *world.velocity(id), *world.angular_momentum(id));
  return sum;
}

Momenta momenta_stored(const World& world) {
  const PropertyView velocity = *world.view("displacement_rate"), spin = *world.view("angular_momentum");
  Momenta sum;
  for (BodyId id : world.bodies()) {
    if (*world.kind(id) != BodyKind::dynamic) continue;
    const std::uint32_t row = *world.row_of(id);
    add(sum, world.mass_properties(id)->mass, world.pose(id)->position,
        {velocity.at(row, 0), velocity.at(row, 1), velocity.at(row, 2)}, {spin.at(row, 0), spin.at(row, 1), spin.at(row, 2)});
  }
  return sum;
}

// ---- one contact ---------------------------------------------------------------------------------------

namespace {
BodyDef sphere(double mass, double radius, Vec3 position, Vec3 velocity, Vec3 spin) {
  BodyDef def;
  def.shapes = {ShapeDef::sphere(radius)};
  def.mass = mass;
  def.pose.position = position;
  def.velocity = velocity;
  def.angular_velocity = spin;
  return def;
}

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
}
}  // namespace

void resolve(SphereContact& c, const Mode& mode) {
  // so short a step that nothing moves, and a gap that is closed far within it
  const double dt = mode.is_double() ? 1e-18 : 1e-12, gap = 1e-30;
  World world({mode.precision, {}});
  REQUIRE(world.create_body(sphere(c.mass1, c.radius1, -(c.radius1 + c.radius2) * c.normal, c.v1, c.w1)));
  REQUIRE(world.create_body(sphere(c.mass2, c.radius2, {}, c.v2, c.w2)));
  WorldState& s = world.state();
  write_contact_row(s, c, gap);

  StepSettings settings;
  settings.set_all(mode.place);
  settings.lanes = mode.lanes;
  settings.substeps = 1;
  settings.timings = false;
  settings.restitution_threshold = 0;
  PlanSignature signature;
  signature.substeps = 1;
  signature.places.fill(mode.place);
  signature.bodies = signature.shapes = signature.free_contacts = true;
  signature.restitution = signature.impacts = c.restitution > 0;
  const StepPlan plan = make_plan(signature);

  Schedule schedule;
  schedule.update_structure(s);
  schedule.update_contacts(s);
  static Runner runner;  // keeps its backends: a GL context is slow to make
  InfoOf<float> single[phase_count];
  InfoOf<double> twice[phase_count];
  fill_infos(settings, {}, dt, 0, single);
  fill_infos(settings, {}, dt, 0, twice);
  const void* infos = mode.is_double() ? static_cast<const void*>(twice) : single;
  StepReport report;
  {
    const FlushSubnormals flush;
    runner.forget();
    REQUIRE(runner.prepare(settings, mode.precision));
    REQUIRE(runner.bind(settings, plan, s, schedule));
    REQUIRE(runner.run(settings, plan, s, schedule, infos, report));
  }
  const std::vector<BodyId> ids = world.bodies();
  c.v1 = *world.velocity(ids[0]);
  c.v2 = *world.velocity(ids[1]);
  c.w1 = *world.angular_velocity(ids[0]);
  c.w2 = *world.angular_velocity(ids[1]);
}

}  // namespace physics
