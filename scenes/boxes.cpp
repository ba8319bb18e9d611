// Boxes of 1 m on one another: pyramid, stack, heavy on light.
#include "builder.h"

namespace pcphys::scenes {
namespace {

int add_box(Builder& builder, Vec3 position, double density) {
  BodyDef def;
  def.shapes = {ShapeDef::box({0.5, 0.5, 0.5})};
  def.density = density;
  def.pose.position = position;
  return builder.add(def);
}

}  // namespace

void build_pyramid(Builder& builder) {
  const int rows = builder.scene().count;
  builder.set_material(0.6, 0);
  builder.add_floor();
  std::vector<Support>& supports = builder.scene().supports;
  std::vector<int> below;
  for (int row = 0; row < rows; ++row) {
    std::vector<int> here;
    for (int k = 0; k < rows - row; ++k) {
      here.push_back(add_box(builder, {(row + 1) * 0.5 + k - 0.5 * rows, row + 0.5, 0}, 100));
      if (row == 0) {
        supports.push_back({here.back(), -1});
      } else {
        supports.push_back({here.back(), below[std::size_t(k)]});
        supports.push_back({here.back(), below[std::size_t(k) + 1]});
      }
    }
    below = std::move(here);
  }
}

void build_stack(Builder& builder) {
  builder.set_material(0.6, 0);
  builder.add_floor();
  Random random = builder.random(99);
  for (int i = 0; i < builder.scene().count; ++i) {
    const double x = random.between(-0.005, 0.005);
    const double z = random.between(-0.005, 0.005);
    const int box = add_box(builder, {x, i + 0.5, z}, 1000);
    builder.scene().supports.push_back({box, i == 0 ? -1 : box - 1});
  }
}

void build_heavy(Builder& builder) {
  builder.set_material(0.6, 0);
  builder.add_floor();
  const int light = add_box(builder, {0, 0.5, 0}, 1);
  const int heavy = add_box(builder, {0, 1.5, 0}, builder.scene().ratio);
  builder.scene().supports = {{light, -1}, {heavy, light}};
}

}  // namespace pcphys::scenes
