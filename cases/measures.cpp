#include "measures.h"

#include <algorithm>
#include <limits>
#include <sstream>

#include "reference.h"

namespace pcphys::cases {
namespace {

Vec3 spin_momentum(const Simulated& run, int body) {
  const Quat q = run.pose(body).orientation;
  const Vec3 w = rotate(conjugate(q), run.angular_velocity(body)), i = run.mass(body).moments;
  return rotate(q, {i.x * w.x, i.y * w.y, i.z * w.z});
}

}  // namespace

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

Quat exponential(Vec3 rotation) {
  const double angle = length(rotation);
  return angle > 0 ? axis_angle((1 / angle) * rotation, angle) : Quat{};
}

double angle_between(Quat a, Quat b) {
  const Quat d = conjugate(a) * b;
  return 2 * std::atan2(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z), std::fabs(d.w));
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
    if (run.moves(i)) sum = sum + run.mass(i).mass * cross(run.pose(i).position, run.velocity(i)) + spin_momentum(run, i);
  return sum;
}

double joint_gap(const Simulated& run) {
  const scenes::Scene& scene = run.problem().scene;
  const auto pin = [&](BodyId id, Vec3 local) {
    for (int i = 0; i < run.bodies(); ++i)
      if (scene.bodies[std::size_t(i)].id == id) return transform(run.pose(i), local);
    return local;  // the ground
  };
  Worst worst;
  for (int k = 0; k < int(scene.joints.size()); ++k) {
    const JointDef joint = run.joint(k);
    worst.add(length(pin(joint.a, joint.frame_a.position) - pin(joint.b, joint.frame_b.position)));
  }
  return worst;
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
