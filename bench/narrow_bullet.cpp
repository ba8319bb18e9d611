// The same pairs of hulls in Bullet: btConvexConvexAlgorithm with its persistent manifold, beside narrow/float/*.
#ifdef PCPHYS_HAVE_BULLET
#include <benchmark/benchmark.h>
#include <btBulletCollisionCommon.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

namespace {

struct Case {
  const char* name;
  int a, b;  // vertices: 8 for a unit box, else a rock of 1 m
  btVector3 offset;
  double turn, tilt;  // as in narrow.cpp
};

std::unique_ptr<btConvexHullShape> hull(int vertices) {
  auto shape = std::make_unique<btConvexHullShape>();
  for (int i = 0; i < vertices; i++) {
    const double y = 1 - 2 * (i + 0.5) / vertices, r = std::sqrt(1 - y * y), t = 2.39996322972865332 * i;
    shape->addPoint(
        vertices == 8 ? btVector3(i & 1 ? 0.5f : -0.5f, i & 2 ? 0.5f : -0.5f, i & 4 ? 0.5f : -0.5f)
                      : btVector3(btScalar(0.5 * r * std::cos(t)), btScalar(0.5 * y), btScalar(0.5 * r * std::sin(t))),
        false);
  }
  shape->recalcLocalAabb();
  return shape;
}

btCollisionObjectWrapper wrap(const btCollisionObject& object) {
  return btCollisionObjectWrapper(nullptr, object.getCollisionShape(), &object, object.getWorldTransform(), -1, -1);
}

void run(benchmark::State& state, Case c) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> one(-1, 1);
  const auto small = [&](double s) {
    return btVector3(btScalar(s * one(random)), btScalar(s * one(random)), btScalar(s * one(random)));
  };
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDispatcherInfo info;
  const auto shape_a = hull(c.a), shape_b = hull(c.b);
  struct Pair {
    btCollisionObject a, b;
    btCollisionAlgorithm* algorithm = nullptr;
  };
  std::vector<std::unique_ptr<Pair>> pairs;
  for (int i = 0; i < 256; i++) {
    auto pair = std::make_unique<Pair>();
    const btVector3 tilt = small(c.tilt);
    pair->a.setCollisionShape(shape_a.get());
    pair->b.setCollisionShape(shape_b.get());
    if (tilt.length() > 0) pair->a.setWorldTransform(btTransform(btQuaternion(tilt.normalized(), tilt.length())));
    const btVector3 p = c.offset + small(1e-3);
    pair->b.setWorldTransform(btTransform(btQuaternion(btVector3(0, 1, 0), btScalar(c.turn * one(random))), p));
    const btCollisionObjectWrapper a = wrap(pair->a), b = wrap(pair->b);
    pair->algorithm = dispatcher.findAlgorithm(&a, &b, nullptr, BT_CONTACT_POINT_ALGORITHMS);
    pairs.push_back(std::move(pair));
  }
  std::size_t calls = 0, points = 0;
  for (auto _ : state) {
    for (auto& pair : pairs) {
      const btCollisionObjectWrapper a = wrap(pair->a), b = wrap(pair->b);
      btManifoldResult result(&a, &b);
      pair->algorithm->processCollision(&a, &b, info, &result);
      points += result.getPersistentManifold() ? std::size_t(result.getPersistentManifold()->getNumContacts()) : 0;
    }
    calls += pairs.size();
  }
  for (auto& pair : pairs) {
    pair->algorithm->~btCollisionAlgorithm();
    dispatcher.freeCollisionAlgorithm(pair->algorithm);
  }
  state.counters["points"] = double(points) / double(calls);
  state.counters["ns_per_pair"] =
      benchmark::Counter(double(calls) * 1e-9, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

const bool registered = [] {
  const Case cases[] = {{"hull_hull_standing", 8, 8, {0.1f, -1, 0}, 0.5, 0.001},
                        {"hull_hull_edges", 8, 8, {0.9f, -0.9f, 0}, 0.8, 0.8},
                        {"rock_rock_16", 16, 16, {0.1f, -0.84f, 0}, 0.5, 0.5},
                        {"rock_rock_32", 32, 32, {0.1f, -0.93f, 0}, 0.5, 0.5},
                        {"rock_rock_64", 64, 64, {0.1f, -0.95f, 0}, 0.5, 0.5},
                        {"rock_rock_32_apart", 32, 32, {0.1f, -1.005f, 0}, 0.5, 0.5}};
  for (const Case& c : cases) benchmark::RegisterBenchmark((std::string("narrow/bullet/") + c.name).c_str(), run, c);
  return true;
}();

}  // namespace
#endif
