// Pins: the scenes that the peers were measured on are the same here, to the last of twelve digits: order,
// shapes, poses, velocities, mass, inertia, material, joints with their frames and limits, supports.
// tests/data/scenes.csv was written once by the peers' own scene generator.
#include <doctest/doctest.h>

#include <fstream>
#include <sstream>

#include "scenes/scene.h"

using namespace pcphys;

namespace {

/// A row of the table: its first word, and the numbers behind it.
struct Row {
  std::string kind, name;
  std::vector<double> numbers;
};

std::vector<Row> read_table() {
  std::ifstream file(PCPHYS_SOURCE_DIR "/tests/data/scenes.csv");
  std::vector<Row> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream cells(line);
    Row row;
    std::getline(cells, row.kind, ',');
    if (row.kind == "scene") std::getline(cells, row.name, ',');
    for (std::string cell; std::getline(cells, cell, ',');) row.numbers.push_back(std::stod(cell));
    rows.push_back(row);
  }
  return rows;
}

/// Takes a row's numbers one after the other.
struct Reader {
  const Row& row;
  std::size_t at = 0;

  double number() { return row.numbers.at(at++); }
  int integer() { return int(number()); }
  Vec3 vec3() {
    const double x = number(), y = number(), z = number();
    return {x, y, z};
  }
  Quat quat() {
    const double x = number(), y = number(), z = number(), w = number();
    return {x, y, z, w};
  }
};

bool near(double a, double b) { return std::fabs(a - b) <= 2e-11 * std::max(1.0, std::fabs(b)); }
bool near(Vec3 a, Vec3 b) { return near(a.x, b.x) && near(a.y, b.y) && near(a.z, b.z); }
/// q and -q are the same rotation.
bool near(Quat a, Quat b) {
  const double d = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
  return std::fabs(std::fabs(d) - 1) < 1e-10;
}

void check_body(const World& world, const scenes::Scene& scene, Reader row) {
  const std::size_t index = std::size_t(row.integer());
  CAPTURE(index);
  REQUIRE(index < scene.bodies.size());
  const scenes::SceneBody& body = scene.bodies[index];
  const ShapeKind kinds[] = {ShapeKind::sphere, ShapeKind::capsule, ShapeKind::box};
  CHECK(body.shape.kind == kinds[row.integer()]);
  CHECK(near(body.shape.size, row.vec3()));
  const Pose pose = *world.pose(body.id);
  CHECK(near(pose.position, row.vec3()));
  CHECK(near(pose.orientation, row.quat()));
  CHECK(near(body.start.position, pose.position));
  CHECK(near(body.start.orientation, pose.orientation));
  CHECK(near(*world.velocity(body.id), row.vec3()));
  const double mass = row.number();
  const Vec3 moments = row.vec3();
  CHECK((*world.kind(body.id) == BodyKind::fixed) == (mass == 0));
  if (mass > 0) {
    CHECK(near(world.mass_properties(body.id)->mass, mass));
    CHECK(near(world.mass_properties(body.id)->moments, moments));
  }
  const Material material = *world.material(body.id);
  const double friction = row.number();
  CHECK(material.static_friction == friction);
  CHECK(material.kinetic_friction == friction);
  CHECK(material.restitution == row.number());
  CHECK(body.group == row.integer());
  CHECK(body.bone == row.integer());
  CHECK((body.shape.filter.mask != 0) == (row.integer() != 0));
}

void check_joint(const World& world, const scenes::Scene& scene, std::size_t index, Reader row) {
  CAPTURE(index);
  REQUIRE(index < scene.joints.size());
  const JointDef joint = *world.joint(scene.joints[index]);
  const int a = row.integer(), b = row.integer();
  CHECK(joint.a == (a < 0 ? world.ground() : scene.bodies[std::size_t(a)].id));
  CHECK(joint.b == scene.bodies[std::size_t(b)].id);
  CHECK(near(joint.frame_a.position, row.vec3()));
  CHECK(near(joint.frame_b.position, row.vec3()));
  const Quat axes_a = row.quat(), axes_b = row.quat();
  const bool limits = row.integer() != 0;
  CHECK((joint.freedom.kind == AngleFreedom::Kind::cone_twist) == limits);
  if (!limits) return;  // the axes of a free pin mean nothing
  CHECK(near(joint.frame_a.orientation, axes_a));
  CHECK(near(joint.frame_b.orientation, axes_b));
  CHECK(near(joint.freedom.cone, row.number()));
  CHECK(near(joint.freedom.twist, row.number()));
}

}  // namespace

TEST_CASE("scenes: equal to the peers' table") {
  const std::vector<Row> rows = read_table();
  REQUIRE(rows.size() > 300);
  World world;
  scenes::Scene scene;
  std::size_t joint = 0, support = 0;
  for (const Row& row : rows) {
    Reader reader{row};
    if (row.kind == "scene") {
      scenes::SceneOptions options;
      options.count = reader.integer();
      options.ratio = reader.number();
      world = World({Precision::f64});
      auto made = scenes::make(row.name, options, world);
      REQUIRE(made);
      scene = *made;
      CHECK(scene.bodies.size() == std::size_t(reader.integer()));
      CHECK(scene.joints.size() == std::size_t(reader.integer()));
      CHECK(scene.supports.size() == std::size_t(reader.integer()));
      CHECK(near(scene.inner_width, reader.number()));
      CHECK(near(scene.wall_height, reader.number()));
      CHECK(world.body_count() == scene.bodies.size());
      CHECK(world.joint_count() == scene.joints.size());
      CHECK(world.gravity() == Vec3{0, -9.81, 0});
      joint = support = 0;
    }
    CAPTURE(scene.name);
    CAPTURE(scene.count);
    if (row.kind == "body") check_body(world, scene, reader);
    if (row.kind == "joint") check_joint(world, scene, joint++, reader);
    if (row.kind == "support") {
      REQUIRE(support < scene.supports.size());
      CHECK(scene.supports[support].upper == reader.integer());
      CHECK(scene.supports[support++].lower == reader.integer());
    }
  }
}

TEST_CASE("scenes: every scene is built from its defaults, in both precisions, and from no objects") {
  for (const scenes::SceneInfo& info : scenes::list())
    for (Precision precision : {Precision::f32, Precision::f64}) {
      CAPTURE(std::string(info.name));
      World world({precision});
      auto scene = scenes::make(info.name, {}, world);
      REQUIRE(scene);
      CHECK(scene->count == info.default_count);
      CHECK(scene->name == info.name);
      World empty({precision});
      scenes::SceneOptions none;
      none.count = 0;
      CHECK(scenes::make(info.name, none, empty));
    }
}

TEST_CASE("scenes: a seed changes the draws, the own seed is the default") {
  scenes::SceneOptions own, other;
  own.seed = 12345;
  other.seed = 1;
  World a, b, c;
  REQUIRE(scenes::make("balls", {}, a));
  REQUIRE(scenes::make("balls", own, b));
  REQUIRE(scenes::make("balls", other, c));
  CHECK(a.hash() == b.hash());
  CHECK(a.hash() != c.hash());
}

TEST_CASE("scenes: joints coincide at the start") {
  for (const char* name : {"ragdolls", "chain", "chainswing", "door"}) {
    CAPTURE(std::string(name));
    World world({Precision::f64});
    auto scene = scenes::make(name, {}, world);
    REQUIRE(scene);
    REQUIRE_FALSE(scene->joints.empty());
    for (JointId joint : scene->joints) CHECK(*world.joint_separation(joint) < 1e-12);
  }
}

TEST_CASE("scenes: errors name what to do and leave the world as it was") {
  World world;
  const std::uint64_t before = world.hash();
  const auto code_of = [&](const char* name, int count, double ratio) {
    scenes::SceneOptions options;
    options.count = count;
    options.ratio = ratio;
    auto scene = scenes::make(name, options, world);
    REQUIRE_FALSE(scene);
    CHECK(scene.error().message.back() == '.');
    CHECK(world.body_count() == 0);
    CHECK(world.hash() == before);
    return scene.error();
  };
  const Error unknown = code_of("marbles", 1, 1);
  CHECK(unknown.code == ErrorCode::unknown_name);
  for (const scenes::SceneInfo& info : scenes::list()) CHECK(unknown.message.find(info.name) != std::string::npos);
  CHECK(code_of("balls", -1, 1).code == ErrorCode::bad_argument);
  CHECK(code_of("balls", 2'000'000'000, 1).code == ErrorCode::bad_argument);
  CHECK(code_of("chain", 3, 0).code == ErrorCode::bad_argument);
  CHECK(code_of("chain", 3, std::numeric_limits<double>::quiet_NaN()).code == ErrorCode::bad_argument);
}
