// Any points: `make_hull` refuses them by name, or makes a convex polyhedron that is closed, has an inside, plane faces
// and all the points within it, and that falls on a floor as a body. The first byte says how the others are read:
// numbers as they stand, or places on a grid, where points are apart often enough.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <vector>

#include "expect.h"
#include "pcphys/constants.h"
#include "pcphys/pcphys.h"
#include "seeds.h"
#include "world/hull.h"

namespace {

using namespace pcphys;

enum class Form : std::uint8_t { real64, real32, grid, fine_grid };

template <class Number> std::vector<double> numbers(const std::uint8_t* data, std::size_t size) {
  std::vector<double> all;
  for (; size >= sizeof(Number); data += sizeof(Number), size -= sizeof(Number)) {
    Number value;
    std::memcpy(&value, data, sizeof value);
    all.push_back(double(value));
  }
  return all;
}

std::vector<Vec3> points_of(std::uint8_t head, const std::uint8_t* data, std::size_t size) {
  std::vector<double> all;
  switch (Form(head & 3)) {
    case Form::real64: all = numbers<double>(data, size); break;
    case Form::real32: all = numbers<float>(data, size); break;
    case Form::grid: all = numbers<std::int8_t>(data, size); break;
    case Form::fine_grid: all = numbers<std::int16_t>(data, size); break;
  }
  const double scale = std::ldexp(1.0, (head >> 2) - 32);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i + 2 < all.size(); i += 3) points.push_back(scale * Vec3{all[i], all[i + 1], all[i + 2]});
  return points;
}

void check_refusal(const Error& error) {
  const ErrorCode code = error.code;
  fuzz::expect(code == ErrorCode::degenerate_shape || code == ErrorCode::buffer_full || code == ErrorCode::not_finite,
               "another error: " + error.message);
}

/// Every side of a face is one of another face, the other way round.
void check_closed(const Hull& hull) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> sides;
  for (std::size_t f = 0; f < hull.face_count(); f++) {
    const auto face = hull.face(f);
    fuzz::expect(face.size() >= 3, "a face of fewer than three corners");
    for (std::size_t k = 0; k < face.size(); k++)
      fuzz::expect(sides.insert({face[k], face[(k + 1) % face.size()]}).second,
                   "a side of two faces the same way round");
  }
  for (const auto& [from, to] : sides) fuzz::expect(sides.contains({to, from}), "a side of one face alone");
  fuzz::expect(hull.vertices().size() + hull.face_count() == sides.size() / 2 + 2, "not the faces of one polyhedron");
}

void check_numbers(const Hull& hull) {
  const Vec3 i = hull.moments();
  constexpr double slack = 1 + 1e-9;
  fuzz::expect(std::isfinite(hull.volume()) && hull.volume() > 0, "no volume");
  fuzz::expect(hull.inner_radius() > 0 && hull.inner_radius() <= hull.radius() && std::isfinite(hull.radius()),
               "radii");
  fuzz::expect(i.x > 0 && i.y > 0 && i.z > 0, "moments");
  fuzz::expect(i.x <= (i.y + i.z) * slack && i.y <= (i.x + i.z) * slack && i.z <= (i.x + i.y) * slack,
               "moments of no body");
  for (const float x : hull.data()->table.f32) fuzz::expect(std::isfinite(x), "table");
}

void check_planes(const Hull& hull, const std::vector<Vec3>& points) {
  const Pose frame = hull.frame();
  const double tolerance = 10 * constants::hull_planarity * hull.radius() + 1e-14 * length(frame.position);
  for (std::size_t f = 0; f < hull.face_count(); f++) {
    const Vec3 n = hull.data()->normals[f], on = hull.vertices()[hull.face(f)[0]];
    fuzz::expect(std::fabs(length(n) - 1) < 1e-9, "normal");
    for (const std::uint32_t v : hull.face(f))
      fuzz::expect(std::fabs(dot(hull.vertices()[v] - on, n)) <= tolerance, "a face that is not plane");
    for (const Vec3& v : hull.vertices()) fuzz::expect(dot(v - on, n) <= tolerance, "not convex");
    for (const Vec3& p : points) {
      const Vec3 own = rotate(conjugate(frame.orientation), p - frame.position);
      fuzz::expect(dot(own - on, n) <= tolerance, "a point outside");
    }
  }
}

/// A body of it just above a floor.
void check_falls(const Hull& hull, Precision precision) {
  World world(WorldDef{precision, {}});
  BodyDef floor, body;
  floor.kind = BodyKind::fixed;
  floor.shapes = {ShapeDef::plane()};
  body.shapes = {ShapeDef::hull(hull)};
  double lowest = 0;
  for (const Vec3& v : hull.vertices()) lowest = std::min(lowest, v.y);
  body.pose.position = {0, -1.001 * lowest, 0};
  (void)fuzz::expect(world.create_body(floor));
  const Result<BodyId> made = world.create_body(body);
  if (!made) return;  // a mass out of range
  Stepper stepper({.substeps = 2});
  for (int i = 0; i < 4; i++)
    if (const StepReport& report = stepper.step(world, 1.0 / 60); !report) fuzz::expect(report.error);
  const Pose pose = fuzz::expect(world.pose(*made));
  fuzz::expect(finite(pose.position) && pose.position.y > -hull.radius(), "it fell through the floor");
}

}  // namespace

std::size_t fuzz::number_bytes(std::uint8_t head) {
  const Form form = Form(head & 3);
  return form == Form::real64 ? sizeof(double) : form == Form::real32 ? sizeof(float) : 0;
}

std::vector<std::vector<std::uint8_t>> fuzz::seeds() {
  const auto head = [](Form form, int exponent) { return std::uint8_t(unsigned(form) | unsigned(exponent + 32) << 2); };
  std::vector<std::uint8_t> cube{head(Form::grid, 0)}, ball{head(Form::grid, -6)}, wedge{head(Form::fine_grid, -8)},
      real{head(Form::real64, 0)};
  for (int i = 0; i < 8; i++)
    for (int c = 0; c < 3; c++) cube.push_back(std::uint8_t(i >> c & 1 ? 1 : -1));
  for (int i = 0; i < 40; i++) {
    const double y = 1 - (2 * i + 1) / 40.0, r = std::sqrt(1 - y * y), turn = 2.4 * i;
    for (const double x : {r * std::cos(turn), y, r * std::sin(turn)})
      ball.push_back(std::uint8_t(std::int8_t(std::lround(100 * x))));
  }
  for (const int x : {0, 0, 0, 1000, 0, 0, 0, 1000, 0, 0, 0, 2, 1000, 0, 3, 0, 1000, 1})
    for (int b = 0; b < 2; b++) wedge.push_back(std::uint8_t(x >> (8 * b)));
  for (const double x : {0.0, 0.0, 0.0, 1.0, 0.1, 0.0, 0.0, 1.0, 0.3, 0.2, 0.1, 1.0, 0.5, 0.5, 0.5, 0.9, 0.9, 0.2}) {
    std::uint8_t bytes[sizeof x];
    std::memcpy(bytes, &x, sizeof x);
    real.insert(real.end(), bytes, bytes + sizeof x);
  }
  return {cube, ball, wedge, real};
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::vector<Vec3> points = points_of(data[0], data + 1, size - 1);
  const Result<Hull> hull = make_hull(points);
  if (!hull) {
    check_refusal(hull.error());
    return 0;
  }
  check_numbers(*hull);
  check_closed(*hull);
  check_planes(*hull, points);
  check_falls(*hull, points.size() % 2 ? Precision::f64 : Precision::f32);
  return 0;
}
