// Bad calls that read and set what bodies, joints and springs hold; of properties, tables and snapshots.
#include <utility>

#include "support_bad_calls.h"

namespace worldtest {
namespace {

using enum ErrorCode;

constexpr const char* no_body = "a body that is not there";

/// A function that takes a body before all else: `call` is made with one that is not there.
void add_stale(BadCalls& calls, const char* function, bool changes, std::function<Error(Host&, BodyId)> call) {
  calls.push_back(
      {function, no_body, stale_id, [call = std::move(call)](Host& h) { return call(h, h.gone_body); }, changes});
}

void add_readers(BadCalls& calls) {
  const auto add = [&](const char* function, auto read) {
    add_stale(calls, function, false,
              [read](Host& h, BodyId id) { return error_of(read(std::as_const(h.world), id)); });
  };
  add("World::pose", [](const World& w, BodyId id) { return w.pose(id); });
  add("World::velocity", [](const World& w, BodyId id) { return w.velocity(id); });
  add("World::angular_velocity", [](const World& w, BodyId id) { return w.angular_velocity(id); });
  add("World::angular_momentum", [](const World& w, BodyId id) { return w.angular_momentum(id); });
  add("World::position_last", [](const World& w, BodyId id) { return w.position_last(id); });
  add("World::orientation_last", [](const World& w, BodyId id) { return w.orientation_last(id); });
  add("World::frozen", [](const World& w, BodyId id) { return w.frozen(id); });
  add("World::is_asleep", [](const World& w, BodyId id) { return w.is_asleep(id); });
  add("World::can_sleep", [](const World& w, BodyId id) { return w.can_sleep(id); });
  add("World::kind", [](const World& w, BodyId id) { return w.kind(id); });
  add("World::mass_properties", [](const World& w, BodyId id) { return w.mass_properties(id); });
  add("World::material", [](const World& w, BodyId id) { return w.material(id); });
  add("World::shapes", [](const World& w, BodyId id) { return w.shapes(id); });
  add("World::row_of", [](const World& w, BodyId id) { return w.row_of(id); });
  calls.push_back({"World::row_of", "a joint that is not there", stale_id,
                   [](Host& h) { return error_of(h.world.row_of(h.gone_joint)); }, false});
  for (const char* function : {"World::position_last", "World::orientation_last"})
    calls.push_back({function, "no step has been made", bad_time_step,
                     [=](Host&) {
                       World fresh;
                       const BodyId body = must(fresh.create_body(ball({})));
                       return function == std::string("World::position_last") ? error_of(fresh.position_last(body))
                                                                              : error_of(fresh.orientation_last(body));
                     },
                     false});
}

void add_motion(BadCalls& calls) {
  const auto add = [&](const char* function, const char* wrong, ErrorCode code, std::function<Error(Host&)> call) {
    calls.push_back({function, wrong, code, std::move(call)});
  };
  const char* name = "World::set_pose";
  add_stale(calls, name, true, [](Host& h, BodyId id) { return error_of(h.world.set_pose(id, {})); });
  add(name, "a position or orientation that is NaN", not_finite, [](Host& h) {
    return error_of(h.world.set_pose(h.body, {{infinite, 0, 0}, {}}));
  });
  add(name, "an orientation that is not of unit length", not_unit_quaternion, [](Host& h) {
    return error_of(h.world.set_pose(h.body, {{}, {0, 0, 0, 2}}));
  });
  add(name, "the ground", bad_argument, [](Host& h) { return error_of(h.world.set_pose(h.world.ground(), {})); });
  name = "World::set_velocity";
  add_stale(calls, name, true, [](Host& h, BodyId id) { return error_of(h.world.set_velocity(id, {})); });
  add(name, "a velocity that is NaN", not_finite, [](Host& h) {
    return error_of(h.world.set_velocity(h.body, {not_a_number, 0, 0}));
  });
  add(name, "other than zero, of a fixed body", bad_argument, [](Host& h) {
    return error_of(h.world.set_velocity(h.fixed, {1, 0, 0}));
  });
  name = "World::set_angular_velocity";
  add_stale(calls, name, true, [](Host& h, BodyId id) { return error_of(h.world.set_angular_velocity(id, {})); });
  add(name, "NaN, or of an angular momentum beyond 1e36", not_finite, [](Host& h) {
    return error_of(h.world.set_angular_velocity(h.body, {not_a_number, 0, 0}));
  });
  add(name, "other than zero, of a fixed body or one that does not rotate", bad_argument, [](Host& h) {
    return error_of(h.world.set_angular_velocity(h.point, {1, 0, 0}));
  });
  name = "World::set_position_last";
  add_stale(calls, name, true, [](Host& h, BodyId id) { return error_of(h.world.set_position_last(id, {})); });
  add(name, "NaN, or a velocity beyond 1e15", not_finite, [](Host& h) {
    return error_of(h.world.set_position_last(h.body, {1e15, 0, 0}));
  });
  add(name, "a fixed body", bad_argument, [](Host& h) { return error_of(h.world.set_position_last(h.fixed, {})); });
  add(name, "no step has been made", bad_time_step, [](Host& h) {
    h.world = World();
    h.body = must(h.world.create_body(ball({})));
    h.ready();
    return error_of(h.world.set_position_last(h.body, {}));
  });
  name = "World::set_orientation_last";
  add_stale(calls, name, true, [](Host& h, BodyId id) { return error_of(h.world.set_orientation_last(id, {})); });
  add(name, "an orientation that is not of unit length", not_unit_quaternion, [](Host& h) {
    return error_of(h.world.set_orientation_last(h.body, {0, 0, 0, 0}));
  });
  add(name, "NaN, or of an angular momentum beyond 1e36", not_finite, [](Host& h) {
    return error_of(h.world.set_orientation_last(h.body, {not_a_number, 0, 0, 1}));
  });
  add(name, "a fixed body, or one that does not rotate", bad_argument,
      [](Host& h) { return error_of(h.world.set_orientation_last(h.fixed, {})); });
  add_stale(calls, "World::wake", true, [](Host& h, BodyId id) { return error_of(h.world.wake(id)); });
  add_stale(calls, "World::set_can_sleep", true,
            [](Host& h, BodyId id) { return error_of(h.world.set_can_sleep(id, true)); });
}

void add_inputs(BadCalls& calls) {
  const auto add = [&](const char* function, const char* wrong, ErrorCode code, std::function<Error(Host&)> call) {
    calls.push_back({function, wrong, code, std::move(call)});
  };
  add("World::set_gravity", "NaN", not_finite, [](Host& h) {
    return error_of(h.world.set_gravity({0, not_a_number, 0}));
  });
  const char* name = "World::set_mass_properties";
  add_stale(calls, name, true, [](Host& h, BodyId id) {
    return error_of(h.world.set_mass_properties(id, {1, {1, 1, 1}}));
  });
  add(name, "NaN, or an angular momentum beyond 1e36", not_finite, [](Host& h) {
    return error_of(h.world.set_mass_properties(h.body, {not_a_number, {1, 1, 1}}));
  });
  add(name, "zero, below or out of range, or moments that no body has", bad_mass, [](Host& h) {
    return error_of(h.world.set_mass_properties(h.body, {1, {1, 1, 3}}));
  });
  add(name, "a body that is not dynamic", bad_argument, [](Host& h) {
    return error_of(h.world.set_mass_properties(h.hand, {1, {1, 1, 1}}));
  });
  name = "World::set_material";
  add_stale(calls, name, true, [](Host& h, BodyId id) { return error_of(h.world.set_material(id, {})); });
  add(name, "NaN", not_finite, [](Host& h) { return error_of(h.world.set_material(h.body, {not_a_number, 0, 0})); });
  add(name, "friction below zero, restitution outside of 0 to 1, a rule that is none", bad_argument, [](Host& h) {
    return error_of(h.world.set_material(h.body, {0, 0, 2}));
  });
  name = "World::set_drag";
  add_stale(calls, name, true, [](Host& h, BodyId id) { return error_of(h.world.set_drag(id, 0, 0)); });
  add(name, "NaN", not_finite, [](Host& h) { return error_of(h.world.set_drag(h.body, not_a_number, 0)); });
  add(name, "below zero", bad_argument, [](Host& h) { return error_of(h.world.set_drag(h.body, 0, -1)); });
  name = "World::add_force";
  add_stale(calls, name, true, [](Host& h, BodyId id) { return error_of(h.world.add_force(id, Wrench{})); });
  add(name, "a force or torque that is NaN", not_finite, [](Host& h) {
    return error_of(h.world.add_force(h.body, Wrench{{not_a_number, 0, 0}, {}}));
  });
  add(name, "a callback that is empty", bad_argument,
      [](Host& h) { return error_of(h.world.add_force(h.body, ForceCallback{})); });
  add("World::remove", "a force that is not there", stale_id,
      [](Host& h) { return error_of(h.world.remove(h.gone_force)); });
  add_stale(calls, "World::set_filter", true, [](Host& h, BodyId id) { return error_of(h.world.set_filter(id, {})); });
  add_stale(calls, "World::set_collide", true,
            [](Host& h, BodyId id) { return error_of(h.world.set_collide(h.body, id, false)); });
  add("World::set_collide", "twice the same body", bad_argument,
      [](Host& h) { return error_of(h.world.set_collide(h.body, h.body, false)); });
}

void add_drives(BadCalls& calls) {
  const auto add = [&](const char* function, const char* wrong, ErrorCode code, std::function<Error(Host&)> call,
                       bool changes = true) {
    calls.push_back({function, wrong, code, std::move(call), changes});
  };
  add(
      "World::joint", "a joint that is not there", stale_id,
      [](Host& h) { return error_of(h.world.joint(h.gone_joint)); }, false);
  add(
      "World::joint_separation", "a joint that is not there", stale_id,
      [](Host& h) { return error_of(h.world.joint_separation(h.gone_joint)); }, false);
  add(
      "World::spring", "a spring that is not there", stale_id,
      [](Host& h) { return error_of(h.world.spring(h.gone_spring)); }, false);
  const char* name = "World::set_motor";
  add(name, "a joint that is not there", stale_id,
      [](Host& h) { return error_of(h.world.set_motor(h.gone_joint, {})); });
  add(name, "a speed or torque that is NaN", not_finite, [](Host& h) {
    return error_of(h.world.set_motor(h.joint, {not_a_number, 1}));
  });
  add(name, "a torque below zero", bad_joint, [](Host& h) { return error_of(h.world.set_motor(h.joint, {1, -1})); });
  name = "World::set_spring";
  add(name, "a joint that is not there", stale_id,
      [](Host& h) { return error_of(h.world.set_spring(h.gone_joint, AngularSpring{})); });
  add(name, "a spring between points that is not there", stale_id,
      [](Host& h) { return error_of(h.world.set_spring(h.gone_spring, 1, 1, 1)); });
  add(name, "NaN", not_finite, [](Host& h) { return error_of(h.world.set_spring(h.spring, 1, not_a_number, 1)); });
  add(name, "a rest length, stiffness or damping below zero", bad_joint,
      [](Host& h) { return error_of(h.world.set_spring(h.spring, 1, -1, 1)); });
  add(name, "a rest orientation that is not of unit length", not_unit_quaternion, [](Host& h) {
    return error_of(h.world.set_spring(h.joint, AngularSpring{1, 1, {0, 0, 0, 2}}));
  });
}

}  // namespace

void add_bad_values(BadCalls& calls) {
  add_readers(calls);
  add_motion(calls);
  add_inputs(calls);
  add_drives(calls);
}

void add_bad_properties(BadCalls& calls) {
  const auto add = [&](const char* function, const char* wrong, ErrorCode code, std::function<Error(Host&)> call,
                       bool changes = true) {
    calls.push_back({function, wrong, code, std::move(call), changes});
  };
  const char* unknown = "a name that no property has";
  add(
      "World::view", unknown, unknown_name, [](Host& h) { return error_of(h.world.view("speed of light")); }, false);
  add(
      "World::property", unknown, unknown_name, [](Host& h) { return error_of(h.world.property<Real>("charm")); },
      false);
  add(
      "World::property", "another type than the property's", wrong_type,
      [](Host& h) { return error_of(h.world.property<Vec3>("fuel")); }, false);
  const char* name = "World::add_property";
  add(name, "a name that a kernel's text cannot use", bad_argument,
      [](Host& h) { return error_of(h.world.add_property<Real>("two words")); });
  add(name, "the name of another", name_taken,
      [](Host& h) { return error_of(h.world.add_property<Real>("position")); });
  add(name, "an initial value that its type does not hold, or NaN", not_finite,
      [](Host& h) { return error_of(h.world.add_property<Real>("charm", not_a_number)); });
  add(name, "a table that is not there", stale_id,
      [](Host& h) { return error_of(h.world.add_property<Real>("charm", 0, "1", h.gone_table)); });
  add(name, "a role that is none", bad_argument,
      [](Host& h) { return error_of(h.world.add_property<Real>("charm", 0, "1", body_table, Role(9))); });
  add("World::remove_property", unknown, unknown_name,
      [](Host& h) { return error_of(h.world.remove_property("charm")); });
  add("World::remove_property", "one of the library's", bad_argument,
      [](Host& h) { return error_of(h.world.remove_property("position")); });
  name = "World::get";
  add(
      name, "a property that is not there", stale_id,
      [](Host& h) { return error_of(h.world.get(h.gone_property, h.body)); }, false);
  add(
      name, "a body that is not there", stale_id, [](Host& h) { return error_of(h.world.get(h.fuel, h.gone_body)); },
      false);
  add(
      name, "an object of another table, or a row that the table does not have", bad_argument,
      [](Host& h) { return error_of(h.world.get(h.heat, RowOf(3))); }, false);
  name = "World::set";
  add(name, "a property that is not there", stale_id,
      [](Host& h) { return error_of(h.world.set(h.gone_property, h.body, Real(1))); });
  add(name, "a body that is not there", stale_id,
      [](Host& h) { return error_of(h.world.set(h.fuel, h.gone_body, Real(1))); });
  add(name, "an object of another table, or a row that the table does not have", bad_argument,
      [](Host& h) { return error_of(h.world.set(h.fuel, RowOf(1), Real(1))); });
  add(name, "one of the library's", bad_argument,
      [](Host& h) { return error_of(h.world.set(must(h.world.property<Vec3>("position")), h.body, Vec3{})); });
  add(name, "a value that its type does not hold, or NaN", not_finite,
      [](Host& h) { return error_of(h.world.set(h.fuel, h.body, Real(1e39))); });
  name = "World::add_table";
  add(name, "a name that a kernel's text cannot use, or more than 2^28 rows", bad_argument,
      [](Host& h) { return error_of(h.world.add_table("rows", 4000000000u)); });
  add(name, "the name of another", name_taken, [](Host& h) { return error_of(h.world.add_table("cells")); });
  name = "World::resize";
  add(name, "a table that is not there", stale_id, [](Host& h) { return error_of(h.world.resize(h.gone_table, 1)); });
  add(name, "more than 2^28 rows, or a table of the library's", bad_argument,
      [](Host& h) { return error_of(h.world.resize(body_table, 1)); });
  add(
      "World::rows", "a table that is not there", stale_id,
      [](Host& h) { return error_of(h.world.rows(h.gone_table)); }, false);
  add("World::remove", "a table that is not there", stale_id,
      [](Host& h) { return error_of(h.world.remove(h.gone_table)); });
  add("World::remove", "a table of the library's", bad_argument,
      [](Host& h) { return error_of(h.world.remove(joint_table)); });
  name = "World::restore";
  add(name, "bytes that are cut or changed", bad_snapshot,
      [](Host& h) { return error_of(h.world.restore(std::span(h.saved).first(h.saved.size() - 1))); });
  add(name, "a snapshot of a world with other objects, shapes or properties", bad_snapshot,
      [](Host& h) { return error_of(h.world.restore(World().snapshot())); });
}

}  // namespace worldtest
