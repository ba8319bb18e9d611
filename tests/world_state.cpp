// Pins what a host reads and writes of bodies: views by the names of the schema, poses, velocities that come
// back as they were set, last positions and orientations, kinematic bodies that move exactly as told, energy
// and momentum, and the hash.
#include <cmath>

#include "support_world.h"
#include "world/schema.h"
#include "world/state.h"

using namespace worldtest;

namespace {

World weightless(Precision precision = Precision::f32) { return World(WorldDef{precision, {}}); }

BodyDef brick(Vec3 position) {
  BodyDef def;
  def.pose = {position, axis_angle({0, 0.6, 0.8}, 0.7)};
  def.shapes = {ShapeDef::box({0.1, 0.2, 0.3})};
  return def;
}

void check_close(Vec3 a, Vec3 b, double tolerance) {
  INFO("(" << a.x << ", " << a.y << ", " << a.z << ") and (" << b.x << ", " << b.y << ", " << b.z << ")");
  CHECK(length(a - b) <= tolerance);
}

}  // namespace

TEST_CASE("views: every property of the schema, by name, over the world's own memory") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    SceneWorld s = scene_world("ragdolls", 1, precision);
    Stepper stepper;
    run(s.world, stepper, 60);
    const Tables& tables = s.world.state().tables;
    const std::size_t real = precision == Precision::f32 ? 4 : 8;
    for (const PropertySchema& p : properties()) {
      INFO(std::string(p.name));
      const PropertyView view = must(s.world.view(p.name));
      CHECK(view.count == tables.rows(p.table));
      CHECK(view.components == components(p.type));
      CHECK(view.stride == schema(p.buffer).reals * real);
      CHECK(view.precision == precision);
      CHECK(view.data == tables.bytes(p.buffer).data() + p.offset * real);
      CHECK(reinterpret_cast<std::uintptr_t>(view.data) % real == 0);
      for (std::size_t i = 0; i < view.count; i++)
        for (std::uint32_t c = 0; c < view.components; c++)
          CHECK(view.at(i, c) == tables.get(p.buffer, std::uint32_t(i), p.offset + c));
    }
  }
}

TEST_CASE("views: values of a body") {
  World world;
  BodyDef def = brick({1.5, 2.5, -3.5});
  def.velocity = {1, 2, 3};
  def.mass = 4;
  def.moments = Vec3{0.5, 0.25, 0.5};
  def.material = {0.5, 0.25, 0.125};
  def.linear_drag = 0.25;
  def.angular_drag = 0.75;
  (void)must(world.create_body(ball({})));
  const BodyId body = must(world.create_body(def));
  (void)must(world.add_force(body, Wrench{{1, 2, 3}, {4, 5, 6}}));
  const std::uint32_t row = must(world.row_of(body));
  const auto vec3 = [&](const char* name) {
    const PropertyView v = must(world.view(name));
    return Vec3{v.at(row, 0), v.at(row, 1), v.at(row, 2)};
  };
  const auto real = [&](const char* name) { return must(world.view(name)).at(row); };
  CHECK(vec3("position") == Vec3{1.5, 2.5, -3.5});
  CHECK(vec3("displacement_rate") == Vec3{1, 2, 3});
  CHECK(vec3("moments") == Vec3{0.5, 0.25, 0.5});
  CHECK(vec3("inverse_moments") == Vec3{2, 4, 2});
  CHECK(real("mass") == 4);
  CHECK(real("inverse_mass") == 0.25);
  CHECK(vec3("force") == Vec3{1, 2, 3});
  CHECK(vec3("torque") == Vec3{4, 5, 6});
  CHECK(real("linear_drag") == 0.25);
  CHECK(real("angular_drag") == 0.75);
  CHECK(real("static_friction") == 0.5);
  CHECK(real("kinetic_friction") == 0.25);
  CHECK(real("restitution") == 0.125);
  CHECK(must(world.view("orientation")).components == 4);
}

TEST_CASE("positions keep more than a float, in both precisions") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World world = weightless(precision);
    const Vec3 far{12345.678901, -98765.432109, 1e6 + 1.0 / 3};
    const BodyId body = must(world.create_body(ball(far)));
    check_close(must(world.pose(body)).position, far, 1e-8);
    must(world.set_pose(body, {-far, {}}));
    check_close(must(world.pose(body)).position, -far, 1e-8);
  }
}

TEST_CASE("velocities come back as they were set, before and after steps") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    const double tolerance = precision == Precision::f32 ? 1e-5 : 1e-13;
    World world(WorldDef{precision, {0, -10, 0}});
    BodyDef def = brick({});
    def.velocity = {1, 2, 3};
    def.angular_velocity = {0.5, -0.25, 0.125};
    const BodyId body = must(world.create_body(def));
    check_close(must(world.velocity(body)), {1, 2, 3}, 0);
    check_close(must(world.angular_velocity(body)), {0.5, -0.25, 0.125}, tolerance);
    Stepper stepper;
    run(world, stepper, 3);
    // free fall, read in phase with the position: exact for constant acceleration
    check_close(must(world.velocity(body)), {1, 2 - 10 * 3 * frame, 3}, tolerance);
    const Vec3 w = must(world.angular_velocity(body));
    must(world.set_velocity(body, {4, 5, 6}));
    check_close(must(world.velocity(body)), {4, 5, 6}, 0);
    check_close(must(world.angular_velocity(body)), w, tolerance);
    must(world.set_angular_velocity(body, {1, 1, 1}));
    check_close(must(world.angular_velocity(body)), {1, 1, 1}, tolerance);
    check_close(must(world.velocity(body)), {4, 5, 6}, 0);
    const Vec3 start = must(world.pose(body)).position;
    run(world, stepper, 6);
    const double t = 6 * frame;
    check_close(must(world.pose(body)).position, start + t * Vec3{4, 5, 6} + 0.5 * t * t * Vec3{0, -10, 0},
                precision == Precision::f32 ? 2e-6 : 1e-13);
  }
}

TEST_CASE("set_pose keeps the velocity and the angular velocity, and turns the momentum along") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    const double tolerance = precision == Precision::f32 ? 2e-5 : 1e-13;
    World world(WorldDef{precision, {0, -10, 0}});
    BodyDef def = brick({1, 2, 3});
    def.velocity = {3, 2, 1};
    def.angular_velocity = {5, 1, -2};
    const BodyId body = must(world.create_body(def));
    Stepper stepper;
    run(world, stepper, 2);
    const Vec3 v = must(world.velocity(body)), w = must(world.angular_velocity(body)),
               l = must(world.angular_momentum(body));
    must(world.set_pose(body, {{-4, 0, 9}, must(world.pose(body)).orientation}));
    check_close(must(world.velocity(body)), v, tolerance);
    check_close(must(world.angular_velocity(body)), w, tolerance);
    must(world.set_pose(body, {{-4, 0, 9}, axis_angle({1, 0, 0}, 2)}));
    check_close(must(world.velocity(body)), v, tolerance);
    check_close(must(world.angular_velocity(body)), w, tolerance);
    CHECK(length(must(world.angular_momentum(body)) - l) > 1e-2 * length(l));
    check_close(must(world.pose(body)).position, {-4, 0, 9}, 0);
    CHECK(must(world.pose(body)).orientation.x == doctest::Approx(std::sin(1.0)).epsilon(1e-7));
  }
}

TEST_CASE("set_mass_properties keeps the angular velocity") {
  World world = weightless(Precision::f64);
  BodyDef def = brick({});
  def.angular_velocity = {1, 2, 3};
  const BodyId body = must(world.create_body(def));
  must(world.set_mass_properties(body, {3, {1, 2, 2.5}}));
  CHECK(must(world.mass_properties(body)).mass == 3);
  check_close(must(world.angular_velocity(body)), {1, 2, 3}, 1e-14);
  const Quat q = must(world.pose(body)).orientation;
  const Vec3 local = rotate(conjugate(q), {1, 2, 3});
  check_close(must(world.angular_momentum(body)), rotate(q, {local.x, 2 * local.y, 2.5 * local.z}), 1e-14);
}

TEST_CASE("last position and orientation are one sub-step ago, and may be written") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    const double tolerance = precision == Precision::f32 ? 3e-7 : 1e-14;
    World world(WorldDef{precision, {0, -10, 0}});
    BodyDef def = brick({});
    def.velocity = {1, 2, 3};
    def.angular_velocity = {1, 0, 2};
    const BodyId body = must(world.create_body(def));
    StepSettings settings;
    settings.substeps = 1;
    Stepper stepper(settings);
    run(world, stepper, 1);
    const Pose before = must(world.pose(body));
    run(world, stepper, 1);
    check_close(must(world.position_last(body)), before.position, tolerance);
    const Quat d = conjugate(must(world.orientation_last(body))) * before.orientation;
    // the body tumbles: equal to second order
    CHECK(std::fabs(2 * std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z)) < 1e-3);

    must(world.set_position_last(body, {0.5, 0.25, -0.125}));
    check_close(must(world.position_last(body)), {0.5, 0.25, -0.125}, tolerance);
    const Quat last = axis_angle({0, 1, 0}, 0.1) * must(world.pose(body)).orientation;
    must(world.set_orientation_last(body, last));
    const Quat back = must(world.orientation_last(body)), difference = conjugate(back) * last;
    CHECK(std::sqrt(difference.x * difference.x + difference.y * difference.y + difference.z * difference.z) <
          10 * tolerance);
    check_close(must(world.position_last(body)), {0.5, 0.25, -0.125}, tolerance);
    // the same rotation by the other quaternion means the same
    must(world.set_orientation_last(body, {-last.x, -last.y, -last.z, -last.w}));
    CHECK(std::fabs((conjugate(must(world.orientation_last(body))) * last).w) == doctest::Approx(1).epsilon(1e-6));
    // Verlet goes on from where it was put: p' = 2 p - p_last + h^2 a
    const Vec3 p = must(world.pose(body)).position;
    run(world, stepper, 1);
    check_close(must(world.pose(body)).position, 2.0 * p - Vec3{0.5, 0.25, -0.125} + frame * frame * Vec3{0, -10, 0},
                10 * tolerance);
  }
}

TEST_CASE("kinematic bodies move exactly as told, whatever they meet") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World world(WorldDef{precision, {0, -9.81, 0}});
    BodyDef def = brick({0, 0.5, 0});
    def.pose.orientation = {};
    def.shapes = {ShapeDef::box({2, 0.25, 2})};
    def.kind = BodyKind::kinematic;
    def.velocity = {0.5, 0.25, -0.125};
    def.angular_velocity = {0, 0.75, 0};
    const BodyId lift = must(world.create_body(def));
    const BodyId rider = must(world.create_body(ball({0, 1.3, 0})));
    must(world.set_drag(lift, 5, 5));
    (void)must(world.add_force(lift, Wrench{{100, 0, 0}, {0, 0, 100}}));
    StepSettings settings;
    Stepper stepper(settings);
    run(world, stepper, 64, 1.0 / 64);
    CHECK(world.contact_count() == 1);
    CHECK(must(world.velocity(lift)) == Vec3{0.5, 0.25, -0.125});
    check_close(must(world.angular_velocity(lift)), {0, 0.75, 0}, 1e-6);
    // 256 sub-steps of 2^-8 s: every addition is exact
    CHECK(must(world.pose(lift)).position == Vec3{0.5, 0.75, -0.125});
    const Quat q = must(world.pose(lift)).orientation;
    CHECK(q.y == doctest::Approx(std::sin(0.375)).epsilon(precision == Precision::f32 ? 1e-5 : 1e-12));
    CHECK(must(world.pose(rider)).position.y > 1.2);
    CHECK(world.momentum().x != 0);  // of the rider alone: a kinematic body has no mass
    CHECK(must(world.angular_momentum(lift)) == Vec3{});
    must(world.set_velocity(lift, {}));
    must(world.set_angular_velocity(lift, {}));
    const Pose stays = must(world.pose(lift));
    run(world, stepper, 30);
    CHECK(must(world.pose(lift)) == stays);
  }
}

TEST_CASE("fixed bodies never move") {
  World world;
  const BodyId floor = must(world.create_body(fixed_box({0.1, -0.5, 0.2}, {5, 0.5, 5})));
  (void)must(world.create_body(ball({0, 0.6, 0})));
  const Pose before = must(world.pose(floor));
  Stepper stepper;
  run(world, stepper, 60);
  CHECK(must(world.pose(floor)) == before);
  CHECK(must(world.velocity(floor)) == Vec3{});
  CHECK(must(world.angular_velocity(floor)) == Vec3{});
}

TEST_CASE("energy and momentum of two bodies by hand") {
  World world(WorldDef{Precision::f64, {0, -10, 0}});
  BodyDef def;
  def.mass = 2;
  def.moments = Vec3{1, 2, 2.5};
  def.pose.position = {1, 0, 0};
  def.velocity = {0, 3, 0};
  def.angular_velocity = {0, 0, 4};
  (void)must(world.create_body(def));
  def.mass = 1;
  def.pose.position = {0, 2, 0};
  def.velocity = {1, 0, 0};
  def.angular_velocity = {};
  (void)must(world.create_body(def));
  CHECK(world.kinetic_energy() == doctest::Approx(9 + 0.5 * 2.5 * 16 + 0.5).epsilon(1e-14));
  CHECK(world.potential_energy() == doctest::Approx(20).epsilon(1e-14));
  check_close(world.momentum(), {1, 6, 0}, 1e-14);
  check_close(world.angular_momentum(), {0, 0, 6 + 10 - 2}, 1e-14);
}

TEST_CASE("the hash is of state alone, and takes -0 for +0") {
  World a = weightless(), b = weightless();
  for (World* world : {&a, &b}) (void)must(world->create_body(ball({1, 2, 3})));
  const BodyId body = a.bodies()[0], same = b.bodies()[0];
  CHECK(a.hash() == b.hash());
  must(a.set_velocity(body, {-0.0, 0, -0.0}));
  must(b.set_velocity(same, {0, 0, 0}));
  CHECK(a.hash() == b.hash());
  must(a.set_material(body, {1, 1, 1}));
  must(a.set_drag(body, 1, 1));
  must(a.set_gravity({1, 2, 3}));
  CHECK(a.hash() == b.hash());
  must(a.set_velocity(body, {0, 0, 1e-30}));
  CHECK(a.hash() != b.hash());
  World d(WorldDef{Precision::f64, {}});
  (void)must(d.create_body(ball({1, 2, 3})));
  CHECK(d.hash() != b.hash());
}

TEST_CASE("the hash does not depend on rows: ids order it") {
  const auto three = [](bool detour) {
    World world = weightless();
    std::vector<BodyId> ids;
    const int order[] = {0, 1, 2};
    for (int i : order) ids.push_back(must(world.create_body(ball({double(i), 0, 0}))));
    if (detour) {  // a fourth body comes and goes between, and the rows of two bodies change places
      const BodyId extra = must(world.create_body(ball({9, 9, 9})));
      must(world.destroy(extra));
      must(world.destroy(ids[0]));
      CHECK(must(world.create_body(ball({0, 0, 0}))).index == ids[0].index);
      CHECK(must(world.row_of(world.bodies()[0])) == 3);
    }
    return world.hash();
  };
  CHECK(three(false) == three(true));
}

TEST_CASE("a world may be moved: ids, views and steppers follow") {
  SceneWorld s = scene_world("balls", 10);
  Stepper stepper;
  run(s.world, stepper, 10);
  World moved = std::move(s.world);
  run(moved, stepper, 10);
  SceneWorld other = scene_world("balls", 10);
  Stepper fresh;
  run(other.world, fresh, 20);
  CHECK(moved.hash() == other.world.hash());
}
