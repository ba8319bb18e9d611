// Stacked ragdolls (section 10.2 of the original): columns of ragdolls, each turned about the vertical.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "builder.h"

namespace pcphys::scenes {

void build_ragdolls(Builder& builder) {
  const int count = builder.scene().count;
  const int columns = std::max(1, int(std::ceil(std::sqrt(count / 16.0) - 1e-9)));  // along each side; about 16 layers
  const int per_layer = columns * columns, layers = (count + per_layer - 1) / per_layer;
  builder.set_material(0.5, 0);
  builder.add_open_box(std::max(3.0, 2.0 * columns + 1.0), 0.5 + 2.0 * layers + 10.0);

  RagdollDef human = RagdollDef::human();
  human.material = builder.material();
  Random random = builder.random(777);
  for (int i = 0; i < count; ++i) {
    const int cell = i % per_layer;
    const double middle = 0.5 * (columns - 1);
    Pose pose;
    pose.position = {(cell % columns - middle) * 2.0, 0.5 + 2.0 * (i / per_layer), (cell / columns - middle) * 2.0};
    pose.orientation = axis_angle({0, 1, 0}, random.between(0, 2 * std::numbers::pi));
    Vec3 velocity;
    velocity.x = random.between(-0.5, 0.5);
    velocity.y = random.between(-0.5, 0.5);
    velocity.z = random.between(-0.5, 0.5);
    builder.add_ragdoll(human, pose, velocity, i + 1);
  }
}

}  // namespace pcphys::scenes
