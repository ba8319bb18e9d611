// Pins normals and separations against what is known apart from the kernels: separation along any normal is a
// lower bound, the distance of any two points an upper one; brute force finds the best of both. FCL is a
// second opinion on many more pairs. Caught so far: polytopes turned inside out by points in one plane (caps
// of coincident cylinders), box corners beyond the reference face.
#include <doctest/doctest.h>

#include <cstdlib>

#include "tests/narrow_support.h"

using namespace narrow_test;

namespace {
int pairs_wanted(int standard) {
  const char* text = std::getenv("PCPHYS_NARROW_PAIRS");
  return text ? std::atoi(text) : standard;
}
// Boxes prefer a face to an edge that separates more by less than this (kernels/narrow/narrow_types.inl).
double preference(const Shape& a, const Shape& b) {
  return a.kind == ShapeKind::box && b.kind == ShapeKind::box ? 6e-3 * std::min(smallest(a), smallest(b)) : 0;
}
struct Worst {
  double normal = 0, separation = 0, degrees = 0;
  int missed = 0, ghosts = 0, broken = 0;
};

template <class M>
void judge(const Shape& a, const Shape& b, const Bounds& known, const M& m, double margin, Worst& worst) {
  const double size = scale(a, b), slop = preference(a, b);
  const bool apart = known.high > 1e-7;
  if (!finite(m)) {
    worst.broken++;
    return;
  }
  if (m.count == 0) {
    worst.missed += (apart ? known.high : known.low) < margin - 1e-3 * size;
    return;
  }
  worst.ghosts += known.low > margin + 1e-3 * size;
  const Vec3 n = 1 / length(normal(m)) * normal(m);
  const double along = separation_along(a, b, n), found = deepest(m);
  // no other normal separates more
  worst.normal = std::max(worst.normal, (known.low - along - slop) / size);
  // the deepest point is as deep as the shapes are: along this normal, or at their distance
  const double off = apart ? std::max(found - known.high, known.low - found) : std::abs(found - along);
  worst.separation = std::max(worst.separation, (off - slop) / size);
  if (known.low > 0.03 && known.high - known.low < 1e-5 * known.low && slop == 0)
    worst.degrees = std::max(worst.degrees, 57.29578 * std::acos(std::min(1.0, dot(n, known.normal))));
}
}  // namespace

TEST_CASE("narrow: no normal separates more, and the deepest point is that deep") {
  const double margin = 0.1;
  const int count = pairs_wanted(700) / int(strata.size());
  for (int ka = 0; ka < 5; ka++)
    for (int kb = ka; kb < 5; kb++)
      for (const Stratum stratum : strata) {
        Pairs pairs(unsigned(1 + ka * 100 + kb * 10 + int(stratum)));
        Worst single, twofold;
        for (int i = 0; i < count; i++) {
          const auto [x, y] = pairs.pair(ShapeKind(ka), ShapeKind(kb), stratum);
          const auto fa = to_float(x), fb = to_float(y);
          const Shape a = to_double(fa), b = to_double(fb);
          const Bounds known = bounds(a, b);
          judge(a, b, known, find(fa, fb, float(margin)), margin, single);
          judge(a, b, known, find(a, b, margin), margin, twofold);
        }
        const bool uneven = stratum == Stratum::uneven;  // shapes of 100 m: a float's rounding of them is 4e-6 m
        const std::string who = pair_name(ShapeKind(ka), ShapeKind(kb));
        CAPTURE(who);
        const std::string where = stratum_names[std::size_t(stratum)];
        CAPTURE(where);
        for (const Worst* w : {&single, &twofold}) {
          CHECK(w->broken == 0);
          CHECK(w->missed == 0);
          CHECK(w->ghosts == 0);
        }
        // coincident cylinders are as near to the surface all around: the polytope runs out of vertices
        const double coincident = stratum == Stratum::coincident ? 1e-2 : 0;
        // four of many corners: another one may be deeper by PC_FLAT_SLOP of the reach; caps are clipped as octagons
        const auto many = [](int kind) {
          return ShapeKind(kind) == ShapeKind::cylinder || ShapeKind(kind) == ShapeKind::hull;
        };
        const double depth =
            kb > int(ShapeKind::capsule) && ka > int(ShapeKind::capsule) && (many(ka) || many(kb)) ? 2e-3 : 2e-4;
        CHECK(twofold.normal < 2e-4 + coincident);
        CHECK(twofold.separation < depth);
        CHECK(twofold.degrees < 2);
        CHECK(single.normal < (uneven ? 5e-3 : 2e-4) + coincident);
        CHECK(single.separation < (uneven ? 1e-3 : 2e-4) + depth);
      }
}

TEST_CASE("narrow: never shallower than FCL, and as far apart") {
  if (!fcl_available()) {
    MESSAGE("built without FCL");
    return;
  }
  const int count = pairs_wanted(5000);
  for (int ka = 0; ka < 5; ka++)
    for (int kb = ka; kb < 5; kb++) {
      Pairs pairs(unsigned(ka * 4 + kb));
      int apart = 0, overlapping = 0, equal = 0, far_off = 0, shallower = 0, gave_up = 0, deeper = 0;
      for (int i = 0; i < count; i++) {
        Shape a = pairs.random_shape(ShapeKind(ka)), b = pairs.random_shape(ShapeKind(kb));
        const Vec3 d = pairs.direction();
        place(b, (pairs.between(0.2, 1.1) * (reach(a, d) + reach(b, -d))) * d);
        const Manifold<double> m = find(a, b, 10);
        double oracle = 0;
        if (!distance_fcl(a, b, oracle)) {
          gave_up++;
          continue;
        }
        const double found = deepest(m), size = scale(a, b), slop = preference(a, b) + 1e-4 * size;
        if (oracle > 1e-4 * size) {
          apart++;
          equal += std::abs(found - oracle) <= slop;
          far_off += std::abs(found - oracle) > slop;
        } else if (oracle < -1e-4 * size) {
          overlapping++;
          // FCL reports a way out, so the shortest one is no longer: ours must not be either
          shallower += found < oracle - slop;
          deeper += found > oracle + 1e-2 * size;
        }
      }
      MESSAGE(pair_name(ShapeKind(ka), ShapeKind(kb)), ": ", apart, " apart, ", equal, " of them equal; ", overlapping,
              " overlapping, FCL's way out longer by over 1 % in ", deeper, ", ours in ", shallower,
              "; FCL gave up on ", gave_up);
      CHECK(far_off <= apart / 1000);
      CHECK(shallower <= overlapping / 1000);
    }
}

TEST_CASE("narrow: FCL as the narrow phase gives manifolds of the same form") {
  if (!fcl_available()) return;
  const Shape box = shape(ShapeKind::box, {0.5, 0.5, 0.5}), below = shape(ShapeKind::box, {2, 0.5, 2}, {0.1, -0.99, 0});
  Manifold<float> m;
  REQUIRE(narrow_fcl(to_float(box), to_float(below), 0.05f, m));
  CHECK(m.count == 4);
  CHECK(length(normal(m) - Vec3{0, -1, 0}) < 1e-6);
  CHECK(std::abs(deepest(m) + 0.01) < 1e-6);
  const Shape ball = shape(ShapeKind::sphere, {0.5, 0, 0}, {0, 0.52, 0}), floor = shape(ShapeKind::plane, {});
  REQUIRE(narrow_fcl(to_float(ball), to_float(floor), 0.05f, m));
  CHECK(m.count == 1);
  CHECK(length(normal(m) - Vec3{0, -1, 0}) < 1e-6);
  CHECK(std::abs(deepest(m) - 0.02) < 1e-6);
  REQUIRE(narrow_fcl(to_float(ball), to_float(shape(ShapeKind::capsule, {0.2, 0.5, 0}, {0.71, 0.52, 0})), 0.05f, m));
  CHECK(m.count == 1);
  CHECK(length(normal(m) - Vec3{1, 0, 0}) < 1e-4);
}
