// Two stars about each other under their own gravity: the kernel of examples/gravity.cpp beside Kepler's ellipse, and
// how the error falls with the step.
#include <utility>

#include "../gravitation.h"
#include "show.h"

using namespace pcphys;
using show::must;

namespace {

constexpr double pi = 3.14159265358979324;
constexpr double period = 2, axis = 1, eccentricity = 0.5;  // [s], [m] of the half axis
constexpr double masses[] = {3, 1};                         // [kg]
constexpr double rate = 2 * pi / period, G = rate * rate * axis * axis * axis / (masses[0] + masses[1]);
const double minor = axis * std::sqrt(1 - eccentricity * eccentricity);

/// From the heavier to the lighter, by Kepler's equation; they start where they are nearest.
Vec3 between(double t) {
  const double mean = rate * t;
  double eccentric = mean;
  for (int i = 0; i < 20; i++)
    eccentric -= (eccentric - eccentricity * std::sin(eccentric) - mean) / (1 - eccentricity * std::cos(eccentric));
  return {axis * (std::cos(eccentric) - eccentricity), minor * std::sin(eccentric), 0};
}

struct Stars {
  World world;
  BodyId stars[2];
  Stepper stepper;

  Stars(Place place, Precision precision) : world({.precision = precision, .gravity = {}}), stepper(show::at(place)) {
    (void)must(world.add_property<Real>("potential", 0, "J"));
    const Vec3 way = between(0), speed{0, rate * axis * minor / (axis * (1 - eccentricity)), 0};
    for (int i = 0; i < 2; i++) {
      const double share = (i == 0 ? -masses[1] : masses[0]) / (masses[0] + masses[1]);
      BodyDef def;
      def.shapes = {ShapeDef::sphere(0.05)};
      def.mass = masses[i];
      def.pose.position = way * share;
      def.velocity = speed * share;
      stars[i] = must(world.create_body(def));
    }
    must(stepper.add_kernel(world, {.text = gravitation::text(), .parameters = {{"G", G}, {"softening", 0.0}}}));
  }
  Vec3 apart() const { return must(world.pose(stars[1])).position - must(world.pose(stars[0])).position; }
  double energy() const { return world.kinetic_energy() - G * masses[0] * masses[1] / length(apart()); }
};

/// The largest distance from where Kepler has them, over one turn.
double error_of(Precision precision, int steps_a_second) {
  Stars s(Place::cpu, precision);
  double worst = 0;
  show::run(
      s.world, s.stepper, period, [&](double t) { worst = std::max(worst, length(s.apart() - between(t))); },
      steps_a_second);
  return worst;
}

}  // namespace

int main(int argc, char** argv) {
  show::Csv csv(argc, argv, "time,distance,distance exact,energy gained,energy gained exact");
  show::Csv errors(argc, argv, "sub-step,single,double", "--errors");
  const double whole = -G * masses[0] * masses[1] / (2 * axis);
  double drift = 0;
  const bool same = show::same_on_both_places([&](Place place) {
    Stars s(place, Precision::f32);
    show::run(s.world, s.stepper, 3 * period, [&](double t) {
      const double gained = 1 - s.energy() / whole;
      drift = std::max(drift, std::fabs(gained));
      csv.row(place, {t, length(s.apart()), length(between(t)), 100 * gained, 0});
    });
    return s.world.hash();
  });
  double off[2] = {};  // of the two shortest steps
  for (const int steps : {15, 30, 60, 120, 240, 480, 960, 1920, 3840}) {
    const double twice = error_of(Precision::f64, steps);
    errors.row(Place::cpu, {1.0 / (4 * steps), error_of(Precision::f32, steps), twice});
    off[0] = std::exchange(off[1], twice);
    if (steps == 60) std::printf("orbit: 1/60 s leaves Kepler's ellipse by %.3f mm of 1 m in a turn\n", 1000 * twice);
  }
  const double order = std::log2(off[0] / off[1]);
  std::printf("orbit: order %.2f; energy off by %.2f %% at most, in three turns\n", order, 100 * drift);
  return same && std::fabs(order - 2) < 0.05 && drift < 0.02 ? 0 : 1;
}
