// Elastic cords, which pull and never push: a jumper on a bridge's, and two bodies that fly apart on one. A kernel of a
// joint with its two bodies; what holds the ends is a spring of the library without any force of its own.
#include <numbers>

#include "pcphys/write_kernel.h"
#include "show.h"

using namespace pcphys;
using show::must;

PCPHYS_KERNEL(cord,
              (PC_A(Vec3) position_a, PC_A(Quaternion) orientation_a, PC_IN(Vec3) anchor_a, PC_B(Vec3) position_b,
               PC_B(Quaternion) orientation_b, PC_IN(Vec3) anchor_b, PC_IN(Real) rest_length,
               PC_IN(Real) cord_stiffness, PC_ADD_A(Vec3) force_a, PC_ADD_A(Vec3) torque_a, PC_ADD_B(Vec3) force_b,
               PC_ADD_B(Vec3) torque_b),
              {
                Vec3 arm_a = pc_rotate(orientation_a, anchor_a);
                Vec3 arm_b = pc_rotate(orientation_b, anchor_b);
                Vec3 way = pc_sub(pc_add(position_b, arm_b), pc_add(position_a, arm_a));
                Real size = pc_length(way);
                Real pull = cord_stiffness * pc_max(size - rest_length, PC_REAL(0.0));
                force_a = pc_scale(way, pull * pc_inverse_or_zero(size));
                force_b = pc_negate(force_a);
                torque_a = pc_cross(arm_a, force_a);
                torque_b = pc_cross(arm_b, force_b);
              })

constexpr double g = 9.81, rest = 20, stiffness = 120;  // [m/s^2], [m], [N/m]
constexpr double jumper = 80, light = 40, heavy = 60;   // [kg]

/// How far apart ends are that fly apart from nothing at `speed`, under an acceleration `pull` apart:
/// slack, taut, slack again.
double distance(double pull, double speed, double mass, double t) {
  const double taut_speed = std::sqrt(speed * speed + 2 * pull * rest), rate = std::sqrt(stiffness / mass);
  // When it is taut, and where it would hang.
  const double slack = 2 * rest / (speed + taut_speed), sag = pull / (rate * rate);
  const double swing = std::hypot(sag, taut_speed / rate), angle = std::atan2(sag, taut_speed / rate);
  const double taut = (std::numbers::pi + 2 * angle) / rate;
  if (t < slack) return (speed + 0.5 * pull * t) * t;
  if (t < slack + taut) return rest + sag + swing * std::sin(rate * (t - slack) - angle);
  t -= slack + taut;
  return rest - (taut_speed - 0.5 * pull * t) * t;
}

int main(int argc, char** argv) {
  constexpr double apart = 10;  // [m/s], of the two
  show::Csv csv(argc, argv, "time,jumper,jumper exact,two bodies,two bodies exact");
  double error = 0;
  const bool same = show::same_on_both_places([&](Place place) {
    World world(WorldDef{.gravity = {0, -g, 0}});
    const auto strength = must(world.add_property<Real>("cord_stiffness", 0.0, "N/m", joint_table, Role::input));
    const auto add_body = [&](Vec3 at, Vec3 velocity, double mass) {
      BodyDef def;
      def.shapes = {ShapeDef::box({0.2, 0.9, 0.15})};
      def.mass = mass;
      def.pose.position = at;
      def.velocity = velocity;
      return must(world.create_body(def));
    };
    const auto tie = [&](SpringDef ends) {
      ends.rest_length = rest;
      must(world.set(strength, must(world.create_spring(ends)), Real(stiffness)));
    };
    const BodyId falls = add_body({0, 50, 0}, {}, jumper);
    const BodyId left = add_body({50, 50, 0}, {-apart * heavy / (light + heavy), 20, 0}, light);
    const BodyId right = add_body({50, 50, 0}, {apart * light / (light + heavy), 20, 0}, heavy);
    must(world.set_collide(left, right, false));
    tie({.a = world.ground(), .b = falls, .anchor_a = {0, 50, 0}, .anchor_b = {}});
    tie({.a = left, .b = right, .anchor_a = {}, .anchor_b = {}});
    Stepper stepper(show::at(place));
    must(stepper.add_kernel(world, {.text = cord::text(), .over = joint_table}));
    show::run(world, stepper, 5, [&](double t) {
      const double fallen = 50 - must(world.pose(falls)).position.y;
      const double wide = must(world.pose(right)).position.x - must(world.pose(left)).position.x;
      const double exact[] = {distance(g, 0, jumper, t), distance(0, apart, light * heavy / (light + heavy), t)};
      error = std::max({error, std::fabs(fallen - exact[0]), std::fabs(wide - exact[1])});
      csv.row(place, {t, fallen, exact[0], wide, exact[1]});
    });
    return world.hash();
  });
  std::printf("cord: largest error of a length %.1f mm, of up to %.1f m\n", 1000 * error, distance(g, 0, jumper, 3.5));
  return same && error < 2e-3 ? 0 : 1;
}
