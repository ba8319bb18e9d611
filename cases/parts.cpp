#include "parts.h"

#include <algorithm>
#include <numbers>

namespace pcphys::cases {

int add_floor(scenes::Builder& builder, Vec3 offset) {
  BodyDef def;
  def.kind = BodyKind::fixed;
  def.shapes = {ShapeDef::plane()};
  def.pose = {offset, axis_angle({1, 0, 0}, 0.5 * std::numbers::pi)};
  return builder.add(def);
}

int add_level_floor(scenes::Builder& builder) { return builder.add_fixed_box({0, 0, -1}, {50, 50, 1}); }

int add_block(scenes::Builder& builder, Vec3 half, double mass, const Pose& pose, Vec3 velocity) {
  BodyDef def;
  def.shapes = {ShapeDef::box(half)};
  def.mass = mass;
  def.pose = pose;
  def.velocity = velocity;
  return builder.add(def);
}

BodyDef ball(double mass, double radius, Vec3 centre, Vec3 velocity, Vec3 spin) {
  BodyDef def;
  def.shapes = {ShapeDef::sphere(radius)};
  def.mass = mass;
  def.pose.position = centre;
  def.velocity = velocity;
  def.angular_velocity = spin;
  return def;
}

int add_ball(scenes::Builder& builder, double radius, double mass, Vec3 centre, Vec3 velocity) {
  return builder.add(ball(mass, radius, centre, velocity));
}

void add_pyramid(scenes::Builder& builder, const Pyramid& p) {
  const double half = 0.5 * p.edge, rise = 1 - p.overlap;
  for (int row = 0; row < p.base; ++row)
    for (int i = 0; i < p.base - row; ++i)
      add_block(builder, {half, half, half}, row + 1 == p.base ? p.top_mass : p.mass,
                {{p.edge * (i - 0.5 * (p.base - row)), 0, rise * (half + p.edge * row)}, {}});
}

RagdollDef free_human() {
  RagdollDef def = RagdollDef::human();
  def.set_damping(0);
  return def;
}

void add_pin(scenes::Builder& builder, BodyId a, Vec3 at_a, BodyId b, Vec3 at_b, double largest_force) {
  JointDef def;
  def.a = a;
  def.b = b;
  def.frame_a.position = at_a;
  def.frame_b.position = at_b;
  def.largest_force = largest_force;
  builder.add_joint(def);
}

// ---- chains --------------------------------------------------------------------------------------------

void add_chain(scenes::Builder& builder, BodyId anchor, Vec3 at, Vec3 top, const std::vector<double>& angles,
               double ratio) {
  BodyId above = anchor;
  for (std::size_t k = 0; k < angles.size(); ++k) {
    const Vec3 along = link_length * Vec3{std::sin(angles[k]), 0, -std::cos(angles[k])};
    BodyDef def;
    def.shapes = {ShapeDef::box({0.02, 0.02, 0.5 * link_length})};
    def.mass = k + 1 == angles.size() ? ratio : 1;
    def.pose = {top + 0.5 * along, exponential({0, -angles[k], 0})};
    const BodyId link = builder.id(builder.add(without_contacts(def)));
    add_pin(builder, above, k == 0 ? at : Vec3{0, 0, -0.5 * link_length}, link, {0, 0, 0.5 * link_length});
    above = link;
    top = top + along;
  }
}

// Kinetic energy: centres at x_k = l (sum over j < k of a_j + a_k / 2). Potential: diagonal in the angles.
Mode slowest_mode(int links, double ratio) {
  const std::size_t n = std::size_t(links);
  const auto mass = [&](std::size_t k) { return k + 1 == n ? ratio : 1.0; };
  const double own = (0.04 * 0.04 + link_length * link_length) / 12;  // of inertia, per mass
  std::vector<double> below(n + 1, 0);                                // mass of the links after k
  for (std::size_t k = n; k-- > 0;) below[k] = below[k + 1] + mass(k);
  std::vector<double> a(n, 1), next(n);
  double growth = 0;
  for (int iteration = 0; iteration < 300; ++iteration) {
    std::vector<double> x(n);  // of centres, over l
    double sum = 0;
    for (std::size_t k = 0; k < n; ++k) {
      x[k] = sum + 0.5 * a[k];
      sum += a[k];
    }
    double tail = 0, largest = 0;  // sum over later links of m x
    for (std::size_t j = n; j-- > 0;) {
      const double inertia = link_length * link_length * (tail + 0.5 * mass(j) * x[j]) + mass(j) * own * a[j];
      next[j] = inertia / (gravity * link_length * (below[j + 1] + 0.5 * mass(j)));
      tail += mass(j) * x[j];
      largest = std::max(largest, std::fabs(next[j]));
    }
    growth = largest;
    for (std::size_t j = 0; j < n; ++j) a[j] = next[j] / largest;
  }
  return {a, 2 * std::numbers::pi * std::sqrt(growth)};
}

// ---- towers --------------------------------------------------------------------------------------------

namespace {
void add_cubes(scenes::Builder& builder, int count, double top_mass, Vec3 offset) {
  const double half = 0.5 * cube_edge;
  for (int i = 0; i < count; ++i)
    add_block(builder, {half, half, half}, i + 1 == count ? top_mass : 1,
              {offset + Vec3{0, 0, half + cube_edge * i}, {}});
}

}  // namespace

void add_tower(scenes::Builder& builder, int count, double top_mass, Vec3 offset) {
  builder.set_material(0.8, 0);
  add_floor(builder, offset);
  add_cubes(builder, count, top_mass, offset);
}

void add_level_tower(scenes::Builder& builder, int count) {
  builder.set_material(0.8, 0);
  add_level_floor(builder);
  add_cubes(builder, count, 1, {});
}

// ---- judges --------------------------------------------------------------------------------------------

Moved moved(const Simulated& run) {
  Worst across, down;
  for (int i = 0; i < run.bodies(); ++i) {
    if (!run.moves(i)) continue;
    const Vec3 d = run.pose(i).position - run.problem().scene.bodies[std::size_t(i)].start.position;
    across.add(std::hypot(d.x, d.y));
    down.add(std::fabs(d.z));
  }
  return {across, down};
}

double nonfinite(const Simulated& run) {
  int count = 0;
  for (int i = 0; i < run.bodies(); ++i) {
    const Pose pose = run.pose(i);
    count += !(finite(pose.position) && finite(pose.orientation) && finite(run.velocity(i)) &&
               finite(run.angular_velocity(i)));
  }
  return count;
}

double largest_speed(const Simulated& run) {
  Worst speed;
  for (int i = 0; i < run.bodies(); ++i)
    if (run.moves(i)) speed.add(length(run.velocity(i)) + 0.5 * length(run.angular_velocity(i)));
  return speed;
}

double deepest_contact(const World& world) {
  double deepest = 0;
  for (const Contact& contact : world.contacts())
    for (const Contact::Point& point : contact.points) deepest = std::max(deepest, -point.separation);
  return deepest;
}

}  // namespace pcphys::cases
