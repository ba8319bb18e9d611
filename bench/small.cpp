// What a step of the least worlds costs, where the bodies' own share is small: one sub-step of 1/240 s of one ball in
// flight, one box that tumbles, the same with drag, one pendulum, a chain of ten links, one box at rest on the floor.
//   small/WORLD/VARIANT
#include <benchmark/benchmark.h>

#include <string>

#include "pcphys/step.h"
#include "scenes/builder.h"

namespace {

using namespace pcphys;

constexpr double dt = 1.0 / 240;
constexpr double half = 0.1;  // of a link [m]

BodyDef body(const ShapeDef& shape, Vec3 position, Vec3 spin) {
  BodyDef def;
  def.shapes = {shape};
  def.mass = 1;
  def.pose.position = position;
  def.angular_velocity = spin;
  return def;
}
BodyDef box(Vec3 spin = {1, 5, 0.5}) { return body(ShapeDef::box({half, 0.2, 0.3}), {0, 0.2, 0}, spin); }

void ball(scenes::Builder& builder) {
  (void)builder.world().set_gravity({});  // it stays near however often it is stepped
  builder.add(body(ShapeDef::sphere(half), {}, {1, 5, 0.5}));
}
void tumble(scenes::Builder& builder) {
  (void)builder.world().set_gravity({});
  builder.add(box());
}
void drag(scenes::Builder& builder) {
  BodyDef def = box();
  def.linear_drag = def.angular_drag = 0.25;
  (void)builder.world().set_gravity({});
  builder.add(def);
}
/// Links of a chain that starts out level.
void swing(scenes::Builder& builder, int links) {
  BodyId last = builder.world().ground();
  for (int i = 0; i < links; i++) {
    const int link = builder.add(body(ShapeDef::capsule(half / 4, half / 2), {(2 * i + 1) * half, 0, 0}, {}));
    JointDef pin;
    pin.a = last;
    pin.b = last = builder.id(link);
    pin.frame_a.position = {i == 0 ? 0 : half, 0, 0};
    pin.frame_b.position = {-half, 0, 0};
    builder.add_joint(pin);
  }
}
void pendulum(scenes::Builder& builder) { swing(builder, 1); }
void chain(scenes::Builder& builder) { swing(builder, 10); }
void rest(scenes::Builder& builder) {
  builder.add_floor();
  builder.add(box({}));
}

struct Variant {
  const char* name;
  std::uint32_t lanes;
  Precision precision;
};

void step(benchmark::State& state, void (*build)(scenes::Builder&), Variant variant) {
  World world({variant.precision});
  scenes::Scene scene;
  const scenes::SceneOptions options;
  scenes::Builder builder(world, scene, options);
  build(builder);
  StepSettings settings;
  settings.substeps = 1;
  settings.lanes = variant.lanes;
  settings.timings = false;
  Stepper stepper(settings);
  Error error = builder.error();
  for (auto _ : state)
    if (error.code == ErrorCode::none) error = stepper.step(world, dt).error;
  if (error.code != ErrorCode::none) return state.SkipWithError(error.message.c_str());
  state.SetLabel(stepper.device(Place::cpu));
}

const bool registered = [] {
  constexpr Variant variants[] = {{"float", 0, Precision::f32},
                                  {"float_1", 1, Precision::f32},
                                  {"double", 0, Precision::f64},
                                  {"double_1", 1, Precision::f64}};
  constexpr struct {
    const char* name;
    void (*build)(scenes::Builder&);
  } worlds[] = {{"ball", ball},         {"tumble", tumble},  {"drag", drag},
                {"pendulum", pendulum}, {"chain_10", chain}, {"rest", rest}};
  for (const auto& world : worlds)
    for (const Variant& variant : variants)
      benchmark::RegisterBenchmark((std::string("small/") + world.name + "/" + variant.name).c_str(), step, world.build,
                                   variant);
  return true;
}();

}  // namespace
