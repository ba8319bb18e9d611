// What a judge sees of a world, whichever engine moves it: bodies, joints and springs by their numbers.
#pragma once
#include <optional>
#include <vector>

#include "wild/scene.h"

namespace pcphys::wild {

class Player;

struct SeenBody {
  bool there = false;  // it was made, and not destroyed
  BodyKind kind = BodyKind::fixed;
  Pose pose;
  Vec3 velocity, angular_velocity;  // of the centre of mass, world axes
  MassProperties mass;
  Vec3 force, torque;  // constant ones
  double drag = 0;     // the larger of both [1/s]
};

struct SeenJoint {
  bool there = false;
  int a = ground, b = ground;
  JointDef def;
};

struct SeenSpring {
  bool there = false;
  int a = ground, b = ground;
  SpringDef def;
};

struct Observation {
  Vec3 gravity;
  std::vector<SeenBody> bodies;
  std::vector<SeenJoint> joints;
  std::vector<SeenSpring> springs;
  /// As the engine's own impulses keep them; of the velocities above where it has none of its own.
  Vec3 momentum, angular_momentum;

  const SeenBody& body(int number) const;
  bool moves(int number) const { return body(number).there && body(number).kind == BodyKind::dynamic; }
};

double kinetic_energy(const SeenBody& body);
Vec3 angular_momentum_about_centre(const SeenBody& body);
/// A length by how a body's mass is spread [m].
double spread(const MassProperties& mass);
/// [J]
double kinetic_energy(const Observation& seen);
double potential_energy(const Observation& seen);
double spring_energy(const Observation& seen);
double spring_energy(const Observation& seen, const SeenSpring& spring);
/// What a spring gains that is made longer by `way`, or pressed by it, whichever is more [J].
double spring_energy_of_way(const Observation& seen, const SeenSpring& spring, double way);
inline double energy(const Observation& seen) {
  return kinetic_energy(seen) + potential_energy(seen) + spring_energy(seen);
}

/// What a body moves no faster than does not move: its place is rounded by more in a step of `dt` [m/s].
double unresolved_speed(const SeenBody& body, double rounding, double dt);
/// How much of the energy of springs one rounding of each end's place,
/// and of each number of an orientation, makes up [J].
double unresolved_spring_energy(const Observation& seen, double rounding);

/// How far the two pins of a joint are apart [m].
double gap(const Observation& seen, const SeenJoint& joint);
/// The widest gap of a joint [m], and the most that one is beyond its limits [rad].
double widest_gap(const Observation& seen);
double largest_excess(const Observation& seen);

/// What the player's calls have made so far, and where it is now.
class Eye {
 public:
  /// Follows the scene's calls; to be told after each.
  void follow(const Call& call);
  /// Reads poses and velocities.
  const Observation& look(const Player& player);
  const Observation& seen() const { return seen_; }
  Observation& seen() { return seen_; }
  /// The shapes of a body, empty for the ground.
  const std::vector<ShapeDef>& shapes(int body) const;
  const Material& material(int body) const;

 private:
  struct Made {
    std::vector<ShapeDef> shapes;
    Material material;
    double drag = 0;
  };
  struct Force {
    int body;
    Wrench wrench;
  };
  struct Follow;
  void make(int body, const std::vector<ShapeDef>& shapes, const Material& material, double drag);

  Observation seen_;
  std::vector<Made> made_;
  std::vector<std::optional<Force>> forces_;
};

}  // namespace pcphys::wild
