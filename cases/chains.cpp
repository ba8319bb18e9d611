// B1, B2, B6: chains that hang and swing, with loads far heavier than their links.
#include <numbers>

#include "parts.h"

namespace pcphys::cases {
namespace {

const Vec3 origin{};

Simulated& hang(Trial& trial, const std::vector<double>& angles, double ratio) {
  return trial.start([&](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    add_chain(builder, builder.world().ground(), origin, origin, angles, ratio);
  });
}

/// Of a gap over link length, in sub-steps of 4 at 1/240; none where none was asked for.
std::optional<double> gap_must(int links, double ratio) {
  if (ratio == 1 && links == 10) return 1e-3;
  if (ratio == 1 && links == 50) return 5e-3;
  if (ratio == 100) return 1e-2;
  if (ratio == 1e4) return 0.1;
  return {};
}

// ---- B1 ------------------------------------------------------------------------------------------------

void at_rest(Trial& trial, int links, double ratio) {
  Simulated& run = hang(trial, std::vector<double>(std::size_t(links), 0.0), ratio);
  Worst gap;
  for (long k = 0; k < trial.steps(5); ++k) {
    run.step(trial.dt());
    gap.add(joint_gap(run));
  }
  trial.report("joint gap / link", gap / link_length, gap_must(links, ratio), 1e-6);
  trial.report("speed at the end [m/s]", largest_speed(run), 1e-3);
}

/// From one crossing of the plumb line to the next but one.
void first_mode(Trial& trial, int links, double ratio) {
  Mode mode = slowest_mode(links, ratio);
  for (double& angle : mode.angles) angle *= 1e-3;  // small: a pendulum's period grows by angle^2 / 16
  Simulated& run = hang(trial, mode.angles, ratio);
  std::vector<double> crossings;
  double before = run.pose(links - 1).position.x;
  const long most = trial.steps(2 * mode.period);
  for (long k = 1; k <= most && crossings.size() < 3; ++k) {
    run.step(trial.dt());
    const double now = run.pose(links - 1).position.x;
    if (before * now < 0) crossings.push_back((double(k) - now / (now - before)) * trial.dt());
    before = now;
  }
  const double period = crossings.size() == 3 ? crossings[2] - crossings[0] : std::numeric_limits<double>::quiet_NaN();
  // the mode itself stands in B01_chain_modes.csv, too
  const Csv modes = read_csv("B01_chain_modes.csv");
  double reference = mode.period;
  for (std::size_t row = 0; row < modes.rows.size(); ++row)
    if (modes.at(row, "N") == links && modes.at(row, "ratio") == ratio) reference = modes.at(row, "period1");
  trial.report("period, relative", std::fabs(period / reference - 1), 1e-2, 1e-3);
}

// ---- B2 ------------------------------------------------------------------------------------------------

void swing_reference(Trial& trial, int links, double ratio, const Csv& reference, double must) {
  Simulated& run = hang(trial, std::vector<double>(std::size_t(links), 0.5 * std::numbers::pi), ratio);
  Worst position;
  walk(run, trial.dt(), reference, 1, [&](std::size_t row, double) {
    for (int i = 0; i < links; ++i) {
      const std::string k = std::to_string(i + 1);
      position.add(length(run.pose(i).position - Vec3{reference.at(row, "x" + k), 0, reference.at(row, "z" + k)}));
    }
  });
  const bool bounded = std::fabs(trial.dt() * 1200 - 1) < 1e-9;
  // in single precision whips make more of rounding than order 4 leaves
  const bool judged = bounded && (trial.order() == 2 || trial.is_double());
  trial.report("position [m]", position, judged ? std::optional(must) : std::nullopt);
}

void swing_long(Trial& trial, int links, double ratio) {
  Simulated& run = hang(trial, std::vector<double>(std::size_t(links), 0.5 * std::numbers::pi), ratio);
  Worst gap, gain;
  const double mass = links - 1 + ratio, height = links * link_length, start = energy(run);
  for (long k = 0; k < trial.steps(5); ++k) {
    run.step(trial.dt());
    gap.add(joint_gap(run));
    gain.add(energy(run) - start);
  }
  trial.report("joint gap / link", gap / link_length, ratio <= 100 ? std::optional(0.1) : std::nullopt);
  trial.report("energy above the start / (m g l)", gain / (mass * gravity * height), 1e-2);
}

// ---- B6 ------------------------------------------------------------------------------------------------

/// Capsules of 1 m and radius 0.125 m, level at first, with a ball at their end.
void ball_and_chain(Trial& trial, int links, double radius, double load) {
  Simulated& run = trial.start([&](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    BodyId above = builder.world().ground();
    const Quat level = axis_angle({0, 0, 1}, -0.5 * std::numbers::pi);  // local y along x
    for (int i = 0; i < links; ++i) {
      BodyDef def;
      def.shapes = {ShapeDef::capsule(0.125, 0.5)};
      def.mass = 1;
      def.pose = {{i + 0.5, 0, 0}, level};
      const BodyId link = builder.id(builder.add(without_contacts(def)));
      add_pin(builder, above, i == 0 ? origin : Vec3{0, 0.5, 0}, link, {0, -0.5, 0});
      above = link;
    }
    BodyDef ball;
    ball.shapes = {ShapeDef::sphere(radius)};
    ball.mass = load;
    ball.pose.position = {links + radius, 0, 0};
    add_pin(builder, above, {0, 0.5, 0}, builder.id(builder.add(without_contacts(ball))), {-radius, 0, 0});
  });
  Worst gap, gain;
  const double start = energy(run), scale = (links + load) * gravity * (links + radius);
  for (long k = 0; k < trial.steps(10); ++k) {
    run.step(trial.dt());
    gap.add(joint_gap(run));
    gain.add(energy(run) - start);
  }
  trial.report("joint gap / link", gap, 0.1);
  trial.report("energy above the start / (m g l)", gain / scale, 1e-2);
}

}  // namespace

void add_chains(std::vector<Case>& cases) {
  const std::vector<double> step{1.0 / 240}, longer{1.0 / 60}, around{1.0 / 60, 1.0 / 960};
  const std::vector<std::uint32_t> fewer{1, 2};  // sub-steps
  Case& hanging = cases.emplace_back(Case{"B1", "hanging chain, its last link 1 to 1e6 times as heavy", {}});
  for (int links : {10, 50, 200})
    for (double ratio : {1.0, 100.0, 1e4, 1e6}) {
      char name[64];
      std::snprintf(name, sizeof name, "%d links, 1:%g", links, ratio);
      hanging.variants.push_back(
          {.name = name,
           .run = [=](Trial& t) { at_rest(t, links, ratio); },
           .steps = step,
           .substeps = {4},
           .more_steps = longer,
           .more_substeps = fewer,
           .floor = links * std::numeric_limits<double>::epsilon(),  // places of the last links are rounded
           .lost_at = 1});
      // the others run with the step of their bound alone
      const bool quick = links == 10 || (links == 50 && ratio <= 100);
      for (std::uint32_t order : {2, 4}) {
        if (order == 4 && links != 10) continue;
        hanging.variants.push_back({.name = name + std::string(order == 4 ? ", mode, order 4" : ", mode"),
                                    .run = [=](Trial& t) { first_mode(t, links, ratio); },
                                    .steps = step,
                                    .substeps = {4},
                                    .more_steps = links == 10 ? around
                                                  : quick     ? longer
                                                              : std::vector<double>(),
                                    .more_substeps = quick ? fewer : std::vector<std::uint32_t>(),
                                    .order = order,
                                    .floor = 1e-7,      // of a period, for what the angles are
                                    .lost_at = 0.16});  // a radian
      }
    }

  Case& swing = cases.emplace_back(Case{"B2", "chain let go from level", {}});
  struct Reference {
    const char *name, *file;
    int links;
    double ratio;
    std::array<double, 2> must;  // with the order 2, and 4
  };
  for (const Reference& r : {Reference{"3 links, 1:100", "B02_swing_N3_r100.csv", 3, 100, {1.3e-3, 3e-6}},
                             Reference{"5 links, 1:100", "B02_swing_N5_r100.csv", 5, 100, {6e-4, 2.6e-6}},
                             Reference{"10 links, 1:1", "B02_swing_N10_r1.csv", 10, 1, {1.2e-4, 3e-8}}})
    for (std::uint32_t order : {2, 4})
      swing.variants.push_back({.name = r.name + std::string(order == 4 ? ", order 4" : ""),
                                .run = [=, csv = read_csv(r.file)](
                                           Trial& t) { swing_reference(t, r.links, r.ratio, csv, r.must[order / 4]); },
                                // the order is that of the three shortest, in which no whip asks for more sub-steps
                                .steps = {1.0 / 60, 1.0 / 240, 1.0 / 1200, 1.0 / 2400, 1.0 / 4800, 1e-4},
                                .coarse = true,
                                .substeps = {1, 4},
                                .more_substeps = {2},
                                .order = order,
                                .second_order = "position [m]",
                                .order_is_target = order == 4,  // the last steps reach whips, or rounding
                                .lost_at = r.links * link_length});
  for (int links : {10, 50})
    for (double ratio : {1.0, 100.0, 1e4}) {
      char name[64];
      std::snprintf(name, sizeof name, "%d links, 1:%g, 5 s", links, ratio);
      swing.variants.push_back({.name = name,
                                .run = [=](Trial& t) { swing_long(t, links, ratio); },
                                .steps = step,
                                .substeps = {4},
                                .more_steps = longer,
                                .more_substeps = fewer,
                                .floor = links * std::numeric_limits<double>::epsilon(),
                                .lost_at = 1});
    }

  const std::vector<double> frame{1.0 / 60};
  cases.push_back({"B6",
                   "ball and chain",
                   {{.name = "32 links, 1:585",
                     .run = [](Trial& t) { ball_and_chain(t, 32, 2, 585); },
                     .steps = frame,
                     .substeps = {4},
                     .more_steps = {1.0 / 30},
                     .more_substeps = fewer,
                     .floor = (32 + 2) * std::numeric_limits<double>::epsilon(),  // the ball's place is rounded
                     .lost_at = 1},
                    {.name = "40 links, 1:672",
                     .run = [](Trial& t) { ball_and_chain(t, 40, 8, 672); },
                     .steps = frame,
                     .substeps = {4},
                     .more_steps = {1.0 / 30},
                     .more_substeps = fewer,
                     .floor = (40 + 8) * std::numeric_limits<double>::epsilon(),
                     .lost_at = 1}}});
}

}  // namespace pcphys::cases
