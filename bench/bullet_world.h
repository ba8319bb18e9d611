// Bullet as a peer: builds the same bodies and joints from a pcphys world, with Bullet's own defaults.
#pragma once
#include <memory>
#include <vector>

#include "scenes/scene.h"

namespace pcphys::bench {

class BulletWorld {
 public:
  /// Friction combines as the geometric mean and restitution as the mean, as in pcphys; nothing sleeps.
  BulletWorld(const scenes::Scene& scene, const World& world);
  ~BulletWorld();

  void step(double dt);
  /// One for each body of the scene.
  std::vector<Pose> poses() const;

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace pcphys::bench
