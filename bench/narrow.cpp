// Nanoseconds for one pair in the narrow phase, on one core. Each case runs over 256 poses near one state, so that
// branches are as predictable as in a scene and no more.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <vector>

#include "collision/narrow.h"

namespace {
using namespace pcphys;

template <class S> struct Pair {
  ShapeView<S> a, b;
  std::uint32_t hint = 0;
};

template <class S> ShapeView<S> shape(ShapeKind kind, double x, double y, double z, Vec3 p, Quat q) {
  return {kind, {S(x), S(y), S(z)}, {S(p.x), S(p.y), S(p.z)}, {S(q.x), S(q.y), S(q.z), S(q.w)}};
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
    pairs.push_back(
        {shape<S>(c.a, c.size_a.x, c.size_a.y, c.size_a.z, {}, rotation(small(c.tilt))),
         shape<S>(c.b, c.size_b.x, c.size_b.y, c.size_b.z, c.offset + small(1e-3), axis_angle({0, 1, 0}, c.turn * one(random)))});
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
const ShapeKind S = ShapeKind::sphere, K = ShapeKind::capsule, B = ShapeKind::box, C = ShapeKind::cylinder, P = ShapeKind::plane;
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
