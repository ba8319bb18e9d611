#include "check.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <string>

#include "extras.h"
#include "pcphys/step.h"
#include "scenes.h"
#include "world/state.h"

namespace pcphys::architectures {
namespace {

constexpr std::size_t bodies = 340;  // no multiple of the lanes
constexpr int steps = 120;           // half a second: chains come to their limits

using State = std::vector<float>;

State state_of(const Design& design, const std::vector<Handle>& handles) {
  State state(handles.size() * state_reals);
  for (std::size_t i = 0; i < handles.size(); i++) design.state(handles[i], state.data() + i * state_reals);
  return state;
}
bool same(const State& a, const State& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

/// What a gather collects, in an order that does not depend on the design's.
std::vector<std::array<float, packed_reals>> gathered(const Design& design, std::size_t count) {
  std::vector<std::array<float, packed_reals>> packed(count);
  design.gather(packed[0].data());
  std::sort(packed.begin(), packed.end());
  return packed;
}

bool report(bool good, const std::string& what) {
  if (!good) std::printf("differs: %s\n", what.c_str());
  return good;
}

/// One design after `steps` steps beside the first one.
struct Reference {
  State state;
  std::vector<std::array<float, packed_reals>> packed;
};
bool check_one(const NamedDesign& named, SceneKind kind, History history, Reference& reference) {
  const auto design = named.make();
  if (!design) return true;  // the processor has no such lanes
  const auto handles = build(kind, bodies, history, *design);
  const State before = state_of(*design, handles);
  const Steps with;
  for (int i = 0; i < steps; i++) with.step(kind, *design);
  const State after = state_of(*design, handles);
  const auto packed = gathered(*design, handles.size());
  const std::string what = std::string(named.name) + ", " + std::string(name(kind)) + ", " + std::string(name(history));
  bool good = report(!same(before, after), what + ": nothing moved");
  if (reference.state.empty()) reference = {after, packed};
  good &= report(same(after, reference.state), what + ": state");
  good &= report(packed == reference.packed, what + ": what is gathered");
  std::vector<float> copy(handles.size() * packed_reals);
  design->gather(copy.data());
  design->scatter(copy.data());
  return good & report(same(after, state_of(*design, handles)), what + ": a gather and a scatter change the state");
}

// What the library's own world takes for the property and the force,
// counted beside the designs' (tools/architectures_report.py).
Status add_wind(World& world, Stepper& stepper) {
  const auto area = world.add_property<Real>("area");  // [property]
  if (!area) return area.error();
  std::size_t i = 0;
  for (const BodyId body : world.bodies())
    if (Status set = world.set(*area, body, Real(float(flying_body(i++).area))); !set) return set;  // [property]
  const Vec3 wind{wind_velocity[0], wind_velocity[1], wind_velocity[2]};
  return stepper.add_kernel(world, {.text = wind_kernel(), .parameters = {{"wind", wind}}});  // [force]
}

/// Free flight, or flight in wind, as a world of the library that its own stepper moves.
bool check_stepper(SceneKind kind) {
  const auto design = make_properties(1);
  const auto handles = build(kind, bodies, History::fresh, *design);
  World world;
  StepSettings settings;
  settings.substeps = 1;
  Stepper stepper(settings);
  Tables& tables = world.state().tables;
  const auto row_of = [&](Buffer buffer, std::size_t row) {
    return tables.data<float>(buffer) + row * length_of(buffer);
  };
  for (std::size_t i = 0; i < handles.size(); i++) {
    BodyDef def;
    def.mass = 1;
    def.moments = Vec3{0.1, 0.15, 0.2};
    def.linear_drag = def.angular_drag = 0.25;
    if (const auto made = world.create_body(def); !made) return report(false, made.error().message);
    // the rows themselves: the border would round them once more
    const std::size_t row = i + 1;
    write(flying_body(i), {row_of(Buffer::motion, row), row_of(Buffer::pose, row), row_of(Buffer::mass, row),
                           row_of(Buffer::force, row), row_of(Buffer::material, row)});
  }
  if (kind == SceneKind::wind)
    if (const Status added = add_wind(world, stepper); !added) return report(false, added.error().message);
  const Steps with;
  for (int i = 0; i < steps; i++) {
    if (const StepReport& made = stepper.step(world, substep); !made) return report(false, made.error.message);
    with.step(kind, *design);
  }
  State state(handles.size() * state_reals);
  for (std::size_t i = 0; i < handles.size(); i++)
    read_state(row_of(Buffer::pose, i + 1), row_of(Buffer::motion, i + 1), state.data() + i * state_reals);
  return report(same(state, state_of(*design, handles)), std::string(name(kind)) + " beside the library's stepper");
}

}  // namespace

bool check() {
  bool good = true;
  constexpr SceneKind kinds[] = {SceneKind::flight, SceneKind::chains, SceneKind::pairs, SceneKind::wind,
                                 SceneKind::ropes};
  for (const SceneKind kind : kinds) {
    Reference reference;
    for (const NamedDesign& named : designs())
      for (const History history : {History::fresh, History::churned})
        good &= check_one(named, kind, history, reference);
  }
  good &= check_stepper(SceneKind::flight) & check_stepper(SceneKind::wind);
  if (good)
    std::printf("%zu designs, %zu scenes, 2 histories: the same bits after %d steps\n", designs().size(),
                std::size(kinds), steps);
  return good;
}

}  // namespace pcphys::architectures
