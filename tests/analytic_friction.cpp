// Pins A21 to A23 and rolling friction: what sticks stays, what slides stops where it should, what rolls rolls without
// slip, and rolling and torsional friction stop it as their formulas say. And how two materials make one coefficient.
#include <algorithm>

#include "support_physics.h"

using namespace physics;

namespace {

constexpr double pi = 3.14159265358979323846;

BodyDef plane_of(const Material& material) {
  BodyDef floor;
  floor.kind = BodyKind::fixed;
  floor.shapes = {ShapeDef::plane()};
  floor.material = material;
  return floor;
}

/// A body on a plane that is tilted by `degrees` towards the direction `yaw` (gravity is turned instead).
struct Incline {
  Run run;
  BodyId id;
  Vec3 down;   // the slope
  Vec3 start;  // when it had settled

  Incline(const Mode& mode, const ShapeDef& shape, double height, const Material& material, double degrees,
          double yaw = 0, std::uint32_t substeps = 4, double dt = 1.0 / 240, bool settle = true)
      : run(mode, {0, -gravity * std::cos(degrees * pi / 180), 0}, substeps), down{std::cos(yaw), 0, std::sin(yaw)} {
    run.add(plane_of(material));
    BodyDef def;
    def.shapes = {shape};
    def.mass = 1;
    def.material = material;
    def.pose = {{0, height, 0}, axis_angle({0, 1, 0}, -yaw)};
    id = run.add(def);
    if (settle) run.step(dt, long(0.5 / dt));
    const Vec3 weight{0, -gravity * std::cos(degrees * pi / 180), 0};
    REQUIRE(run.world.set_gravity(weight + gravity * std::sin(degrees * pi / 180) * down));
    start = run.position(id);
  }
  double way() const { return dot(run.position(id) - start, down); }
  double speed() const { return dot(*run.world.velocity(id), down); }
};

Material rough(double mu_static, double mu_kinetic) {
  Material m;
  m.static_friction = mu_static;
  m.kinetic_friction = mu_kinetic;
  return m;
}
Incline box_on(const Mode& mode, double mu_static, double mu_kinetic, double degrees = 30, double yaw = 0,
               double dt = 1.0 / 240) {
  return Incline(mode, ShapeDef::box({0.2, 0.1, 0.2}), 0.1, rough(mu_static, mu_kinetic), degrees, yaw, 4, dt);
}
Incline ball_on(const Mode& mode, const Material& m, double degrees, double dt = 1.0 / 240) {
  return Incline(mode, ShapeDef::sphere(0.1), 0.1, m, degrees, 0, 4, dt);
}

}  // namespace

TEST_CASE("A21a: a box that sticks does not creep; static friction holds to 1 % of the slope") {
  const double tangent = std::tan(pi / 6);
  for (const Mode& mode : precisions()) {
    CAPTURE(mode.name());
    for (double dt : {1.0 / 60, 1.0 / 240}) {
      Incline box = box_on(mode, 0.6, 0.6, 30, 0, dt);
      box.run.step(dt, std::lround(1 / dt));
      const double settled = box.way();
      box.run.step(dt, std::lround(9 / dt));
      const double ten = box.way() - settled;
      box.run.step(dt, std::lround(90 / dt));
      MESSAGE("A21a " << mode.name() << ", dt 1/" << 1 / dt << ": gives way by " << settled << " m, creeps " << ten
                      << " m in 10 s, " << box.way() - settled << " m in 100 s");
      CHECK(std::fabs(ten) <= 1e-6);
      CHECK(std::fabs(box.way() - settled) <= (mode.is_double() ? 1e-6 : 1e-5));
    }
    Incline holds = box_on(mode, 1.01 * tangent, 1.01 * tangent), slides = box_on(mode, 0.99 * tangent, 0.99 * tangent);
    holds.run.step(1.0 / 240, 480);
    slides.run.step(1.0 / 240, 480);
    MESSAGE("A21a " << mode.name() << ": " << holds.way() << " m at 1.01 tan, " << slides.way()
                    << " m at .99 tan in 2 s");
    CHECK(std::fabs(holds.way()) <= 1e-4);
    CHECK(std::fabs(slides.way() / (0.01 * gravity * std::sin(pi / 6) * 2) - 1) <= 0.05);
  }
}

TEST_CASE("A21c, d, e: static and kinetic friction, up the slope, and on the level") {
  const double dt = 1.0 / 1200;
  for (const Mode& mode : precisions()) {
    CAPTURE(mode.name());
    Incline rest = box_on(mode, 0.6, 0.3, 30, 0, dt), moving = box_on(mode, 0.6, 0.3, 30, 0, dt);
    rest.run.step(dt, 120);
    const double gave = rest.way();  // gravity was turned at once: it slips before friction has grown
    rest.run.step(dt, 1080);
    MESSAGE("A21c " << mode.name() << ": gives way by " << gave << " m, then " << rest.way() - gave);
    CHECK(std::fabs(gave) <= 1e-3);
    CHECK(std::fabs(rest.way() - gave) <= 1e-3);
    REQUIRE(moving.run.world.set_velocity(moving.id, 1.0 * moving.down));
    moving.run.step(dt, 1200);
    CHECK(std::fabs(moving.way() - (1 + 0.5 * 2.356287)) <= 2.356287 * dt);

    Incline up = box_on(mode, 0.7, 0.5, 30, 0, dt);
    REQUIRE(up.run.world.set_velocity(up.id, -3.0 * up.down));
    up.run.step(dt, 600);
    const double stopped = up.way();
    CHECK(std::fabs(stopped + 0.49164989) <= 0.5 * 3 * dt);
    up.run.step(dt, 1200);
    CHECK(std::fabs(up.way() - stopped) <= 1e-6);

    for (const auto& [mu, distance] : {std::pair{0.2, 1.019368}, {0.4, 0.509684}, {0.7, 0.291248}}) {
      Incline level = box_on(mode, mu, mu, 0, 0, dt);
      REQUIRE(level.run.world.set_velocity(level.id, {2, 0, 0}));
      level.run.step(dt, 1800);
      MESSAGE("A21e " << mode.name() << ", mu " << mu << ": off by " << level.way() - distance << " m");
      CHECK(std::fabs(level.way() - distance) <= 2 * dt / 2);
    }
  }
}

TEST_CASE("A21f: no direction is preferred") {
  double least = infinite, most = 0;
  for (int k = 0; k < 8; k++) {
    Incline ball(Mode{}, ShapeDef::box({0.2, 0.1, 0.2}), 0.1, rough(0.3, 0.3), 30, k * pi / 4, 4);
    ball.run.step(1.0 / 240, 240);
    least = std::min(least, ball.way());
    most = std::max(most, ball.way());
  }
  MESSAGE("A21f: " << most - least << " m between eight directions");
  CHECK(most - least <= 1e-9);
}

TEST_CASE("A22: a ball rolls down a slope without slip, or slides") {
  const double dt = 1.0 / 1200, slope = gravity * std::sin(pi / 6);
  for (const Mode& mode : precisions()) {
    CAPTURE(mode.name());
    Incline rolls = ball_on(mode, rough(0.6, 0.6), 30, dt), slides = ball_on(mode, rough(0.1, 0.1), 30, dt);
    rolls.run.step(dt, 600);
    slides.run.step(dt, 600);
    const double v = rolls.speed(), u = slides.speed(), w = slides.run.world.angular_velocity(slides.id)->z;
    rolls.run.step(dt, 600);
    slides.run.step(dt, 600);
    const double a = 2 * (rolls.speed() - v), b = 2 * (slides.speed() - u),
                 c = -2 * (slides.run.world.angular_velocity(slides.id)->z - w);
    const double slip = rolls.speed() + 0.1 * rolls.run.world.angular_velocity(rolls.id)->z;
    MESSAGE("A22 " << mode.name() << ": rolls " << a / (slope * 5 / 7) - 1 << ", slip " << slip << " m/s; slides "
                   << b / 4.0554291 - 1 << ", spin " << c / 21.239273 - 1);
    CHECK(std::fabs(a / (slope * 5 / 7) - 1) <= 1e-4);
    CHECK(std::fabs(b / 4.0554291 - 1) <= (mode.is_double() ? 1e-4 : 2e-4));
    CHECK(std::fabs(c / 21.239273 - 1) <= 1e-4);
    CHECK(std::fabs(slip) <= 1e-5);
    for (double mu : {0.164957 * 1.01, 0.164957 * 0.99}) {
      Incline ball = ball_on(mode, rough(mu, mu), 30, dt);
      ball.run.step(dt, 1200);
      const double left = ball.speed() + 0.1 * ball.run.world.angular_velocity(ball.id)->z;
      CHECK((std::fabs(left) > 1e-3) == (mu < 0.164957));
    }
  }
}

TEST_CASE("A23: from sliding to rolling") {
  const double dt = 1.0 / 1200;
  for (const Mode& mode : precisions())
    for (double spin : {0.0, -35.0}) {
      CAPTURE(mode.name());
      Incline ball = ball_on(mode, rough(0.2, 0.2), 0, dt);
      REQUIRE(ball.run.world.set_velocity(ball.id, {7, 0, 0}));
      REQUIRE(ball.run.world.set_angular_velocity(ball.id, {0, 0, -spin}));
      ball.run.step(dt, 2400);
      const double v = (5 * 7 + 2 * 0.1 * spin) / 7;
      MESSAGE("A23 " << mode.name() << ", spin " << spin << ": v off by " << ball.speed() - v << ", x "
                     << ball.way() - (6.116207951 + 5 * (2 - 1.019367991845)));
      CHECK(std::fabs(ball.speed() - v) <= (mode.is_double() ? 1e-5 : 1e-3));
      if (spin == 0) CHECK(std::fabs(ball.way() - (6.116207951 + 5 * (2 - 1.019367991845))) <= 7 * dt / 6);
    }
}

// It slips while it tilts onto its lower edge: mu_static is 4 % above what is needed.
TEST_CASE("A21c: what slipped at first sticks") {
  Incline rest = box_on(Mode{}, 0.6, 0.3, 30, 0, 1.0 / 1200);
  rest.run.step(1.0 / 1200, 1200);
  const double before = rest.way();
  rest.run.step(1.0 / 1200, 1200);
  CHECK(std::fabs(rest.way() - before) <= 1e-6);
}

TEST_CASE("A22, A23: slip and final speed to 1e-6 m/s") {
  const double dt = 1.0 / 1200;
  Incline rolls = ball_on(Mode{}, rough(0.6, 0.6), 30, dt), ball = ball_on(Mode{}, rough(0.2, 0.2), 0, dt);
  REQUIRE(ball.run.world.set_velocity(ball.id, {7, 0, 0}));
  rolls.run.step(dt, 1200);
  ball.run.step(dt, 2400);
  CHECK(std::fabs(rolls.speed() + 0.1 * rolls.run.world.angular_velocity(rolls.id)->z) <= 1e-6);
  CHECK(std::fabs(ball.speed() - 5) <= 1e-6);
}

// ---- rolling and torsional friction --------------------------------------------------------------------

namespace {
Material felt(double rolling, double torsional) {
  Material m = rough(0.9, 0.9);
  m.rolling_friction = rolling;
  m.torsional_friction = torsional;
  return m;
}
}  // namespace

TEST_CASE("rolling friction: a ball rolls out, and holds on a slope of up to its lever over its radius") {
  const double dt = 1.0 / 240, lever = 0.005, radius = 0.1;
  for (const Mode& mode : precisions()) {
    CAPTURE(mode.name());
    Incline ball = ball_on(mode, felt(lever, 0), 0);
    REQUIRE(ball.run.world.set_velocity(ball.id, {2, 0, 0}));
    REQUIRE(ball.run.world.set_angular_velocity(ball.id, {0, 0, -20}));
    const double slowing = lever / radius * gravity * 5 / 7, way = 2 * 2 / (2 * slowing);
    ball.run.step(dt, long((2 / slowing - 0.5) / dt));
    CHECK(ball.speed() > 0.1);
    ball.run.step(dt, 480);
    MESSAGE("rolling friction " << mode.name() << ": rolls " << ball.way() << " m, formula " << way << "; then "
                                << ball.speed() << " m/s");
    CHECK(std::fabs(ball.way() / way - 1) <= 5e-3);
    CHECK(std::fabs(ball.speed()) <= 1e-6);
    const double limit = std::atan(lever / radius) * 180 / pi;
    Incline holds = ball_on(mode, felt(lever, 0), 0.99 * limit), goes = ball_on(mode, felt(lever, 0), 1.01 * limit);
    holds.run.step(dt, 2400);
    goes.run.step(dt, 2400);
    const double pull =
        gravity * 5 / 7 * (std::sin(1.01 * limit * pi / 180) - lever / radius * std::cos(1.01 * limit * pi / 180));
    MESSAGE("rolling friction " << mode.name() << ": at .99 of the angle " << holds.way() << " m in 10 s, at 1.01 "
                                << goes.way() << " m, formula " << 50 * pull);
    CHECK(std::fabs(holds.way()) <= 1e-4);
    CHECK(std::fabs(goes.way() / (50 * pull) - 1) <= 0.02);
  }
}

TEST_CASE("torsional friction: a spinning ball stops in I w / (lever m g)") {
  const double dt = 1.0 / 240, lever = 0.01, inertia = 0.4 * 0.01, spin = 20;
  for (const Mode& mode : precisions()) {
    CAPTURE(mode.name());
    Incline ball = ball_on(mode, felt(0, lever), 0);
    REQUIRE(ball.run.world.set_angular_velocity(ball.id, {0, spin, 0}));
    const double time = inertia * spin / (lever * gravity);
    ball.run.step(dt, std::lround(time / 2 / dt));
    const double half = ball.run.world.angular_velocity(ball.id)->y,
                 expected = spin - std::round(time / 2 / dt) * dt * lever * gravity / inertia;
    CHECK(std::fabs(half / expected - 1) <= 5e-3);
    ball.run.step(dt, std::lround(time / 2 / dt) + 3);
    MESSAGE("torsional friction " << mode.name() << ": half way " << half / expected - 1 << ", after the time "
                                  << ball.run.world.angular_velocity(ball.id)->y << " rad/s");
    CHECK(std::fabs(ball.run.world.angular_velocity(ball.id)->y) <= 1e-6);
  }
}

TEST_CASE("rolling friction: the same hash in every lane width and on GL; without it the kernel is left out") {
  for (Precision precision : {Precision::f64, Precision::f32}) {
    std::vector<std::uint64_t> hashes;
    for (const Mode& mode : everywhere()) {
      if (mode.precision != precision) continue;
      Incline ball = ball_on(mode, felt(0.005, 0.01), 10);
      REQUIRE(ball.run.world.set_angular_velocity(ball.id, {3, 5, -20}));
      ball.run.step(1.0 / 60, 20);
      hashes.push_back(ball.run.world.hash());
      CAPTURE(mode.name());
      CHECK(hashes.back() == hashes.front());
      CHECK(to_text(ball.run.stepper.plan()).find("contact_rolling") != std::string::npos);
    }
  }
  Incline plain = ball_on(Mode{}, rough(0.5, 0.5), 10);
  CHECK(to_text(plain.run.stepper.plan()).find("contact_rolling") == std::string::npos);
}

// ---- two materials -------------------------------------------------------------------------------------

TEST_CASE("combination rules: each of them, and which holds where two differ") {
  const auto contact_of = [](const Material& a, const Material& b) {
    Run run(Mode{});
    run.add(plane_of(a));
    BodyDef def;
    def.shapes = {ShapeDef::sphere(0.1)};
    def.pose.position = {0, 0.1, 0};
    def.material = b;
    run.add(def);
    run.step(1e-3);
    return Vec3{run.world.view("contact_static_friction")->at(1, 0),
                run.world.view("contact_kinetic_friction")->at(1, 0), run.world.view("contact_restitution")->at(1, 0)};
  };
  const double a = 0.9, b = 0.4;
  const double expected[] = {0.65, 0.6, 0.4, 0.36, 0.9};
  for (int rule = 0; rule < 5; rule++) {
    Material m{a, a, a}, n{b, b, b};
    m.friction_rule = m.restitution_rule = n.friction_rule = n.restitution_rule = Combine(rule);
    const Vec3 c = contact_of(m, n);
    for (double x : {c.x, c.y, c.z}) CHECK(x == doctest::Approx(expected[rule]).epsilon(1e-14));
    n.friction_rule = n.restitution_rule = Combine::mean;
    CHECK(contact_of(m, n).x == doctest::Approx(expected[rule]).epsilon(1e-14));
    CHECK(contact_of(n, m).z == doctest::Approx(expected[rule]).epsilon(1e-14));
  }
  const Vec3 plain = contact_of({a, b, a}, {b, a, b});
  CHECK(plain.x == doctest::Approx(0.6).epsilon(1e-14));
  CHECK(plain.z == doctest::Approx(0.65).epsilon(1e-14));
}
