// Pins properties and tables of the host's own: every type keeps its values and its default for present and coming
// rows, in both precisions; values follow their objects when rows move; views, snapshots and (of role state) the hash
// hold them; adding one to a world that runs changes no bit of its motion; names, types, ids and values that do not fit
// are refused and change nothing.
#include <algorithm>
#include <array>
#include <cmath>

#include "support_world.h"

using namespace worldtest;

namespace {

constexpr Precision both[] = {Precision::f32, Precision::f64};

World balls(Precision precision, int count, std::vector<BodyId>& ids) {
  World world(WorldDef{precision, {0, -9.81, 0}});
  for (int i = 0; i < count; i++) ids.push_back(must(world.create_body(ball({3.0 * i, 5, 0}))));
  return world;
}

template <class T> void keeps(Precision precision, const T& initial, const T& other, std::uint32_t numbers) {
  INFO(std::string(name(property_type<T>)));
  std::vector<BodyId> ids;
  World world = balls(precision, 3, ids);
  const Property<T> p = must(world.add_property<T>("mine", initial, "m", body_table, Role::state));
  for (const BodyId id : ids) CHECK(must(world.get(p, id)) == initial);
  ids.push_back(must(world.create_body(ball({9, 5, 0}))));
  CHECK(must(world.get(p, ids.back())) == initial);  // of a row to come
  must(world.set(p, ids[1], other));
  CHECK(must(world.get(p, ids[1])) == other);
  CHECK(must(world.get(p, ids[2])) == initial);
  CHECK(must(world.property<T>("mine")) == p);
  const PropertyView view = must(world.view("mine"));
  CHECK(view.components == numbers);
  CHECK(view.count == 5);
  const PropertyNumbers wanted(other);
  for (std::uint32_t c = 0; c < numbers; c++) CHECK(view.at(must(world.row_of(ids[1])), c) == wanted.x[c]);

  // the last row takes the place of the first
  must(world.set(p, ids[3], other));
  must(world.destroy(ids[0]));
  CHECK(must(world.get(p, ids[3])) == other);
  CHECK(must(world.get(p, ids[2])) == initial);

  const std::vector<std::byte> before = world.snapshot();
  const std::uint64_t hash = world.hash();
  must(world.set(p, ids[2], other));
  CHECK(world.hash() != hash);
  must(world.restore(before));
  CHECK(world.hash() == hash);
  CHECK(must(world.get(p, ids[2])) == initial);
}

const PropertyInfo* find(const std::vector<PropertyInfo>& list, std::string_view name) {
  const auto it = std::ranges::find(list, name, &PropertyInfo::name);
  return it == list.end() ? nullptr : &*it;
}

}  // namespace

TEST_CASE("every type keeps what it is given") {
  for (const Precision precision : both) {
    keeps<Real>(precision, 0.5, -2, 1);
    keeps<float>(precision, 0.25f, 1.1f, 1);
    keeps<double>(precision, 0.1, 1.0 / 3, 1);  // in a world of floats too
    keeps<std::int32_t>(precision, -7, -2147483647 - 1, 1);
    keeps<std::uint32_t>(precision, 7, 4294967295u, 1);
    keeps<Vec3>(precision, {1, 2, 3}, {-4, 5, 0.5}, 3);
    keeps<Vec4>(precision, {1, 2, 3, 4}, {-4, 5, 0.5, 8}, 4);
    keeps<Quat>(precision, {}, {0.5, 0.5, 0.5, 0.5}, 4);
    keeps<Mat3>(precision, {1, 2, 3, 4, 5, 6, 7, 8, 9}, {9, 8, 7, 6, 5, 4, 3, 2, 1}, 9);
    keeps<SymMat3>(precision, {1, 2, 3, 4, 5, 6}, {6, 5, 4, 3, 2, 1}, 6);
  }
}

TEST_CASE("of joints and springs, and of a table of the host's own") {
  std::vector<BodyId> ids;
  World world = balls(Precision::f64, 2, ids);
  JointDef def;
  def.a = ids[0], def.b = ids[1];
  def.frame_a.position = {1.5, 0, 0}, def.frame_b.position = {-1.5, 0, 0};
  const auto wear = must(world.add_property<Real>("wear", 0.1, "1", joint_table));
  const JointId joint = must(world.create_joint(def));
  must(world.set(wear, joint, Real(0.7)));
  CHECK(must(world.get(wear, joint)) == 0.7);
  CHECK(must(world.row_of(joint)) == 1);

  const TableId puffs = must(world.add_table("puffs", 4));
  const auto heat = must(world.add_property<float>("heat", 20.0f, "K", puffs, Role::state));
  CHECK(must(world.rows(puffs)) == 4);
  must(world.set(heat, RowOf(4), 30.0f));
  const std::uint64_t hash = world.hash();
  const std::vector<std::byte> snapshot = world.snapshot();
  must(world.resize(puffs, 6));
  CHECK(must(world.get(heat, RowOf(4))) == 30.0f);
  CHECK(must(world.get(heat, RowOf(6))) == 20.0f);
  CHECK(world.hash() != hash);
  CHECK_REFUSED(world, world.restore(snapshot), ErrorCode::bad_snapshot, "same bodies, joints, properties and tables");
  must(world.resize(puffs, 4));
  must(world.set(heat, RowOf(1), 25.0f));
  must(world.restore(snapshot));
  CHECK(must(world.get(heat, RowOf(1))) == 20.0f);
  CHECK(world.hash() == hash);

  CHECK_REFUSED(world, world.get(heat, RowOf(0)), ErrorCode::bad_argument,
                "\"puffs\" has rows 1 to 4; there is no row 0.");
  CHECK_REFUSED(world, world.get(heat, RowOf(5)), ErrorCode::bad_argument, "there is no row 5");
  CHECK_REFUSED(world, world.get(heat, ids[0]), ErrorCode::bad_argument, "ask with a row of a table of the host's own");
  CHECK_REFUSED(world, world.get(wear, ids[0]), ErrorCode::bad_argument,
                "is of the table \"joint\"; ask with a joint.");
  CHECK_REFUSED(world, world.add_table("puffs"), ErrorCode::name_taken, "There is a table \"puffs\" already");
  CHECK_REFUSED(world, world.add_table("body"), ErrorCode::name_taken, "There is a table \"body\" already");
  CHECK_REFUSED(world, world.resize(body_table, 3), ErrorCode::bad_argument,
                "Only a table of the host's own can be resized");
  CHECK_REFUSED(world, world.remove(joint_table), ErrorCode::bad_argument,
                "Only a table of the host's own can be removed");
  must(world.remove(puffs));
  CHECK_REFUSED(world, world.rows(puffs), ErrorCode::stale_id, "This id names no table");
  CHECK_REFUSED(world, world.get(heat, RowOf(1)), ErrorCode::stale_id, "This id names no property");
  CHECK_REFUSED(world, world.view("heat"), ErrorCode::unknown_name, "There is no property \"heat\"");
  const TableId again = must(world.add_table("puffs"));  // its place, not its id
  CHECK(again != puffs);
  CHECK(must(world.rows(again)) == 0);
}

TEST_CASE("roles: an input is neither in the hash nor in snapshots") {
  std::vector<BodyId> ids;
  World world = balls(Precision::f32, 2, ids);
  const std::uint64_t bare = world.hash();
  const auto colour = must(world.add_property<std::uint32_t>("colour", 1, "1", body_table, Role::input));
  CHECK(world.hash() == bare);
  const std::vector<std::byte> snapshot = world.snapshot();
  must(world.set(colour, ids[0], 5u));
  must(world.restore(snapshot));
  CHECK(must(world.get(colour, ids[0])) == 5);
}

TEST_CASE("introspection tells the library's and the host's own alike") {
  std::vector<BodyId> ids;
  World world = balls(Precision::f32, 1, ids);
  const std::size_t before = world.properties().size();
  must(world.add_property<Vec3>("wind", {1, 0, 0}, "m/s", body_table, Role::input));
  const std::vector<PropertyInfo> list = world.properties();
  CHECK(list.size() == before + 1);
  const PropertyInfo* wind = find(list, "wind");
  REQUIRE(wind);
  CHECK(wind->own);
  CHECK(wind->unit == "m/s");
  CHECK(wind->table == "body");
  CHECK(wind->type == PropertyType::vec3);
  CHECK(wind->role == Role::input);
  const PropertyInfo* position = find(list, "position");
  REQUIRE(position);
  CHECK_FALSE(position->own);
  CHECK(position->role == Role::state);
}

TEST_CASE("the library's own are read by handle, and written by what keeps them in step") {
  std::vector<BodyId> ids;
  World world = balls(Precision::f64, 2, ids);
  const auto position = must(world.property<Vec3>("position"));
  CHECK(must(world.get(position, ids[1])) == Vec3{3, 5, 0});
  CHECK(must(world.get(must(world.property<Real>("mass")), ids[0])) == must(world.mass_properties(ids[0])).mass);
  CHECK_REFUSED(world, world.set(position, ids[1], Vec3{}), ErrorCode::bad_argument,
                "The property \"position\" is the library's, and others follow from it");
}

TEST_CASE("added to a world that runs, and removed from it: its motion is the same to the bit") {
  for (const Precision precision : both) {
    SceneWorld plain = scene_world("ragdolls", 2, precision), other = scene_world("ragdolls", 2, precision);
    Stepper a, b;
    run(plain.world, a, 30);
    run(other.world, b, 10);
    must(other.world.add_property<Real>("fuel", 3));
    must(other.world.add_property<Mat3>("strain", {}, "1", joint_table));
    run(other.world, b, 10);
    must(other.world.remove_property("fuel"));
    must(other.world.remove_property("strain"));
    run(other.world, b, 10);
    CHECK(plain.world.hash() == other.world.hash());
  }
}

TEST_CASE("removed: the name is free, the handle stale, also when another took its place") {
  std::vector<BodyId> ids;
  World world = balls(Precision::f32, 1, ids);
  const auto old = must(world.add_property<Real>("fuel", 1));
  must(world.remove_property("fuel"));
  CHECK_REFUSED(world, world.get(old, ids[0]), ErrorCode::stale_id, "This id names no property");
  const auto fresh = must(world.add_property<Real>("fuel", 2));
  CHECK(fresh.index == old.index);
  CHECK(must(world.get(fresh, ids[0])) == 2);
  CHECK_REFUSED(world, world.get(old, ids[0]), ErrorCode::stale_id, "This id names no property");
  CHECK_REFUSED(world, world.set(old, ids[0], Real(1)), ErrorCode::stale_id, "This id names no property");
}

TEST_CASE("what is refused changes nothing") {
  std::vector<BodyId> ids;
  World world = balls(Precision::f32, 2, ids);
  const auto fuel = must(world.add_property<Real>("fuel", 1, "kg"));
  CHECK_REFUSED(world, world.add_property<Real>("fuel"), ErrorCode::name_taken,
                "There is a property \"fuel\" already; choose another");
  CHECK_REFUSED(world, world.add_property<Vec3>("position"), ErrorCode::name_taken,
                "There is a property \"position\" already among those of the library");
  for (const char* bad : {"", "2nd", "a b", "gl_wind", "pc_wind", "io_wind", "two__lines", "wind-speed"})
    CHECK_REFUSED(world, world.add_property<Real>(bad), ErrorCode::bad_argument, "it must begin with a letter");
  for (const char* word : {"float", "return", "precise", "for", "new", "Real", "dvec3", "sampler2D", "uimageBuffer"})
    CHECK_REFUSED(world, world.add_property<Real>(word), ErrorCode::bad_argument, "a word of C++ or GLSL");
  CHECK_REFUSED(world, world.add_property<Real>("heat", std::nan("")), ErrorCode::not_finite,
                "The value of the property \"heat\" is nan");
  CHECK_REFUSED(world, world.add_property<Real>("heat", 0, "K", as_in(world, TableId{7, 1})), ErrorCode::stale_id,
                "This id names no table");
  CHECK_REFUSED(world, world.set(fuel, ids[0], Real(HUGE_VAL)), ErrorCode::not_finite,
                "The value of the property \"fuel\" is inf");
  CHECK_REFUSED(world, world.set(fuel, ids[0], Real(1e39)), ErrorCode::not_finite,
                "is 1e+39; it must be finite, and no larger than 3.4");
  must(world.set(fuel, ids[0], Real(1e38)));  // kernels may make it, so the host may too
  CHECK_REFUSED(world, world.set(fuel, as_in(world, BodyId{9, 1}), Real(1)), ErrorCode::stale_id,
                "This id names no body");
  CHECK_REFUSED(world, world.property<float>("fuel"), ErrorCode::wrong_type,
                "The property \"fuel\" holds values of type real, not float32.");
  CHECK_REFUSED(world, world.property<Real>("heat"), ErrorCode::unknown_name, "There is no property \"heat\"");
  CHECK_REFUSED(world, world.remove_property("heat"), ErrorCode::unknown_name, "There is no property \"heat\"");
  CHECK_REFUSED(world, world.remove_property("position"), ErrorCode::bad_argument, "only a host's own can be removed");
}

TEST_CASE("own tables: more rows than there can be, or than there is memory for") {
  World world;
  const TableId table = must(world.add_table("cells", 3));
  const auto heat = must(world.add_property<double>("heat", 7.0, "K", table));
  CHECK_REFUSED(world, world.add_table("more", 4294967295u), ErrorCode::bad_argument, "cannot have 4294967295 rows");
  CHECK_REFUSED(world, world.resize(table, (1u << 28) + 1), ErrorCode::bad_argument, "no more than 268435456");
  CHECK(must(world.rows(table)) == 3);
  must(world.resize(table, 4));
  CHECK(must(world.get(heat, RowOf(4))) == 7.0);
}
