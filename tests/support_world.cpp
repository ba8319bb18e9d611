#include "support_world.h"

#include <algorithm>
#include <cstring>

#include "world/state.h"

namespace worldtest {

SceneWorld scene_world(std::string_view name, int count, Precision precision) {
  WorldDef def;
  def.precision = precision;
  World world(def);
  scenes::SceneOptions options;
  options.count = count;
  Result<scenes::Scene> scene = scenes::make(name, options, world);
  if (!scene) FAIL("no scene: " << scene.error().message);
  return {std::move(world), std::move(*scene)};
}

StepSettings Mix::settings() const {
  StepSettings s;
  s.integrate = places[0];
  s.joints = places[1];
  s.impulses = places[2];
  s.timings = false;
  return s;
}

std::string Mix::text() const {
  return std::string("integrate ") + name(places[0]) + ", joints " + name(places[1]) + ", impulses " + name(places[2]);
}

std::vector<Mix> mixes() {
  std::vector<Mix> all;
  for (unsigned bits = 0; bits < 8; bits++) {
    Mix mix;
    for (unsigned k = 0; k < 3; k++) mix.places[k] = bits >> k & 1 ? Place::gl : Place::cpu;
    all.push_back(mix);
  }
  return all;
}

StepSettings lanes(std::uint32_t lanes) {
  StepSettings s;
  s.lanes = lanes;
  s.timings = false;
  return s;
}

void check_same_bits(const HashesOf& hashes_of, int steps, int steps_on_gl) {
  require_gl();
  const auto wanted = hashes_of(lanes(1), steps);
  CHECK(hashes_of(lanes(4), steps) == wanted);
  CHECK(hashes_of(lanes(0), steps) == wanted);
  StepSettings threads = lanes(1);
  threads.threads = 3;
  CHECK(hashes_of(threads, steps) == wanted);
  const std::vector<std::uint64_t> first(wanted.begin(), wanted.begin() + steps_on_gl);
  for (const Mix& mix : mixes()) {
    INFO(mix.text());
    const auto found = hashes_of(mix.settings(), steps_on_gl);
    INFO("the same for " << std::ranges::mismatch(found, first).in1 - found.begin() << " steps");
    CHECK(found == first);
  }
}

void run(World& world, Stepper& stepper, int steps, double dt) {
  for (int i = 0; i < steps; i++) {
    const StepReport& report = stepper.step(world, dt);
    if (!report) FAIL("step " << i << " was refused: " << report.error.message);
  }
}

std::vector<std::uint64_t> hash_each_step(World& world, Stepper& stepper, int steps, double dt) {
  std::vector<std::uint64_t> hashes;
  for (int i = 0; i < steps; i++) {
    run(world, stepper, 1, dt);
    hashes.push_back(world.hash());
  }
  return hashes;
}

int runs(const StepPlan& plan, std::string_view kernel) {
  return int(std::ranges::count_if(
      plan.entries, [&](const PlanEntry& e) { return e.kind == PlanEntry::Kind::kernel && kernel_name(e) == kernel; }));
}

Status step_status(Stepper& stepper, World& world, double dt) {
  const StepReport& report = stepper.step(world, dt);
  if (report) return {};
  return report.error;
}

void require_gl() {
  const GlReport report = probe_gl(-1);
  if (!report.usable)
    FAIL("The GL backend is needed by this test (scripts/install-dependencies brings llvmpipe): " << report.problem);
  REQUIRE_MESSAGE(report.f32.parity(), "this device promises no parity in float");
  REQUIRE_MESSAGE(report.f64.parity(), "this device promises no parity in double");
}

void check_glsl_error(World& world, const KernelDef& def, int line) {
  require_gl();
  StepSettings settings;
  settings.set_all(Place::gl);
  Stepper stepper(settings);
  CHECK_REFUSED(world, stepper.add_kernel(world, def), ErrorCode::device_error, def.text.file);
  const std::string said = stepper.add_kernel(world, def).error().message, number = std::to_string(line);
  // Mesa writes file:line(column), NVIDIA file(line)
  CHECK_MESSAGE((said.find(":" + number + "(") != said.npos || said.find("(" + number + ")") != said.npos), said);
  run(world, stepper, 1);
}

BodyDef ball(Vec3 position, double radius) {
  BodyDef def;
  def.pose.position = position;
  def.shapes = {ShapeDef::sphere(radius)};
  return def;
}

BodyDef fixed_box(Vec3 position, Vec3 half_extents) {
  BodyDef def;
  def.kind = BodyKind::fixed;
  def.pose.position = position;
  def.shapes = {ShapeDef::box(half_extents)};
  return def;
}

BodyDef link_at(Vec3 position, double length) {
  BodyDef def;
  def.shapes = {ShapeDef::box({0.03, 0.04, 0.5 * length})};
  def.pose.position = position;
  def.density = 500;
  return def;
}

JointDef pin(BodyId a, Vec3 at_a, BodyId b, Vec3 at_b) {
  JointDef def;
  def.a = a;
  def.b = b;
  def.frame_a.position = at_a;
  def.frame_b.position = at_b;
  return def;
}

std::vector<BodyId> add_chain(World& world, Vec3 top, int count, bool free, Vec3 spin, bool touching) {
  std::vector<BodyId> links;
  for (int i = 0; i < count; i++) {
    BodyDef def = link_at(top - Vec3{0, 0, 0.2 + 0.4 * i});
    def.angular_velocity = (i % 2 == 0 ? 1.0 : -0.5) * spin;
    for (ShapeDef& shape : def.shapes) shape.filter.mask = touching ? ~0u : 0;
    links.push_back(must(world.create_body(def)));
    if (i > 0)
      (void)must(world.create_joint(pin(links[std::size_t(i - 1)], {0, 0, -0.2}, links.back(), {0, 0, 0.2})));
    else if (!free)
      (void)must(world.create_joint(pin(world.ground(), top, links[0], {0, 0, 0.2})));
  }
  return links;
}

World chains_world(Precision precision) {
  World world({precision});
  must(world.set_gravity({0, 0, -9.81}));
  (void)must(world.create_body(fixed_box({0, 0, -20}, {50, 50, 0.5})));
  for (int i = 0; i < 11; i++) (void)add_chain(world, {3.0 * i, 0, 0}, 2 + i % 3, i % 4 == 3, {0.3 * i, 1, -0.2 * i});
  (void)add_chain(world, {0, 5, 0}, 4, true, {150, 40, 20});  // of an octave of its own
  (void)add_chain(world, {0, 9, -18.5}, 3, true, {}, true);   // meets the floor
  return world;
}

World roof_world(Precision precision) {
  World world({precision});
  must(world.set_gravity({0, -9.81, 0}));
  BodyId above = world.ground();
  Vec3 at, end;  // in the world, and in the body above
  for (int i = 0; i < 6; i++) {
    const Vec3 half{0.25, i < 3 ? 0.01 : -0.01, 0};
    BodyDef def = ball(at + half, 0.1);
    def.mass = i == 3 ? 100 : 1;
    const BodyId link = must(world.create_body(def));
    (void)must(world.create_joint(pin(above, end, link, -1.0 * half)));
    above = link;
    at = at + 2.0 * half;
    end = half;
  }
  (void)must(world.create_joint(pin(above, end, world.ground(), at)));
  return world;
}

World crowd_world(Precision precision) {
  World world({precision});
  for (int i = 0; i < 90; i++) {
    BodyDef body = ball({0, 0, 0}, 0.5);
    if (i % 2 == 0) body.shapes = {ShapeDef::box({0.5, 0.5, 0.5})};
    must(world.create_body(body));
  }
  return world;
}

Fingerprint fingerprint(const World& world) {
  Fingerprint f{world.hash(), world.bodies(), world.joints(), world.snapshot(), {}, world.gravity()};
  const Tables& tables = world.state().tables;
  for (std::size_t b = 0; b < table_buffer_count; b++) {
    if (schema(Buffer(b)).table == Table::node) continue;  // of one step; nothing lasts in it
    const AlignedBytes& bytes = tables.bytes(Buffer(b));
    f.tables.insert(f.tables.end(), bytes.data(), bytes.data() + bytes.size());
  }
  return f;
}

void check_refused(bool went_through, const Error& error, ErrorCode code, std::string_view words) {
  INFO("message: " << error.message);
  INFO("wanted: " << std::string(words));
  REQUIRE_FALSE(went_through);
  CHECK(std::string(name(error.code)) == name(code));
  CHECK(error.message.find(words) != std::string::npos);
  CHECK(error.message.size() > 20);
  CHECK(error.message.back() == '.');
}

std::vector<BodyState> states(const World& world, const std::vector<BodyId>& bodies) {
  std::vector<BodyState> all;
  for (BodyId body : bodies)
    all.push_back({must(world.pose(body)), must(world.velocity(body)), must(world.angular_velocity(body))});
  return all;
}

}  // namespace worldtest
