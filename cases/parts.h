// What stiff and extreme cases are built of: floors, blocks, pins, chains, towers; and what they are judged by.
#pragma once
#include <string>
#include <vector>

#include "case.h"
#include "measures.h"

namespace pcphys::cases {

/// The half space below z = 0, moved by `offset`.
int add_floor(scenes::Builder& builder, Vec3 offset = {});
/// A box of 100 m whose top is at z = 0: its normal is z to the last bit, which that of a turned half space is not.
int add_level_floor(scenes::Builder& builder);
/// A box that moves, by half extents.
int add_block(scenes::Builder& builder, Vec3 half, double mass, const Pose& pose, Vec3 velocity = {});
/// A sphere that moves.
BodyDef ball(double mass, double radius, Vec3 centre, Vec3 velocity = {}, Vec3 spin = {});
int add_ball(scenes::Builder& builder, double radius, double mass, Vec3 centre, Vec3 velocity = {});
/// Rows of cubes on one another, one fewer in each, `base` in the lowest, in the plane y = 0 above z = 0.
struct Pyramid {
  int base = 10;
  double edge = 1, mass = 1;  // [m], [kg]
  double top_mass = mass;     // of the last cube
  double overlap = 0;         // of one row and the next, as a share of the edge
};
void add_pyramid(scenes::Builder& builder, const Pyramid& pyramid);
/// The library's human with joints that turn freely, as validation has them.
RagdollDef free_human();
void add_pin(scenes::Builder& builder, BodyId a, Vec3 at_a, BodyId b, Vec3 at_b,
             double largest_force = JointDef().largest_force);

/// Links of B1: boxes of 0.04 x 0.04 x 0.2 m and 1 kg along their z axis, the last one `ratio` times as heavy.
inline constexpr double link_length = 0.2;
/// The chain hangs from `top`, which is pinned to `anchor` at `at`; link k leans by angles[k] from straight down
/// towards x. Nothing of it collides.
void add_chain(scenes::Builder& builder, BodyId anchor, Vec3 at, Vec3 top, const std::vector<double>& angles,
               double ratio);
/// Angles of the slowest mode, 1 for the largest, and its period [s], linearised.
struct Mode {
  std::vector<double> angles;
  double period = 0;
};
Mode slowest_mode(int links, double ratio);

/// `count` cubes of 0.5 m and 1 kg on one another, on the floor, the highest one of `top_mass`; friction 0.8.
/// Cubes are bodies 1 to `count`.
inline constexpr double cube_edge = 0.5;
void add_tower(scenes::Builder& builder, int count, double top_mass = 1, Vec3 offset = {});
/// The cubes alone, on a level floor.
void add_level_tower(scenes::Builder& builder, int count);

/// How far boxes have moved from where they were built: across, and down [m].
struct Moved {
  double across = 0, down = 0;
};
Moved moved(const Simulated& run);
/// The door of A9b, driven and braked by its joint.
void door_with_motor(Trial& trial);
/// Bodies with a pose or velocity that is not finite.
double nonfinite(const Simulated& run);
/// The largest speed of a point of the bodies, half a metre from their centres [m/s].
double largest_speed(const Simulated& run);
/// Sum over contacts with overlap, and the deepest, as the last step left them [m].
double deepest_contact(const World& world);

}  // namespace pcphys::cases
