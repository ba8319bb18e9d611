// Pins how contacts act on joint trees: a blow is answered by the whole tree at once, as a dense solve of its joints
// and the contact together answers it; both momenta are kept; a tree that is too large for that is answered by rows.
#include <Eigen/Dense>

#include "support_trees.h"

using namespace trees;

namespace {

Eigen::Vector3d eigen(Vec3 v) { return {v.x, v.y, v.z}; }
Eigen::Matrix3d cross_matrix(Vec3 r) {
  Eigen::Matrix3d m;
  m << 0, -r.z, r.y, r.z, 0, -r.x, -r.y, r.x, 0;
  return m;
}

/// Bodies, pins and one contact as dense matrices, at the places of now.
struct Dense {
  std::vector<BodyId> bodies;
  Eigen::VectorXd velocity, inverse_mass;  // six of each body; masses along world axes (bodies stand upright)
  std::vector<Eigen::VectorXd> rows;       // of constraints

  explicit Dense(const Run& run) {
    for (const BodyId body : run.world.bodies())
      if (*run.world.kind(body) == BodyKind::dynamic) bodies.push_back(body);
    velocity.resize(Eigen::Index(6 * bodies.size()));
    inverse_mass.resize(velocity.size());
    for (std::size_t i = 0; i < bodies.size(); i++) {
      const MassProperties mass = *run.world.mass_properties(bodies[i]);
      velocity.segment<3>(Eigen::Index(6 * i)) = eigen(*run.world.velocity(bodies[i]));
      velocity.segment<3>(Eigen::Index(6 * i + 3)) = eigen(*run.world.angular_velocity(bodies[i]));
      inverse_mass.segment<3>(Eigen::Index(6 * i)).setConstant(1 / mass.mass);
      inverse_mass.segment<3>(Eigen::Index(6 * i + 3)) = eigen(mass.moments).cwiseInverse();
    }
  }
  Eigen::Index at(BodyId body) const { return Eigen::Index(6 * (std::ranges::find(bodies, body) - bodies.begin())); }
  /// Relative velocity of b against a at a place, along n, is one row.
  void add(const Run& run, BodyId a, BodyId b, Vec3 place, Eigen::Vector3d n) {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(velocity.size());
    for (const auto& [body, sign] : {std::pair{a, -1.0}, {b, 1.0}}) {
      if (std::ranges::find(bodies, body) == bodies.end()) continue;
      const Vec3 arm = place - run.world.pose(body)->position;
      row.segment<3>(at(body)) = sign * n;
      row.segment<3>(at(body) + 3) = sign * (cross_matrix(arm) * n);
    }
    rows.push_back(row);
  }
  void pin(const Run& run, BodyId a, BodyId b, Vec3 place) {
    for (int k = 0; k < 3; k++) add(run, a, b, place, Eigen::Vector3d::Unit(k));
  }
  /// Velocities after the impulses that stop all rows.
  Eigen::VectorXd stopped() const {
    Eigen::MatrixXd j(Eigen::Index(rows.size()), velocity.size());
    for (std::size_t i = 0; i < rows.size(); i++) j.row(Eigen::Index(i)) = rows[i];
    const Eigen::MatrixXd answer = inverse_mass.asDiagonal() * j.transpose();
    return velocity - answer * (j * answer).ldlt().solve(j * velocity);
  }
};

double difference(const Run& run, const Dense& dense, const Eigen::VectorXd& wanted) {
  double most = 0;
  for (const BodyId body : dense.bodies) {
    most = std::max(most, (eigen(*run.world.velocity(body)) - wanted.segment<3>(dense.at(body))).norm());
    most = std::max(most, (eigen(*run.world.angular_velocity(body)) - wanted.segment<3>(dense.at(body) + 3)).norm());
  }
  return most;
}

BodyDef link(double x, double y, double mass = 1) {
  BodyDef def;
  def.shapes = {ShapeDef::box({0.45, 0.05, 0.4})};
  def.mass = mass;
  def.material = {0, 0, 0};
  def.pose.position = {x, y, 0};
  return def;
}

/// Links side by side along x, pinned where they meet at x = 0.5, 1.5, ...; the first to the ground if it hangs.
std::vector<BodyId> add_chain(Run& run, int count, bool hangs) {
  std::vector<BodyId> links;
  for (int i = 0; i < count; i++) links.push_back(run.add(link(i, 0, 1 + i % 3)));
  if (hangs) join(run, run.world.ground(), links[0], {-0.5, 0, 0});
  for (int i = 0; i + 1 < count; i++) join(run, links[std::size_t(i)], links[std::size_t(i) + 1], {i + 0.5, 0, 0});
  return links;
}
void pin_chain(Dense& dense, const Run& run, const std::vector<BodyId>& links, bool hangs) {
  if (hangs) dense.pin(run, run.world.ground(), links[0], {-0.5, 0, 0});
  for (std::size_t i = 0; i + 1 < links.size(); i++) dense.pin(run, links[i], links[i + 1], {double(i) + 0.5, 0, 0});
}

/// Steps in which nothing moves far, several: four corners are solved one after the other, and a velocity that joints
/// have just changed is read half-way.
void blow(Run& run, const Mode& mode) { run.step(mode.is_double() ? 1e-6 : 1e-5, 8); }

}  // namespace

TEST_CASE("a ball that hits a link of a chain is stopped by the whole chain") {
  for (const Mode& mode : precisions())
    for (const bool hangs : {false, true})
      for (const int hit : {0, 2, 4}) {
        Run run(mode);
        const std::vector<BodyId> links = add_chain(run, 5, hangs);
        BodyDef ball;
        ball.shapes = {ShapeDef::sphere(0.1)};
        ball.mass = 2;
        ball.material = {0, 0, 0};
        const Vec3 touch{hit + 0.3, 0.05, 0.02};
        ball.pose.position = touch + Vec3{0, 0.1, 0};
        ball.velocity = {0, -1, 0};
        const BodyId thrown = run.add(ball);
        Dense dense(run);
        pin_chain(dense, run, links, hangs);
        dense.add(run, links[std::size_t(hit)], thrown, touch, {0, 1, 0});
        const Eigen::VectorXd wanted = dense.stopped();
        blow(run, mode);
        CAPTURE(mode.name());
        CAPTURE(hangs);
        CAPTURE(hit);
        CHECK(difference(run, dense, wanted) <= (mode.is_double() ? 1e-4 : 0.03));
      }
}

TEST_CASE("two trees that meet, and two links of one tree that meet") {
  for (const Mode& mode : precisions())
    for (const bool same : {false, true}) {
      Run run(mode);
      std::vector<BodyId> links = add_chain(run, 3, false);
      // the upper row: another chain above the first, or the same one folded back over it by a post at its end
      for (int i = 0; i < 3; i++) {
        BodyDef def = link(i, 0.1, 2);
        def.velocity = {0, -1, 0};
        links.push_back(run.add(def));
      }
      for (int i = 3; i < 5; i++) join(run, links[std::size_t(i)], links[std::size_t(i) + 1], {i - 2.5, 0.1, 0});
      if (same) join(run, links[2], links[5], {2.5, 0.05, 0});
      // one point of contact: all other pairs are told to ignore each other
      for (std::size_t a = 0; a < 3; a++)
        for (std::size_t b = 3; b < 6; b++)
          if (a != 0 || b != 3) REQUIRE(run.world.set_collide(links[a], links[b], false));
      Dense dense(run);
      for (int i = 0; i < 2; i++) dense.pin(run, links[std::size_t(i)], links[std::size_t(i) + 1], {i + 0.5, 0, 0});
      for (int i = 3; i < 5; i++) dense.pin(run, links[std::size_t(i)], links[std::size_t(i) + 1], {i - 2.5, 0.1, 0});
      if (same) dense.pin(run, links[2], links[5], {2.5, 0.05, 0});
      blow(run, mode);
      CAPTURE(mode.name());
      CAPTURE(same);
      // faces meet: the four corners of the overlap are stopped, as far as they would close
      const auto relative = [&](double x, double z) {
        const auto speed = [&](BodyId body, double y) {
          const Vec3 arm = Vec3{x, y, z} - run.world.pose(body)->position;
          return (*run.world.velocity(body) + cross(*run.world.angular_velocity(body), arm)).y;
        };
        return speed(links[3], 0.05) - speed(links[0], 0.05);
      };
      for (const double x : {-0.45, 0.45})
        for (const double z : {-0.4, 0.4}) CHECK(relative(x, z) >= -0.02);
      // and no pin opens in the instant: what is left of the velocities satisfies them
      double open = 0;
      Dense after(run);
      after.rows = dense.rows;
      for (const Eigen::VectorXd& row : after.rows) open = std::max(open, std::abs(row.dot(after.velocity)));
      CHECK(open <= (mode.is_double() ? 1e-4 : 0.03));
    }
}

TEST_CASE("contacts of a tree with more than 64 bodies are rows, and the report counts them") {
  for (const int count : {40, 80}) {
    Run run(precisions().front());
    add_chain(run, count, false);
    BodyDef floor = link(0, -0.1);
    floor.kind = BodyKind::fixed;
    floor.shapes = {ShapeDef::box({200, 0.05, 5})};
    run.add(floor);
    run.step(frame);
    bool in_tree = false;
    for (const PlanEntry& entry : run.stepper.plan().entries)
      in_tree |= entry.kind == PlanEntry::Kind::kernel && std::string(kernel_name(entry)) == "tree_contact_solve";
    CHECK(in_tree == (count == 40));
    CHECK((run.stepper.step(run.world, frame).tree_contacts_as_rows > 0) == (count == 80));
  }
}
