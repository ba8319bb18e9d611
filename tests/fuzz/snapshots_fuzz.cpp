// Bytes in place of a snapshot: `World::restore` refuses them and leaves the world as it was, or takes them; then the
// world goes on, and what it saves reads back to the bit. The first byte says of which world, and whether the others
// are the whole of a snapshot or the first bytes of one whose rest is true; the checksum is set right, or no input
// would pass it.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <vector>

#include "expect.h"
#include "pcphys/pcphys.h"
#include "seeds.h"
#include "world/state_rows.h"

namespace {

using namespace pcphys;

constexpr double frame = 1.0 / 60;  // [s]
constexpr std::size_t sum_bytes = sizeof(std::uint64_t);

BodyDef body_of(const ShapeDef& shape, Vec3 position, BodyKind kind = BodyKind::dynamic) {
  BodyDef def;
  def.kind = kind;
  def.pose.position = position;
  def.shapes = {shape};
  return def;
}

/// A floor, a ball and a box on it.
void add_resting(World& world) {
  (void)fuzz::expect(world.create_body(body_of(ShapeDef::plane(), {}, BodyKind::fixed)));
  (void)fuzz::expect(world.create_body(body_of(ShapeDef::sphere(0.5), {0, 0.5, 0})));
  (void)fuzz::expect(world.create_body(body_of(ShapeDef::box({0.5, 0.5, 0.5}), {0.2, 1.5, 0})));
}

/// Two links on a pin with a motor, and a body that is led.
void add_joined(World& world) {
  const BodyId a = fuzz::expect(world.create_body(body_of(ShapeDef::capsule(0.1, 0.3), {0, 2, 0})));
  const BodyId b = fuzz::expect(world.create_body(body_of(ShapeDef::capsule(0.1, 0.3), {0, 2, 1})));
  const BodyId led =
      fuzz::expect(world.create_body(body_of(ShapeDef::box({1, 0.1, 1}), {0, 1.5, 0}, BodyKind::kinematic)));
  fuzz::expect(world.set_velocity(led, {0.1, 0, 0}));
  JointDef joint;
  joint.a = a;
  joint.b = b;
  joint.frame_a.position = {0, 0, 0.5};
  joint.frame_b.position = {0, 0, -0.5};
  joint.motor = {1, 10};
  (void)fuzz::expect(world.create_joint(joint));
  SpringDef spring;
  spring.a = world.ground();
  spring.b = a;
  spring.anchor_a = {0, 3, 0};
  spring.stiffness = 100;
  (void)fuzz::expect(world.create_spring(spring));
}

/// Properties of the host's own, of bodies and of a table.
void add_own(World& world) {
  (void)fuzz::expect(world.add_property<Real>("heat", 1));
  const TableId table = fuzz::expect(world.add_table("cells", 3));
  (void)fuzz::expect(world.add_property<Vec3>("flow", {}, "m/s", table));
}

World make_world(std::uint8_t which) {
  World world(WorldDef{which & 1 ? Precision::f64 : Precision::f32, {}});
  if (which & 2) add_joined(world);
  if (which & 4 || !(which & 2)) add_resting(world);
  if (which & 8) add_own(world);
  return world;
}

Stepper make_stepper(std::uint8_t which) {
  return Stepper({.substeps = 2, .sleep = (which & 4) != 0, .sleep_time = 0.05});
}

void step(World& world, std::uint8_t which, int steps) {
  Stepper stepper = make_stepper(which);
  for (int i = 0; i < steps; i++) (void)stepper.step(world, frame);  // numbers that overflow may be refused
}

void set_checksum(std::span<std::byte> snapshot) {
  Hash hash;
  hash.bytes(snapshot.data(), snapshot.size() - sum_bytes);
  const std::uint64_t sum = hash.value();
  std::memcpy(snapshot.data() + snapshot.size() - sum_bytes, &sum, sum_bytes);
}

void check_finite(const World& world) {
  for (const BodyId body : world.bodies()) {
    const Pose pose = fuzz::expect(world.pose(body));
    fuzz::expect(finite(pose.position) && std::fabs(length(pose.orientation) - 1) < 1e-2, "a pose that is none");
    fuzz::expect(finite(fuzz::expect(world.velocity(body))), "a velocity that is none");
    fuzz::expect(finite(fuzz::expect(world.angular_velocity(body))), "an angular velocity that is none");
  }
}

/// What is left of a world that was restored is one that can be saved, restored and stepped, and a twin does the same.
void check_goes_on(World& world, std::uint8_t which) {
  check_finite(world);
  const std::uint64_t hash = world.hash();
  const std::vector<std::byte> saved = world.snapshot();
  World twin = make_world(which);
  fuzz::expect(twin.restore(saved));
  fuzz::expect(twin.hash() == hash && twin.snapshot() == saved, "another world of the same snapshot");
  step(world, which, 3);
  step(twin, which, 3);
  check_finite(world);
  fuzz::expect(twin.hash() == world.hash(), "another motion of the same snapshot");
  const std::vector<std::byte> later = world.snapshot();
  fuzz::expect(twin.restore(later));
  fuzz::expect(twin.snapshot() == later, "another snapshot after steps");
}

}  // namespace

std::size_t fuzz::number_bytes(std::uint8_t head) { return head & 1 ? sizeof(double) : sizeof(float); }

std::vector<std::vector<std::uint8_t>> fuzz::seeds() {
  std::vector<std::vector<std::uint8_t>> all;
  for (std::uint8_t which = 0; which < 16; which++) {
    World world = make_world(which);
    step(world, which, which & 4 ? 30 : 5);
    const std::vector<std::byte> saved = world.snapshot();
    std::vector<std::uint8_t> seed{std::uint8_t(which | 16)};
    for (const std::byte b : saved) seed.push_back(std::uint8_t(b));
    all.push_back(seed);
  }
  return all;
}

namespace {

/// The bytes, and where a whole snapshot of that world is asked for, the rest of one.
std::vector<std::byte> snapshot_of(std::uint8_t which, bool completed, std::span<const std::uint8_t> given) {
  static const std::vector<std::vector<std::uint8_t>> saved = fuzz::seeds();
  std::vector<std::uint8_t> bytes(given.begin(), given.end());
  if (completed) {
    const std::vector<std::uint8_t> whole(saved[which].begin() + 1, saved[which].end());
    bytes.resize(std::min(bytes.size(), whole.size()));
    bytes.insert(bytes.end(), whole.begin() + std::ptrdiff_t(bytes.size()), whole.end());
  }
  std::vector<std::byte> snapshot(bytes.size());
  std::memcpy(snapshot.data(), bytes.data(), bytes.size());
  set_checksum(snapshot);
  return snapshot;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1 + sum_bytes) return 0;
  const std::uint8_t which = data[0] & 15;
  const std::vector<std::byte> snapshot = snapshot_of(which, (data[0] & 16) != 0, {data + 1, size - 1});

  World world = make_world(which);
  const std::uint64_t before = world.hash();
  const Status restored = world.restore(snapshot);
  if (restored) {
    check_goes_on(world, which);
  } else {
    fuzz::expect(world.hash() == before, "a refused snapshot changed the world");
    step(world, which, 1);
  }
  return 0;
}
