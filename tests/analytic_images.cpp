// Pins that no point of a manifold comes before another: the mirror image of boxes that fall on one another, and the
// same boxes turned by 90 degrees, move as the image of their motion (C19), at rest, sliding and bouncing.
#include <algorithm>
#include <vector>

#include "support_cases.h"

using namespace physics;

namespace {

enum class Image { none, mirrored, turned };

Vec3 image_of(Image image, Vec3 v) {
  if (image == Image::mirrored) return {-v.x, v.y, v.z};
  return image == Image::turned ? Vec3{-v.y, v.x, v.z} : v;
}

/// A leaning tower of cubes of 0.5 m, with this gap under the first and between each two.
struct Tower {
  Run run{{Precision::f64}, {0, 0, -9.81}, 4};
  std::vector<BodyId> cubes;

  Tower(Image image, double restitution, double gap) {
    const Material material{.static_friction = 0.8, .kinetic_friction = 0.8, .restitution = restitution};
    BodyDef floor;
    floor.kind = BodyKind::fixed;
    floor.shapes = {ShapeDef::box({50, 50, 1})};
    floor.material = material;
    floor.pose.position = {0, 0, -1};
    run.add(floor);
    for (int i = 0; i < 10; ++i) {
      BodyDef def;
      def.shapes = {ShapeDef::box({0.25, 0.25, 0.25})};
      def.mass = 1;
      def.material = material;
      def.pose.position = image_of(image, {0.01 * i, 0.005 * (i % 3), 0.25 + 0.5 * i + gap * (i + 1)});
      cubes.push_back(run.add(def));
    }
  }
};

/// Largest distance of a cube from where the image of the other run has it, over a second [m].
double distance_from_image(Image image, double restitution, double gap) {
  Tower one(Image::none, restitution, gap), other(image, restitution, gap);
  double off = 0;
  for (int k = 0; k < 240; ++k) {
    one.run.step(1.0 / 240);
    other.run.step(1.0 / 240);
    for (std::size_t i = 0; i < one.cubes.size(); ++i)
      off = std::max(off, length(image_of(image, one.run.position(one.cubes[i])) - other.run.position(other.cubes[i])));
  }
  return off;
}

}  // namespace

TEST_CASE("C19: a tower and a pile of elastic balls, mirrored and turned") {
  for (const Mode& mode : precisions()) check_rows(rows_of("C19", mode));
}

TEST_CASE("images of boxes that fall on one another, with and without bounces") {
  for (Image image : {Image::mirrored, Image::turned})
    for (double restitution : {0.0, 0.5})
      for (double gap : {0.0, 0.01, 0.03}) {
        INFO(int(image), " e ", restitution, " gap ", gap);
        CHECK(distance_from_image(image, restitution, gap) < 1e-12);
      }
}
