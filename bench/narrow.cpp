// Nanoseconds for one pair in the narrow phase, on one core. Each case runs over 256 poses near one state, so that
// branches are as predictable as in a scene and no more.
#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <random>
#include <vector>

#include "collision/narrow.h"

namespace {
using namespace pcphys;

const Hull& hull_of(int vertices) {
  static std::map<int, Hull> hulls;
  Hull& hull = hulls[vertices];
  if (hull) return hull;
  std::vector<Vec3> points;
  for (int i = 0; i < vertices; i++) {
    const double y = 1 - 2 * (i + 0.5) / vertices, r = std::sqrt(1 - y * y), t = 2.39996322972865332 * i;
    points.push_back(vertices == 8 ? Vec3{i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5}
                                   : Vec3{0.5 * r * std::cos(t), 0.5 * y, 0.5 * r * std::sin(t)});
  }
  return hull = *make_hull(points);
}

template <class S> struct Pair {
  ShapeView<S> a, b;
  std::uint32_t hint = 0;
};

/// A hull's size is its number of vertices: 8 for the corners of a unit box, else a rock of 1 m.
template <class S> ShapeView<S> shape(ShapeKind kind, double x, double y, double z, Vec3 p, Quat q) {
  ShapeView<S> view{kind, {S(x), S(y), S(z)}, {S(p.x), S(p.y), S(p.z)}, {S(q.x), S(q.y), S(q.z), S(q.w)}};
  if (kind != ShapeKind::hull) return view;
  const Hull& hull = hull_of(int(x));
  view.size[0] = S(hull.radius());
  view.size[1] = S(hull.inner_radius());
  view.hull = hull.data();
  return view;
}

struct Case {
  ShapeKind a, b;
  Vec3 size_a, size_b, offset;
  double turn;  // random yaw [rad] of b
  double tilt;  // random rotation of a [rad]
};

template <class S> void run(benchmark::State& state, Case c) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> one(-1, 1);
  auto small = [&](double s) { return Vec3{s * one(random), s * one(random), s * one(random)}; };
  auto rotation = [&](Vec3 r) {
    const double l = length(r);
    return l > 0 ? axis_angle(1 / l * r, l) : Quat{};
  };
  std::vector<Pair<S>> pairs;
  for (int i = 0; i < 256; i++)
    pairs.push_back({shape<S>(c.a, c.size_a.x, c.size_a.y, c.size_a.z, {}, rotation(small(c.tilt))),
                     shape<S>(c.b, c.size_b.x, c.size_b.y, c.size_b.z, c.offset + small(1e-3),
                              axis_angle({0, 1, 0}, c.turn * one(random)))});
  Manifold<S> m;
  std::size_t points = 0, calls = 0;
  for (auto _ : state) {
    for (auto& p : pairs) {
      narrow(p.a, p.b, S(0.02), p.hint, m);
      points += m.count;
      benchmark::DoNotOptimize(m);
    }
    calls += pairs.size();
  }
  state.counters["points"] = double(points) / double(calls);
  state.counters["ns_per_pair"] =
      benchmark::Counter(double(calls) * 1e-9, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

const Vec3 unit{0.5, 0.5, 0.5};
const ShapeKind S = ShapeKind::sphere, K = ShapeKind::capsule, B = ShapeKind::box, C = ShapeKind::cylinder,
                H = ShapeKind::hull, P = ShapeKind::plane;
struct Named {
  const char* name;
  Case c;
};
const Named cases[] = {
    {"sphere_sphere", {S, S, {0.5, 0, 0}, {0.5, 0, 0}, {0, -1, 0}, 0, 0}},
    {"sphere_capsule", {S, K, {0.5, 0, 0}, {0.3, 0.5, 0}, {0, 0, 0.8}, 0, 0}},
    {"sphere_box", {S, B, {0.5, 0, 0}, unit, {0.2, -1, 0.1}, 0.5, 0}},
    {"sphere_box_corner", {S, B, {0.5, 0, 0}, unit, {0.75, 0.75, 0.75}, 0, 0}},
    {"sphere_plane", {S, P, {0.5, 0, 0}, {}, {0, -0.5, 0}, 0, 0}},
    {"capsule_capsule_crossing", {K, K, {0.2, 0.5, 0}, {0.2, 0.5, 0}, {0.1, 0, -0.4}, 0, 0.5}},
    {"capsule_capsule_parallel", {K, K, {0.2, 0.5, 0}, {0.2, 0.5, 0}, {0.1, 0, -0.39}, 0, 0.002}},
    {"capsule_box", {K, B, {0.2, 0.5, 0}, unit, {0, -1.2, 0}, 0.5, 0.1}},
    {"capsule_plane", {K, P, {0.2, 0.5, 0}, {}, {0, -0.7, 0}, 0, 0.1}},
    {"box_box_aligned", {B, B, unit, unit, {0, -1, 0}, 0, 0.001}},
    {"box_box_brick", {B, B, unit, unit, {0.5, -1, 0}, 0, 0.001}},
    {"box_box_turned", {B, B, unit, unit, {0.3, -1, 0.1}, 0.8, 0.001}},
    {"box_box_floor", {B, B, unit, {100, 0.5, 100}, {30, -1, 20}, 0, 0.001}},
    {"box_box_edges", {B, B, unit, unit, {0.9, -0.9, 0}, 0.8, 0.8}},
    {"box_box_apart_hinted", {B, B, unit, unit, {0.9, -1.1, 0}, 0.8, 0.01}},
    {"box_plane", {B, P, unit, {}, {0, -0.5, 0}, 0, 0.001}},
    {"cylinder_plane", {C, P, {0.5, 0.5, 0}, {}, {0, -0.5, 0}, 0, 0.001}},
    {"sphere_cylinder", {S, C, {0.5, 0, 0}, {0.5, 0.5, 0}, {0.1, -1, 0}, 0, 0}},
    {"cylinder_box_standing", {C, B, {0.5, 0.5, 0}, unit, {0.1, -1, 0}, 0.5, 0.001}},
    {"cylinder_box_apart", {C, B, {0.5, 0.5, 0}, unit, {0.8, -0.9, 0.7}, 0.5, 0.3}},
    {"cylinder_cylinder", {C, C, {0.5, 0.5, 0}, {0.5, 0.5, 0}, {0.1, -1, 0}, 0.5, 0.001}},
    {"hull_box_standing", {H, B, {8, 0, 0}, unit, {0.1, -1, 0}, 0.5, 0.001}},
    {"hull_hull_standing", {H, H, {8, 0, 0}, {8, 0, 0}, {0.1, -1, 0}, 0.5, 0.001}},
    {"hull_hull_edges", {H, H, {8, 0, 0}, {8, 0, 0}, {0.9, -0.9, 0}, 0.8, 0.8}},
    {"hull_hull_apart_hinted", {H, H, {8, 0, 0}, {8, 0, 0}, {0.9, -1.1, 0}, 0.8, 0.01}},
    {"rock_rock_16", {H, H, {16, 0, 0}, {16, 0, 0}, {0.1, -0.84, 0}, 0.5, 0.5}},
    {"rock_rock_32", {H, H, {32, 0, 0}, {32, 0, 0}, {0.1, -0.93, 0}, 0.5, 0.5}},
    {"rock_rock_64", {H, H, {64, 0, 0}, {64, 0, 0}, {0.1, -0.95, 0}, 0.5, 0.5}},
    {"rock_rock_32_apart", {H, H, {32, 0, 0}, {32, 0, 0}, {0.1, -1.005, 0}, 0.5, 0.5}},
    {"rock_box_32", {B, H, {100, 0.5, 100}, {32, 0, 0}, {0.1, 0.97, 0}, 0.5, 0}},
    {"rock_plane_32", {H, P, {32, 0, 0}, {}, {0, -0.47, 0}, 0, 0.5}},
    {"sphere_rock_32", {S, H, {0.5, 0, 0}, {32, 0, 0}, {0.1, -0.95, 0}, 0.5, 0}},
    {"capsule_rock_32", {K, H, {0.2, 0.5, 0}, {32, 0, 0}, {0.65, 0, 0}, 0.5, 0.1}},
    {"cylinder_rock_32", {C, H, {0.5, 0.5, 0}, {32, 0, 0}, {0.1, -0.95, 0}, 0.5, 0.001}},
    {"capsule_cylinder", {K, C, {0.2, 0.5, 0}, {0.5, 0.5, 0}, {0.69, 0, 0}, 0.5, 0.5}},
};

const bool registered = [] {
  for (const Named& n : cases) {
    benchmark::RegisterBenchmark((std::string("narrow/float/") + n.name).c_str(), run<float>, n.c);
    benchmark::RegisterBenchmark((std::string("narrow/double/") + n.name).c_str(), run<double>, n.c);
  }
  return true;
}();
}  // namespace
