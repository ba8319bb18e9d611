// Pins that what the detector does in lanes has the bits of the same text one by one: manifolds of every kind of pair
// that goes in lanes, of batches of any length, beside what `narrow` finds; motions of bodies; boxes, which hold their
// shapes.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <vector>

#include "collision/aabb.h"
#include "collision/pair_lanes.h"
#include "collision/twist.h"
#include "tests/narrow_support.h"

using namespace narrow_test;

namespace {
template <class Scalar> std::vector<std::uint32_t> widths() {
  std::vector<std::uint32_t> all;
  for (const std::uint32_t lanes : {1u, 4u, 8u})
    if (narrow_lanes<Scalar>(lanes).lanes == lanes) all.push_back(lanes);
  return all;
}
template <class Scalar> bool same_bits(const Manifold<Scalar>& m, const Manifold<Scalar>& o) {
  bool same = m.count == o.count && std::memcmp(m.normal, o.normal, sizeof m.normal) == 0;
  for (std::uint32_t i = 0; same && i < m.count; i++)
    same = std::memcmp(m.points[i].p, o.points[i].p, sizeof m.points[i].p) == 0 &&
           m.points[i].separation == o.points[i].separation && m.points[i].feature == o.points[i].feature;
  return same;
}
template <class Scalar> ShapeView<Scalar> in(const Shape& s) {
  if constexpr (std::is_same_v<Scalar, float>)
    return to_float(s);
  else
    return s;
}

/// Pairs of shapes of bodies, as the detector has them.
template <class Scalar> struct Batch {
  AlignedBytes rows;
  std::vector<std::uint32_t> a, b;
  AlignedBytes margins;
  std::vector<ShapeView<Scalar>> first, second;  // as `narrow` is to see them
  std::uint32_t count = 0;

  /// The shape b stands `apart` [m] further than the pair has it, and its body `-apart` from a's.
  void add(const Shape& one, const Shape& other, Vec3 apart, double margin) {
    const std::uint32_t row = 2 * count++;
    rows.resize((row + 2) * round_reals * sizeof(Scalar));
    first.push_back(in<Scalar>(one));
    Shape moved = other;
    move(moved, apart);
    second.push_back(in<Scalar>(moved));
    write(row, first.back(), {});
    write(row + 1, second.back(), -apart);
    const Scalar back[3] = {Scalar(-apart.x), Scalar(-apart.y), Scalar(-apart.z)}, low = Scalar(1e-9);
    for (int k = 0; k < 3; k++) second.back().p[k] += back[k] + low;
    a.push_back(row);
    b.push_back(row + 1);
    margins.resize(count * sizeof(Scalar));
    reinterpret_cast<Scalar*>(margins.data())[count - 1] = Scalar(margin);
  }
  Scalar margin(std::uint32_t i) const { return reinterpret_cast<const Scalar*>(margins.data())[i]; }
  PairBatch<Scalar> padded() {
    for (std::uint32_t i = count; i < count + 8; i++) a.push_back(0), b.push_back(1);
    margins.resize((count + 8) * sizeof(Scalar));
    return {reinterpret_cast<const Scalar*>(rows.data()), a.data(), b.data(),
            reinterpret_cast<const Scalar*>(margins.data()), count};
  }

 private:
  void write(std::uint32_t row, const ShapeView<Scalar>& s, Vec3 body) {
    Scalar* out = reinterpret_cast<Scalar*>(rows.data()) + row * round_reals;
    const double at[3] = {body.x, body.y, body.z};
    for (int k = 0; k < 3; k++)
      out[k] = s.p[k], out[8 + k] = Scalar(at[k]), out[12 + k] = row % 2 ? Scalar(1e-9) : Scalar(0);
    for (int k = 0; k < 4; k++) out[4 + k] = s.q[k];
    out[3] = s.size[0], out[11] = s.size[1], out[15] = s.size[2];
  }
};

struct Tally {
  int pairs = 0, touching = 0, open = 0, two = 0;
};
template <class Scalar> void check_batch(Batch<Scalar>& batch, std::uint32_t lanes, std::size_t kind, Tally& tally) {
  const PairBatch<Scalar> call = batch.padded();
  std::vector<Manifold<Scalar>> found(batch.count);
  std::vector<std::uint32_t> places(batch.count);
  const std::uint32_t n = narrow_lanes<Scalar>(lanes).run[kind](call, found.data(), places.data());
  std::uint32_t next = 0;
  for (std::uint32_t i = 0; i < batch.count; i++) {
    const Manifold<Scalar> alone = find(batch.first[i], batch.second[i], batch.margin(i));
    tally.pairs++;
    if (next < n && places[next] == i) {
      const Manifold<Scalar>& m = found[next++];
      tally.touching += m.count > 0;
      tally.open += m.count == 0;
      tally.two += m.count == 2;
      if (m.count > 0) CHECK(same_bits(m, alone));
    } else {
      CHECK(alone.count == 0);
    }
  }
  CHECK(next == n);
}

struct Sample {
  Shape a, b;
  Vec3 apart;
  double margin;
};
std::vector<Sample> samples(ShapeKind a, ShapeKind b, int count) {
  Pairs random(unsigned(100 + int(a) * 10 + int(b)));
  std::vector<Sample> all;
  for (int i = 0; i < count; i++) {
    const auto [x, y] = random.pair(a, b, strata[std::size_t(i) % strata.size()]);
    all.push_back({x, y, i % 3 ? random.ball(2) : Vec3{}, i % 5 ? 0.05 : 0.5});
  }
  return all;
}
template <class Scalar> void check_widths(PairKind kind, const std::vector<Sample>& pairs) {
  for (const std::uint32_t lanes : widths<Scalar>()) {
    CAPTURE(lanes);
    Tally tally;
    for (std::size_t count = 1, at = 0; at + count <= pairs.size(); at += count++) {  // batches of 1, 2, 3 ... pairs
      Batch<Scalar> batch;
      for (std::size_t i = at; i < at + count; i++) batch.add(pairs[i].a, pairs[i].b, pairs[i].apart, pairs[i].margin);
      check_batch(batch, lanes, std::size_t(kind), tally);
    }
    MESSAGE(lanes, " lanes: ", tally.pairs, " pairs, ", tally.touching, " touch, ", tally.two, " in two points, ",
            tally.open, " left open");
    CHECK(tally.touching > 50);
  }
}
void check_kind(PairKind kind, ShapeKind a, ShapeKind b) {
  CAPTURE(pair_name(a, b));
  REQUIRE(pair_kind(a, b) == kind);
  const std::vector<Sample> pairs = samples(a, b, 351);
  check_widths<float>(kind, pairs);
  check_widths<double>(kind, pairs);
}
}  // namespace

TEST_CASE("narrow: pairs in lanes have the bits of pairs alone") {
  check_kind(PairKind::spheres, ShapeKind::sphere, ShapeKind::sphere);
  check_kind(PairKind::capsules, ShapeKind::capsule, ShapeKind::capsule);
  check_kind(PairKind::sphere_box, ShapeKind::sphere, ShapeKind::box);
  check_kind(PairKind::capsule_box, ShapeKind::capsule, ShapeKind::box);
}

TEST_CASE("narrow: parallel capsules, and capsules that lie on boxes, keep their two points in lanes") {
  Pairs random(3);
  for (const std::uint32_t lanes : widths<float>()) {
    Tally lying, parallel;
    Batch<float> on_boxes, beside;
    for (int i = 0; i < 300; i++) {
      const double radius = random.between(0.05, 0.2), half = random.between(0.1, 0.6);
      const Quat q = random.rotation(),
                 along = Quat{0, 0, std::sin(0.25 * 3.14159265358979), std::cos(0.25 * 3.14159265358979)};
      const Vec3 up = rotate(q, {0, 1, 0});
      const Shape box = shape(ShapeKind::box, {3, 0.5, 3}, {}, q);
      on_boxes.add(
          shape(ShapeKind::capsule, {radius, half, 0}, (0.5 + radius + random.between(-0.01, 0.02)) * up, q * along),
          box, random.ball(1), 0.05);
      const Vec3 side = rotate(q, {1, 0, 0});
      beside.add(shape(ShapeKind::capsule, {radius, half, 0}, {}, q),
                 shape(ShapeKind::capsule, {radius, half, 0}, (2 * radius + random.between(-0.01, 0.02)) * side, q),
                 random.ball(1), 0.05);
    }
    check_batch(on_boxes, lanes, std::size_t(PairKind::capsule_box), lying);
    check_batch(beside, lanes, std::size_t(PairKind::capsules), parallel);
    CHECK(lying.two > 250);
    CHECK(lying.open == 0);
    CHECK(parallel.two > 250);
  }
}

TEST_CASE("narrow: few pairs, and pairs of kinds without lanes, are left") {
  PairLanes<float> lanes;
  Marks marks;
  lanes.begin(200);
  marks.clear(200);
  AlignedBytes rows;
  rows.resize(2 * round_reals * sizeof(float));
  for (const std::uint32_t pair : {7u, 130u}) lanes.add(PairKind::spheres, pair, 0, 1, 0.1f);
  lanes.leave(64);
  marks.set(64);
  lanes.run(narrow_lanes<float>(0), reinterpret_cast<const float*>(rows.data()), marks);
  std::vector<std::uint32_t> marked;
  marks.each([&](std::uint32_t i) {
    marked.push_back(i);
    CHECK(lanes.manifold(i) == nullptr);
  });
  CHECK(marked == std::vector<std::uint32_t>{7, 64, 130});
  CHECK(pair_kind(ShapeKind::box, ShapeKind::sphere) == PairKind::other);
  CHECK(pair_kind(ShapeKind::sphere, ShapeKind::capsule) == PairKind::other);
}

namespace {
constexpr std::uint32_t bodies = 37, room = 40;

template <class Scalar> struct Motions {
  AlignedBytes motion, mass, pose, twists;
  std::vector<std::uint32_t> rows;
  explicit Motions(unsigned seed) {
    Pairs random(seed);
    motion.resize(room * 8 * sizeof(Scalar)), mass.resize(room * 8 * sizeof(Scalar)),
        pose.resize(room * 16 * sizeof(Scalar));
    for (std::uint32_t row = 1; row < bodies; row++) {
      for (int k = 0; k < 8; k++)
        at(motion)[row * 8 + k] = Scalar(random.between(-3, 3)), at(mass)[row * 8 + k] = Scalar(random.between(0.1, 4));
      const Quat q = random.rotation();
      const double turn[4] = {q.x, q.y, q.z, q.w};
      for (int k = 0; k < 4; k++) at(pose)[row * 16 + 4 + k] = Scalar(turn[k]);
      rows.push_back(row);
    }
    rows.resize(room, 0);
  }
  static Scalar* at(AlignedBytes& bytes) { return reinterpret_cast<Scalar*>(bytes.data()); }
  const TwistOf<Scalar>* find(std::uint32_t lanes) {
    twists.resize(0);
    twists.resize(room * sizeof(TwistOf<Scalar>));
    narrow_lanes<Scalar>(lanes).twists({at(motion), at(mass), at(pose), rows.data(), bodies - 1, at(twists)});
    return reinterpret_cast<const TwistOf<Scalar>*>(twists.data());
  }
};
template <class Scalar> void check_motions(double tolerance) {
  Motions<Scalar> motions(11);
  AlignedBytes alone;
  alone.resize(room * sizeof(TwistOf<Scalar>));
  std::memcpy(alone.data(), motions.find(1), alone.size());
  for (const std::uint32_t lanes : widths<Scalar>())
    CHECK(std::memcmp(alone.data(), motions.find(lanes), alone.size()) == 0);
  const auto* twists = reinterpret_cast<const TwistOf<Scalar>*>(alone.data());
  for (std::uint32_t row = 1; row < bodies; row++) {
    const Scalar *m = motions.at(motions.motion) + row * 8, *i = motions.at(motions.mass) + row * 8 + 4,
                 *q = motions.at(motions.pose) + row * 16 + 4;
    const Quat turn{double(q[0]), double(q[1]), double(q[2]), double(q[3])};
    const Vec3 l = rotate(conjugate(turn), {double(m[4]), double(m[5]), double(m[6])}),
               local{i[0] * l.x, i[1] * l.y, i[2] * l.z};
    const Vec3 w = rotate(turn, local),
               found{double(twists[row].w[0]), double(twists[row].w[1]), double(twists[row].w[2])};
    CHECK(length(found - w) < tolerance);
    CHECK(std::abs(double(twists[row].turn) - length(w)) < tolerance);
    CHECK(std::abs(double(twists[row].across) - std::hypot(local.x, local.z)) < tolerance);
  }
}
}  // namespace

TEST_CASE("broad: motions of bodies in lanes have the bits of one alone") {
  check_motions<float>(3e-5);
  check_motions<double>(1e-13);
}

TEST_CASE("broad: boxes in lanes have the bits of one alone and hold their shapes, wherever these are") {
  Pairs random(12);
  constexpr std::uint32_t count = room - 3;
  AlignedBytes rows, columns, twists;
  rows.resize(room * round_reals * sizeof(float));
  columns.resize(room * bound_columns * sizeof(float));
  twists.resize(room * sizeof(Twist));
  float *row = reinterpret_cast<float*>(rows.data()), *column = reinterpret_cast<float*>(columns.data());
  std::vector<Shape> shapes;
  std::vector<std::uint32_t> body(room, 0);
  for (std::uint32_t i = 0; i < count; i++, row += round_reals) {
    const ShapeKind kind = ShapeKind(i % 4);
    const Vec3 size{random.between(0.1, 1), random.between(0.1, 1), random.between(0.1, 1)},
        at = random.ball(i % 2 ? 2 : 1e4);
    const Quat q = random.rotation();
    const float turn[4] = {float(q.x), float(q.y), float(q.z), float(q.w)},
                place[3] = {float(at.x), float(at.y), float(at.z)};
    shapes.push_back(to_double(ShapeView<float>{kind,
                                                {float(size.x), float(size.y), float(size.z)},
                                                {place[0], place[1], place[2]},
                                                {turn[0], turn[1], turn[2], turn[3]}}));
    std::copy_n(turn, 4, row + 4);
    std::copy_n(place, 3, row + 8);
    const bool box = kind == ShapeKind::box, ball = kind == ShapeKind::sphere;
    const float half[3] = {box ? float(size.x) : 0, ball ? 0 : float(size.y), box ? float(size.z) : 0};
    for (std::uint32_t k = 0; k < 3; k++) column[(3 + k) * room + i] = half[k];
    column[6 * room + i] = box ? 0 : float(size.x);
  }
  std::vector<float> reach(room);
  std::vector<Aabb> alone(room), boxes(room);
  const auto find = [&](std::uint32_t lanes, std::vector<Aabb>& out) {
    narrow_lanes<float>(lanes).boxes({reinterpret_cast<const float*>(rows.data()), column,
                                      reinterpret_cast<const float*>(twists.data()), body.data(), count, room,
                                      1.0f / 60, 0.0f, largest_turn, reach.data(), out.data()});
  };
  find(1, alone);
  for (const std::uint32_t lanes : widths<float>()) {
    find(lanes, boxes);
    CHECK(std::memcmp(boxes.data(), alone.data(), count * sizeof(Aabb)) == 0);
  }
  for (std::uint32_t i = 0; i < count; i++) {
    const Vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const double* p = shapes[i].p;
    for (int k = 0; k < 3; k++) {
      const double far = narrow_test::reach(shapes[i], axes[k]), slack = 1e-4 * far + 1e-6 * std::abs(p[k]);
      const double r = shapes[i].kind == ShapeKind::cylinder ? shapes[i].size[0] : 0;  // its capsule's box
      CHECK(double(alone[i].min[k]) <= p[k] - far);
      CHECK(double(alone[i].max[k]) >= p[k] + far);
      CHECK(double(alone[i].min[k]) >= p[k] - far - slack - r);
      CHECK(double(alone[i].max[k]) <= p[k] + far + slack + r);
    }
  }
}
