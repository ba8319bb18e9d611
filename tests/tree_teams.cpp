// Pins what a work group makes of a joint tree that it shares: the hashes of the CPU, of trees of which no two are
// alike, with contacts, loops, motors and in fourth order. Invocations take their shares in another order, see GlTeam;
// gl_parity compares kernel by kernel in both, and with one invocation a tree.
#include <utility>

#include "scenes/balls_on_joints.h"
#include "step/backend.h"
#include "support_world.h"

using namespace worldtest;

namespace {

using scenes::Parents;

/// Steppers made inside this scope share trees so.
struct TeamScope {
  GlTeam before;
  explicit TeamScope(GlTeam team) : before(std::exchange(gl_team(), team)) {}
  ~TeamScope() { gl_team() = before; }
};

/// A star of 200, levels of more than 32 nodes, chains, one joint alone, bushes; hanging and free.
World unlike_trees(Precision precision, bool touching) {
  World world({precision});
  must(world.set_gravity({0, -9.81, 0}));
  if (touching) (void)must(world.create_body(fixed_box({0, -1, 0}, {50, 0.5, 50})));
  scenes::Random random(3);
  const std::vector<Parents> shapes = {scenes::star_tree(200),         scenes::drawn_tree(150, random),
                                       scenes::chain_tree(20),         scenes::chain_tree(2),
                                       scenes::drawn_tree(40, random), scenes::drawn_tree(25, random),
                                       scenes::drawn_tree(15, random)};
  for (std::size_t i = 0; i < shapes.size(); i++) {
    scenes::TreeOfBalls tree;
    tree.place = {4.0 * double(i), 0.2, 0};
    tree.hangs = i % 2 == 1;
    tree.touches = touching;
    tree.group = std::int32_t(i + 1);
    const std::vector<BodyId> balls = must(scenes::add_balls(world, shapes[i], tree, random));
    if (!touching || balls.size() < 15 || balls.size() > 100) continue;
    must(scenes::pin_balls(world, balls[5], balls[12]));  // a loop
    JointDef motor;
    motor.a = balls[0], motor.b = must(world.create_body(ball(tree.place + Vec3{0, 1, 0}, 0.1)));
    motor.frame_a.position = {0, 0.5, 0}, motor.frame_b.position = {0, -0.5, 0};
    motor.freedom = AngleFreedom::hinge(-1, 1);
    motor.motor = {5, 0.5};
    (void)must(world.create_joint(motor));
  }
  return world;
}

std::vector<std::uint64_t> hashes(Precision precision, bool touching, StepSettings settings, int steps) {
  World world = unlike_trees(precision, touching);
  settings.order = touching ? 2 : 4;
  Stepper stepper(settings);
  const std::vector<std::uint64_t> all = hash_each_step(world, stepper, steps);
  if (touching) CHECK(world.contact_count() > 0);
  return all;
}

void check_teams(Precision precision, bool touching, int steps) {
  require_gl();
  const auto wanted = hashes(precision, touching, lanes(1), steps);
  CHECK(hashes(precision, touching, lanes(0), steps) == wanted);
  StepSettings on_gl = lanes(0);
  on_gl.set_all(Place::gl);
  const TeamScope scope({32, true});
  CHECK(hashes(precision, touching, on_gl, steps) == wanted);
}

}  // namespace

TEST_CASE("tree teams: trees of which no two are alike, with contacts, loops and motors, float") {
  check_teams(Precision::f32, true, 25);
}
TEST_CASE("tree teams: trees of which no two are alike, with contacts, loops and motors, double") {
  check_teams(Precision::f64, true, 10);
}
TEST_CASE("tree teams: of fourth order") { check_teams(Precision::f32, false, 10); }
