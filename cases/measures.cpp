#include "measures.h"

#include <algorithm>
#include <sstream>

#include "reference.h"

namespace pcphys::cases {

double Csv::at(std::size_t row, std::string_view column) const {
  const auto found = std::find(columns.begin(), columns.end(), column);
  if (found == columns.end() || row >= rows.size()) return std::numeric_limits<double>::quiet_NaN();
  return rows[row][std::size_t(found - columns.begin())];
}

Vec3 Csv::vector(std::size_t row, const std::string& name) const {
  return {at(row, name + "x"), at(row, name + "y"), at(row, name + "z")};
}

Quat Csv::quaternion(std::size_t row, const std::string& name) const {
  return {at(row, name + "x"), at(row, name + "y"), at(row, name + "z"), at(row, name + "w")};
}

Csv read_csv(std::string_view file) {
  Csv csv;
  const char* text = reference_source(file);
  if (text == nullptr) return csv;
  std::istringstream in(text);
  std::string line, field;
  while (std::getline(in, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream fields(line);
    if (csv.columns.empty()) {
      while (std::getline(fields, field, ',')) csv.columns.push_back(field);
      continue;
    }
    std::vector<double>& row = csv.rows.emplace_back();
    while (std::getline(fields, field, ',')) row.push_back(std::stod(field));
  }
  return csv;
}

double error_of_components(Vec3 found, Vec3 expected, double scale) {
  const double none = 1e-14 * scale;
  Worst worst;
  for (const auto& [now, wanted] : {std::pair{found.x, expected.x}, {found.y, expected.y}, {found.z, expected.z}})
    worst.add(std::fabs(now - wanted) / (std::fabs(wanted) > none ? std::fabs(wanted) : scale));
  return worst;
}

Quat exponential(Vec3 rotation) {
  const double angle = length(rotation);
  return angle > 0 ? axis_angle((1 / angle) * rotation, angle) : Quat{};
}

double angle_between(Quat a, Quat b) {
  const Quat d = conjugate(a) * b;
  return 2 * std::atan2(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z), std::fabs(d.w));
}

Vec3 Neighbours::angular_velocity() const {
  Quat d = after.orientation * conjugate(before.orientation);
  if (d.w < 0) d = {-d.x, -d.y, -d.z, -d.w};
  const Vec3 v{d.x, d.y, d.z};
  const double s = length(v);
  return (s > 0 ? std::atan2(s, d.w) / (s * dt) : 0) * v;
}

double Neighbours::energy(const MassProperties& mass, Vec3 gravity) const {
  const Vec3 v = velocity(), w = rotate(conjugate(now.orientation), angular_velocity()), i = mass.moments;
  return 0.5 * mass.mass * dot(v, v) + 0.5 * (i.x * w.x * w.x + i.y * w.y * w.y + i.z * w.z * w.z) -
         mass.mass * dot(gravity, now.position);
}

Vec3 spin_momentum(const Simulated& run, int body) {
  const Quat q = run.pose(body).orientation;
  const Vec3 w = rotate(conjugate(q), run.angular_velocity(body)), i = run.mass(body).moments;
  return rotate(q, {i.x * w.x, i.y * w.y, i.z * w.z});
}

double kinetic_energy(const Simulated& run) {
  double sum = 0;
  for (int i = 0; i < run.bodies(); ++i) {
    if (!run.moves(i)) continue;
    const Vec3 v = run.velocity(i), w = run.angular_velocity(i);
    sum += 0.5 * run.mass(i).mass * dot(v, v) + 0.5 * dot(w, spin_momentum(run, i));
  }
  return sum;
}

double energy(const Simulated& run) {
  const Vec3 g = run.problem().world.gravity();
  double sum = kinetic_energy(run);
  for (int i = 0; i < run.bodies(); ++i)
    if (run.moves(i)) sum -= run.mass(i).mass * dot(g, run.pose(i).position);
  return sum;
}

Vec3 momentum(const Simulated& run) {
  Vec3 sum;
  for (int i = 0; i < run.bodies(); ++i)
    if (run.moves(i)) sum = sum + run.mass(i).mass * run.velocity(i);
  return sum;
}

Vec3 angular_momentum(const Simulated& run) {
  Vec3 sum;
  for (int i = 0; i < run.bodies(); ++i)
    if (run.moves(i))
      sum = sum + run.mass(i).mass * cross(run.pose(i).position, run.velocity(i)) + spin_momentum(run, i);
  return sum;
}

double joint_gap(const Simulated& run) {
  const scenes::Scene& scene = run.problem().scene;
  static thread_local std::vector<int> places;  // of bodies in the scene, by the index of their id
  for (int i = 0; i < run.bodies(); ++i) {
    const std::size_t index = scene.bodies[std::size_t(i)].id.index;
    if (places.size() <= index) places.resize(index + 1);
    places[index] = i;
  }
  const auto pin = [&](BodyId id, Vec3 local) {
    if (id == run.problem().world.ground()) return local;
    return transform(run.pose(places[id.index]), local);
  };
  Worst worst;
  for (int k = 0; k < int(scene.joints.size()); ++k) {
    const JointDef joint = run.joint(k);
    if (joint.yields()) continue;  // it is there to give way
    worst.add(length(pin(joint.a, joint.frame_a.position) - pin(joint.b, joint.frame_b.position)));
  }
  return worst;
}

Vec3 thrown(Vec3 v0, Vec3 a, double drag, double t) {
  if (drag == 0) return t * v0 + (0.5 * t * t) * a;
  const double phi = -std::expm1(-drag * t) / drag;
  return (t / drag) * a + phi * (v0 - (1 / drag) * a);
}

void pin(scenes::Builder& builder, BodyId a, Vec3 at_a, int b, Vec3 at_b) {
  JointDef def;
  def.a = a;
  def.b = builder.id(b);
  def.frame_a.position = at_a;
  def.frame_b.position = at_b;
  builder.add_joint(def);
}

BodyDef hanging_rod(double angle) {
  BodyDef def;
  def.shapes = {ShapeDef::box({0.05, 0.05, 0.5})};
  def.mass = 1;
  def.pose = {0.5 * Vec3{std::sin(angle), 0, -std::cos(angle)}, exponential({0, -angle, 0})};
  return without_contacts(def);
}

double rod_frequency() { return std::sqrt(gravity * 0.5 / (0.25 + (1 + 0.01) / 12)); }

BodyDef floor_plane(Quat orientation) {
  BodyDef def;
  def.kind = BodyKind::fixed;
  def.shapes = {ShapeDef::plane()};
  def.pose.orientation = orientation * axis_angle({1, 0, 0}, std::acos(0.0));  // a plane's own normal is y
  return def;
}

BodyDef free_body(double mass, Vec3 moments, Vec3 velocity) {
  BodyDef def;
  def.shapes = {ShapeDef::sphere(0.1)};
  def.mass = mass;
  def.moments = moments;
  def.velocity = velocity;
  return without_contacts(def);
}

BodyDef without_contacts(BodyDef def) {
  for (ShapeDef& shape : def.shapes) shape.filter.mask = 0;
  return def;
}

}  // namespace pcphys::cases
