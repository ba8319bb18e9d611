// B5, B7, B11: joints that close loops.
#include <array>
#include <numbers>
#include <utility>

#include "parts.h"

namespace pcphys::cases {
namespace {

using std::numbers::pi;

// ---- B5 ------------------------------------------------------------------------------------------------

constexpr int planks = 100;
constexpr double plank = 0.25, span = 24;

/// How far the middle hangs below the ends, at rest with `load` on it. With H what pulls along and V the weight below
/// the centre of plank k from the middle, that one slopes by V / H; H is what makes a half as wide as half the span.
double sag_at_rest(double load) {
  const auto half = [=](double pull) {
    std::array<double, 2> reach{};  // of half the bridge: across, down
    for (int k = 0; k < planks / 2; ++k) {
      const double slope = gravity * (0.5 * load + k + 0.5) / pull, along = plank / std::hypot(1, slope);
      reach[0] += along;
      reach[1] += slope * along;
    }
    return reach;
  };
  double low = 1, high = 1e9;
  for (int i = 0; i < 200; ++i) {
    const double pull = std::sqrt(low * high);
    (half(pull)[0] < 0.5 * span ? low : high) = pull;
  }
  return half(low)[1];
}

/// Half the angle that a plank takes of an arc with this chord.
double arc_of_planks() {
  double low = 1e-9, high = pi / planks;  // of half an angle
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (plank * std::sin(planks * middle) / std::sin(middle) > span ? low : high) = middle;
  }
  return low;
}

/// An arc of planks at first, which settles with drag. `pins`: one or two a joint; a load hangs on the middle.
void bridge(Trial& trial, int pins, double load) {
  Simulated& run = trial.start([&](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    const double half = arc_of_planks();
    Vec3 pin;
    BodyId before = builder.world().ground();
    const auto join = [&](BodyId a, Vec3 at_a, BodyId b, Vec3 at_b) {
      for (int side = 0; side < pins; ++side) {
        const Vec3 shift{0, pins == 1 ? 0 : 0.5 * side - 0.25, 0};
        add_pin(builder, a, at_a + shift, b, at_b + shift);
      }
    };
    for (int i = 0; i < planks; ++i) {
      const double fall = (planks - 1 - 2 * i) * half;  // slope downwards
      const Vec3 along = plank * Vec3{std::cos(fall), 0, -std::sin(fall)};
      BodyDef def;
      def.shapes = {ShapeDef::box({0.5 * plank, 0.25, 0.025})};
      def.mass = 1;
      def.linear_drag = def.angular_drag = 0.5;
      def.pose = {pin + 0.5 * along, exponential({0, fall, 0})};
      const BodyId id = builder.id(builder.add(without_contacts(def)));
      join(before, i == 0 ? pin : Vec3{0.5 * plank, 0, 0}, id, {-0.5 * plank, 0, 0});
      before = id;
      pin = pin + along;
    }
    join(before, {0.5 * plank, 0, 0}, builder.world().ground(), {span, 0, 0});
    if (load > 0) {
      BodyDef ball;
      ball.shapes = {ShapeDef::sphere(0.5)};
      ball.mass = load;
      ball.linear_drag = ball.angular_drag = 0.5;
      const BodyId holder = builder.id(planks / 2 - 1);
      ball.pose.position = transform(*builder.world().pose(holder), {0.5 * plank, 0, 0}) - Vec3{0, 0, 0.5};
      add_pin(builder, holder, {0.5 * plank, 0, 0}, builder.id(builder.add(without_contacts(ball))), {0, 0, 0.5});
    }
  });
  Worst gap;
  for (long k = 0; k < trial.steps(30); ++k) {
    run.step(trial.dt());
    gap.add(joint_gap(run));
  }
  trial.report("joint gap / plank, largest", gap / plank, 5e-3);
  trial.report("joint gap / plank, at the end", joint_gap(run) / plank, 5e-3);
  trial.report("speed at the end [m/s]", largest_speed(run));
  const double sag = -transform(run.pose(planks / 2 - 1), {0.5 * plank, 0, 0}).z;
  trial.report("sag, relative", std::fabs(sag / sag_at_rest(load) - 1), 1e-2, 1e-4);
}

// ---- B7 ------------------------------------------------------------------------------------------------

/// A link along its x axis, from `from` at this angle from x towards z.
BodyDef bar(Vec3 from, double size, double angle) {
  BodyDef def;
  def.shapes = {ShapeDef::box({0.5 * size, 0.01, 0.01})};
  def.mass = 1;
  def.pose = {from + 0.5 * size * Vec3{std::cos(angle), 0, std::sin(angle)}, exponential({0, -angle, 0})};
  return without_contacts(def);
}

/// Rates of coupler and rocker for a crank of 1 rad/s: a i e^(i crank) + b' i e^(i coupler) = c' i e^(i rocker).
std::array<double, 2> rates(double crank, double coupler, double rocker) {
  const double a = 0.1, b = 0.35, c = 0.25;
  return {a * std::sin(rocker - crank) / (b * std::sin(coupler - rocker)),
          a * std::sin(coupler - crank) / (c * std::sin(coupler - rocker))};
}

/// `hinges`: axes held as well, which is more than is needed.
void four_bar(Trial& trial, bool hinges, const Csv& reference) {
  const double speed = 2 * pi, degree = pi / 180;
  const double coupler = reference.at(0, "coupler_deg") * degree, rocker = reference.at(0, "rocker_deg") * degree;
  Simulated& run = trial.start([&](scenes::Builder& builder) {
    const auto [coupler_rate, rocker_rate] = rates(0, coupler, rocker);
    const auto spin = [&](BodyDef& def, Vec3 from, Vec3 from_velocity, double rate) {
      def.angular_velocity = {0, -rate * speed, 0};
      def.velocity = from_velocity + cross(def.angular_velocity, def.pose.position - from);
    };
    BodyDef turning = bar({}, 0.1, 0);  // about its end, so its centre is that
    turning.kind = BodyKind::kinematic;
    turning.pose.position = {};
    turning.angular_velocity = {0, -speed, 0};
    BodyDef middle = bar({0.1, 0, 0}, 0.35, coupler), last = bar({0.4, 0, 0}, 0.25, rocker);
    spin(middle, {0.1, 0, 0}, {0, 0, 0.1 * speed}, coupler_rate);
    spin(last, {0.4, 0, 0}, {}, rocker_rate);
    const BodyId a = builder.id(builder.add(turning)), b = builder.id(builder.add(middle)),
                 c = builder.id(builder.add(last));
    const auto join = [&](BodyId x, Vec3 at_x, Quat axes_x, BodyId y, Vec3 at_y, Quat axes_y) {
      JointDef def;
      def.a = x;
      def.b = y;
      // hinge axis: the frames' x along the world's y
      const Quat to_y = axis_angle({0, 0, 1}, 0.5 * pi);
      def.frame_a = {at_x, conjugate(axes_x) * to_y};
      def.frame_b = {at_y, conjugate(axes_y) * to_y};
      if (hinges) def.freedom = AngleFreedom::hinge();
      builder.add_joint(def);
    };
    join(a, {0.1, 0, 0}, {}, b, {-0.175, 0, 0}, middle.pose.orientation);
    join(b, {0.175, 0, 0}, middle.pose.orientation, c, {0.125, 0, 0}, last.pose.orientation);
    join(builder.world().ground(), {0.4, 0, 0}, {}, c, {-0.125, 0, 0}, last.pose.orientation);
  });
  Worst angle, gap;
  const long per_sample = std::lround(1.0 / 60 / trial.dt());  // 6 degrees
  for (int k = 1; k <= 600; ++k) {
    run.step(trial.dt(), per_sample);
    const Quat q = run.pose(2).orientation;
    const double now = 2 * std::atan2(-q.y, q.w), wanted = reference.at(std::size_t(k % 60) * 3, "rocker_deg") * degree;
    angle.add(std::fabs(std::remainder(now - wanted, 2 * pi)) / degree);
    gap.add(joint_gap(run));
  }
  const bool bounded = std::fabs(trial.dt() * 1200 - 1) < 1e-9;
  trial.report("rocker [deg]", angle, bounded ? std::optional(0.05) : std::nullopt);
  trial.report("joint gap [m]", gap);
}

void ring(Trial& trial) {
  const int links = 20;
  const double radius = 0.639245322, middle = radius * std::cos(pi / links), speed = 10, pin_force = 201.801806;
  Simulated& run = trial.start([&](scenes::Builder& builder) {
    for (int i = 0; i < links; ++i) {
      const double angle = 2 * pi * (i + 0.5) / links;
      BodyDef def;
      def.shapes = {ShapeDef::box({0.5 * link_length, 0.02, 0.02})};
      def.mass = 1;
      def.pose = {{middle * std::cos(angle), middle * std::sin(angle), 0}, axis_angle({0, 0, 1}, angle + 0.5 * pi)};
      def.angular_velocity = {0, 0, speed};
      def.velocity = cross(def.angular_velocity, def.pose.position);
      builder.add(without_contacts(def));
    }
    for (int i = 0; i < links; ++i)
      add_pin(builder, builder.id(i), {0.5 * link_length, 0, 0}, builder.id((i + 1) % links),
              {-0.5 * link_length, 0, 0});
  });
  const Vec3 before = run.kept_angular_momentum();
  Worst out, turn, gap, force;
  std::vector<Neighbours> centres(links);
  for (long k = 0; k < trial.steps(20); ++k) {
    run.step(trial.dt());
    turn.add(length(run.kept_angular_momentum() - before) / length(before));
    for (int i = 0; i < links; ++i) {
      out.add(std::fabs(length(run.pose(i).position) / middle - 1));
      Neighbours& n = centres[std::size_t(i)];
      n.dt = trial.dt();
      n.before = std::exchange(n.now, std::exchange(n.after, run.pose(i)));
      // two pins pull a link of 1 kg inwards, each leaning by half of what a link takes of the circle
      if (k >= 2) force.add(std::fabs(length(n.acceleration()) / (2 * std::sin(pi / links)) / pin_force - 1));
    }
    gap.add(joint_gap(run));
  }
  trial.report("radius, relative", out, 1e-3);
  trial.report("angular momentum, relative", turn, trial.either(1e-10, 1e-5));
  trial.report("joint gap / link", gap / link_length);
  trial.report("pin force, from the centres' acceleration, relative", force, 1e-2);
}

// ---- B11 -----------------------------------------------------------------------------------------------

void grid(Trial& trial) {
  const int side = 100;
  Simulated& run = trial.start([&](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    for (int row = 0; row < side; ++row)
      for (int column = 0; column < side; ++column) {
        BodyDef def;
        def.shapes = {ShapeDef::sphere(0.4)};
        def.pose.position = {double(column), 0, double(-row)};
        if (row == 0) def.kind = BodyKind::fixed;
        builder.add(without_contacts(def));
      }
    for (int i = 0; i < side * side; ++i) {
      const int row = i / side, column = i % side;
      if (column + 1 < side && row > 0) add_pin(builder, builder.id(i), {0.5, 0, 0}, builder.id(i + 1), {-0.5, 0, 0});
      if (row + 1 < side) add_pin(builder, builder.id(i), {0, 0, -0.5}, builder.id(i + side), {0, 0, 0.5});
    }
  });
  run.step(trial.dt(), 100);
  trial.report("joint gap / pitch after 100 steps", joint_gap(run), 1e-2);
}

}  // namespace

void add_loops(std::vector<Case>& cases) {
  Case& hung = cases.emplace_back(Case{"B5", "bridge of 100 planks between two posts", {}});
  struct Bridge {
    const char* name;
    int pins;
    double load;
  };
  for (const Bridge& b :
       {Bridge{"one pin", 1, 0}, {"two pins", 2, 0}, {"one pin, 100 kg", 1, 100}, {"one pin, 1e4 kg", 1, 1e4}})
    hung.variants.push_back({.name = b.name,
                             .run = [b](Trial& t) { bridge(t, b.pins, b.load); },
                             .steps = {1.0 / 240},
                             .substeps = {4},
                             .more_steps = {1.0 / 60},
                             .more_substeps = {1, 2},
                             .lost_at = 1});

  const Csv linkage = read_csv("B07_fourbar.csv");
  cases.push_back({"B7",
                   "closed loops",
                   {{.name = "four-bar, pins",
                     .run = [linkage](Trial& t) { four_bar(t, false, linkage); },
                     .steps = {1.0 / 60, 1.0 / 240, 1.0 / 1200},
                     .substeps = {1, 4},
                     .second_order = "rocker [deg]",
                     .order_is_target = true,
                     .lost_at = 180 / std::numbers::pi},
                    {.name = "four-bar, hinges",
                     .run = [linkage](Trial& t) { four_bar(t, true, linkage); },
                     .steps = {1.0 / 60, 1.0 / 240, 1.0 / 1200},
                     .substeps = {1, 4},
                     .second_order = "rocker [deg]",
                     .order_is_target = true,
                     .lost_at = 180 / std::numbers::pi},
                    {.name = "ring of 20",
                     .run = ring,
                     .steps = {1.0 / 240},
                     .substeps = {4},
                     .more_steps = {1.0 / 60},
                     .more_substeps = {1, 2},
                     .lost_at = 1}}});

  cases.push_back({"B11",
                   "grid of 100 x 100 balls and joints",
                   {{.name = "top row fixed",
                     .run = grid,
                     .steps = {1.0 / 60},
                     .substeps = {4},
                     .more_substeps = {1, 2},
                     .lost_at = 1}}});
}

}  // namespace pcphys::cases
