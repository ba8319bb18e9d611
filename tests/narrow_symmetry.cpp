// Pins what must not matter: the order of the shapes, where and how the pair stands, the hint, tiny motion, and
// (up to rounding) the precision. Degenerate input gives finite output.
#include <doctest/doctest.h>

#include <cstring>
#include <limits>
#include <vector>

#include "tests/narrow_support.h"

using namespace narrow_test;

namespace {
constexpr double margin = 0.05;
constexpr int per_stratum = 150;

template <class S> bool same_bits(const Manifold<S>& m, const Manifold<S>& o) {
  bool same = m.count == o.count && (m.count == 0 || std::memcmp(m.normal, o.normal, sizeof m.normal) == 0);
  for (std::uint32_t i = 0; same && i < m.count; i++)  // not the padding between points
    same = std::memcmp(m.points[i].p, o.points[i].p, sizeof o.points[i].p) == 0 &&
           m.points[i].separation == o.points[i].separation && m.points[i].feature == o.points[i].feature;
  return same;
}
// Distance of two sets of points, separations included.
double apart(const Manifold<double>& m, const Manifold<double>& o) {
  double worst = m.count == o.count ? 0 : 1e30;
  for (std::uint32_t i = 0; i < m.count; i++) {
    double best = 1e30;
    for (std::uint32_t k = 0; k < o.count; k++)
      best =
          std::min(best, length(point(m, i) - point(o, k)) + std::abs(m.points[i].separation - o.points[k].separation));
    worst = std::max(worst, best);
  }
  return worst;
}
template <class Body> void for_pairs(std::initializer_list<Stratum> wanted, int count, Body body) {
  for (int ka = 0; ka < 5; ka++)
    for (int kb = ka; kb < 5; kb++)
      for (const Stratum stratum : wanted) {
        Pairs pairs(unsigned(5000 + ka * 100 + kb * 10 + int(stratum)));
        for (int i = 0; i < count; i++) {
          const auto [a, b] = pairs.pair(ShapeKind(ka), ShapeKind(kb), stratum);
          body(a, b, pairs);
        }
      }
}
}  // namespace

TEST_CASE("narrow: swapping the shapes flips the normal and keeps the points") {
  int pairs = 0, differ = 0;
  for_pairs({Stratum::anywhere, Stratum::near_touching, Stratum::uneven}, per_stratum,
            [&](const Shape& a, const Shape& b, Pairs&) {
              const Manifold<double> m = find(a, b, margin), s = find(b, a, margin);
              pairs++;
              // two cylinders: the search starts from the other side and stops within its tolerance
              const double tolerance = a.kind == ShapeKind::cylinder && b.kind == ShapeKind::cylinder ? 5e-4 : 1e-6;
              const bool same =
                  apart(m, s) < tolerance * scale(a, b) && (m.count == 0 || length(normal(m) + normal(s)) < tolerance);
              differ += !same;
              if (a.kind != b.kind) CHECK(same);
            });
  MESSAGE(pairs, " pairs, ", differ, " differ");
  CHECK(differ <= pairs / 200);
}

TEST_CASE("narrow: turning and moving both shapes turns and moves the manifold") {
  int pairs = 0, differ = 0;
  for_pairs({Stratum::anywhere, Stratum::near_touching}, per_stratum,
            [&](const Shape& a, const Shape& b, Pairs& random) {
              const Quat q = random.rotation();
              const Vec3 shift = random.ball(1);
              const Manifold<double> m = find(a, b, margin);
              Manifold<double> t = find(turned(a, q, shift), turned(b, q, shift), margin);
              const double off = m.count > 0 && t.count > 0 ? length(rotate(q, normal(m)) - normal(t)) : 0;
              for (std::uint32_t i = 0; i < t.count; i++) {
                const Vec3 back = rotate(conjugate(q), point(t, i) - shift);
                t.points[i].p[0] = back.x;
                t.points[i].p[1] = back.y;
                t.points[i].p[2] = back.z;
              }
              pairs++;
              // a cap is an octagon that turns with the cylinder; nothing may depend on the axes of the world
              differ += off > 1e-3 || apart(m, t) > 1e-3 * scale(a, b);
            });
  MESSAGE(pairs, " pairs, ", differ, " differ");
  CHECK(differ <= pairs / 100);
}

TEST_CASE("narrow: the hint changes nothing, in either precision") {
  int separated = 0;
  for_pairs({Stratum::anywhere, Stratum::near_touching, Stratum::aligned, Stratum::uneven}, per_stratum,
            [&](const Shape& a, const Shape& b, Pairs& random) {
              for (int axis = 0; axis < 20; axis++) {
                Shape c = b;
                move(c, random.ball(0.05));
                // a hint from anywhere: earlier poses, other pairs, noise
                std::uint32_t hint = axis < 16 ? std::uint32_t(axis) : 0;
                Manifold<double> m;
                if (axis >= 16) narrow(a, turned(c, random.rotation(), random.ball(1)), margin, hint, m);
                const std::uint32_t first = hint;
                narrow(a, c, margin, hint, m);
                const Manifold<double> plain = find(a, c, margin);
                REQUIRE(same_bits(m, plain));
                std::uint32_t hint_f = first;
                Manifold<float> f;
                narrow(to_float(a), to_float(c), float(margin), hint_f, f);
                const Manifold<float> plain_f = find(to_float(a), to_float(c), float(margin));
                REQUIRE(same_bits(f, plain_f));
                separated += m.count == 0;
              }
            });
  CHECK(separated > 1000);
}

TEST_CASE("narrow: features stay under tiny motion") {
  int pairs = 0, changed = 0;
  for_pairs({Stratum::anywhere, Stratum::near_touching, Stratum::parallel}, per_stratum,
            [&](const Shape& a, const Shape& b, Pairs& random) {
              Shape c = posed(b, centre(b) + random.ball(1e-7), axis_angle(random.direction(), 1e-7) * turn(b));
              pairs++;
              changed += features(find(a, b, margin)) != features(find(a, c, margin));
            });
  MESSAGE(pairs, " pairs, ", changed, " changed");
  CHECK(changed <= pairs / 50);
}

TEST_CASE("narrow: float and double agree") {
  int pairs = 0, counts = 0;
  for_pairs({Stratum::anywhere, Stratum::near_touching, Stratum::deep}, per_stratum,
            [&](const Shape& x, const Shape& y, Pairs&) {
              const auto fa = to_float(x), fb = to_float(y);
              const Shape a = to_double(fa), b = to_double(fb);
              const Manifold<float> f = find(fa, fb, float(margin));
              const Manifold<double> d = find(a, b, margin);
              pairs++;
              counts += f.count != d.count;
              if (f.count > 0 && d.count > 0)
                CHECK(std::abs(deepest(f) - deepest(d)) <
                      5e-4 * scale(a, b) + (a.kind == ShapeKind::box ? 6e-3 * std::min(smallest(a), smallest(b)) : 0));
            });
  MESSAGE(pairs, " pairs, ", counts, " with another number of points");
  CHECK(counts <= pairs / 25);
}

TEST_CASE("narrow: the same bits every time") {
  for_pairs({Stratum::anywhere, Stratum::deep}, 20,
            [&](const Shape& a, const Shape& b, Pairs&) { CHECK(same_bits(find(a, b, margin), find(a, b, margin))); });
}

TEST_CASE("narrow: degenerate input gives finite output") {
  const double tiny = 1e-30, large = 1e6;
  const std::vector<Vec3> places{{},          {tiny, 0, 0}, {0, -tiny, tiny}, {1e-12, 0, 0},
                                 {0.5, 0, 0}, {0, 0.5, 0},  {0.5, 0.5, 0.5},  {0, 1, 0},
                                 {1, 1, 0},   {1, 1, 1},    {large, 0, 0}};
  const double s = std::sqrt(0.5);
  const std::vector<Quat> turns{{},           {s, 0, 0, s},         {0, s, 0, s},     {0, 0, s, s},
                                {0, 1, 0, 0}, {0.5, 0.5, 0.5, 0.5}, {1e-20, 0, 0, 1}, {1e-7, 0, 0, 1},
                                {0, 0, 0, 0}};
  const std::vector<Vec3> sizes{{0.5, 0.5, 0.5}, {0.5, 1e-6, 0.5}, {1e-6, 1e-6, 1e-6},
                                {0.5, 0, 0},     {100, 0.5, 100},  {0, 0, 0}};
  // a hull is at least as large as make_hull lets it be
  std::vector<Shape> hulls;
  for (const Vec3& h : sizes) {
    const double least = std::max(2e-5, 2e-4 * std::max({h.x, h.y, h.z}));
    hulls.push_back(hull_shape(box_corners({std::max(h.x, least), std::max(h.y, least), std::max(h.z, least)})));
  }
  const auto of = [&](ShapeKind kind, const Vec3& size) {
    return kind == ShapeKind::hull ? hulls[std::size_t(&size - sizes.data())] : shape(kind, size);
  };
  int broken = 0, calls = 0;
  for (int ka = 0; ka < 6; ka++)
    for (int kb = 0; kb < 6; kb++)
      for (const Vec3& sa : sizes)
        for (const Vec3& sb : sizes)
          for (const Vec3& p : places)
            for (const Quat& q : turns) {
              const Shape a = of(ShapeKind(ka), sa), b = posed(of(ShapeKind(kb), sb), p, q);
              const Manifold<double> d = find(a, b, margin);
              const Manifold<float> f = find(to_float(a), to_float(b), float(margin));
              const auto good = [](const auto& m) {
                bool ok = m.count <= 4;
                for (std::uint32_t i = 0; ok && i < m.count; i++)
                  ok = pcphys::finite(point(m, i)) && std::isfinite(m.points[i].separation);
                return ok && (m.count == 0 || pcphys::finite(normal(m)));
              };
              calls++;
              if (!good(d) || !good(f)) {
                if (broken++ < 5)
                  MESSAGE(pair_name(a.kind, b.kind), " sizes ", sa.x, " ", sa.y, " / ", sb.x, " ", sb.y, " at ", p.x,
                          " ", p.y, " ", p.z, " turned ", q.x, " ", q.y, " ", q.z, " ", q.w);
              }
            }
  MESSAGE(calls, " calls");
  CHECK(broken == 0);
}
