// B3, B4, B9: what stands, and must go on standing.
#include <algorithm>
#include <array>
#include <numbers>

#include "parts.h"

namespace pcphys::cases {
namespace {

using std::numbers::pi;
const std::vector<double> fine{1.0 / 240};

Simulated& tower(Trial& trial, int count, double top_mass) {
  return trial.start([=](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    add_tower(builder, count, top_mass);
  });
}

/// Of cubes on one another: the largest by which one is nearer to what it stands on than it should be [m].
double sunk(const Simulated& run, int count) {
  Worst worst;
  double below = -0.5 * cube_edge;
  for (int i = 1; i <= count; ++i) {
    const double z = run.pose(i).position.z;
    worst.add(std::max(0.0, below + cube_edge - z));
    below = z;
  }
  return worst;
}

/// How far boxes have been from where they were built, at any tenth step of so many seconds.
Moved farthest(Trial& trial, Simulated& run, double seconds) {
  Worst across, below;
  for (long k = 0; k < trial.steps(seconds) / 10; ++k) {
    run.step(trial.dt(), 10);
    const Moved m = moved(run);
    across.add(m.across);
    below.add(m.down);
  }
  return {across, below};
}

// ---- B3 ------------------------------------------------------------------------------------------------

void heavy_tower(Trial& trial, int count, double top_mass, bool bounded) {
  Simulated& run = tower(trial, count, top_mass);
  Worst across, depth;
  for (long k = 0; k < trial.steps(10) / 10; ++k) {
    run.step(trial.dt(), 10);
    across.add(moved(run).across);
    depth.add(sunk(run, count));
  }
  trial.report("across [m]", across, bounded ? std::optional(0.05) : std::nullopt);
  trial.report("overlap [m]", depth, bounded ? std::optional(count == 2 ? 0.01 : 0.005) : std::nullopt);
}

void heavy_pyramid(Trial& trial, double ratio) {
  Simulated& run = trial.start([=](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    builder.set_material(0.6, 0);
    add_floor(builder);
    add_pyramid(builder, {.base = 10, .top_mass = ratio});
  });
  run.step(trial.dt(), trial.steps(10));
  const Moved m = moved(run);
  trial.report("across [m]", m.across, 0.05);
  trial.report("down [m]", m.down);
}

// ---- B4 ------------------------------------------------------------------------------------------------

void plain_tower(Trial& trial, int count) {
  Simulated& run = tower(trial, count, 1);
  const auto [across, dz] = farthest(trial, run, 10);
  const bool coarse = trial.dt() > 1.0 / 100, bounded = count <= (coarse ? 10 : 30);
  trial.report("across [m]", across, bounded ? std::optional(0.05) : std::nullopt, 0.05);
  trial.report("down [m]", dz, bounded ? std::optional(coarse ? 5e-3 : 1e-3) : std::nullopt);
  // force below cube k, from the impulses of the last sub-step
  std::vector<double> force(std::size_t(count) + 1, 0);
  const auto place = [&](BodyId id) {
    for (int i = 0; i <= count; ++i)
      if (run.problem().scene.bodies[std::size_t(i)].id == id) return i;
    return 0;
  };
  for (const Contact& contact : run.problem().world.contacts())
    for (const Contact::Point& point : contact.points)
      force[std::size_t(std::max(place(contact.a), place(contact.b)))] +=
          point.impulse * double(trial.substeps()) / trial.dt();
  Worst off;
  for (int i = 1; i <= count; ++i) off.add(std::fabs(force[std::size_t(i)] / ((count + 1 - i) * gravity) - 1));
  trial.report("contact forces, relative", off, bounded ? std::optional(0.02) : std::nullopt);
}

// ---- B9 ------------------------------------------------------------------------------------------------

/// Box2D's and Box3D's (samples, class CardHouse; E. Catto, MIT): five storeys of cards that lean by 25 degrees, with
/// level ones across.
void card_house(Trial& trial, double margin) {
  const double thin = 0.001, half = 0.2, deep = 0.1, lean = 25 * pi / 180;
  Simulated& run = trial.start(
      [=](scenes::Builder& builder) {
        (void)builder.world().set_gravity(down);
        builder.set_material(0.7, 0);
        add_floor(builder);
        const auto card = [&](double x, double z, double angle) {
          add_block(builder, {thin, deep, half}, 1000 * 8 * thin * deep * half,
                    {{x, 0, z}, axis_angle({0, 1, 0}, angle)});
        };
        double first = 0, z = half - 0.02;
        for (int storey = 5; storey > 0; --storey) {
          double x = first;
          for (int i = 0; i < storey; ++i) {
            if (i + 1 < storey) card(x + 0.25, z + half - 0.015, 0.5 * pi);
            card(x, z, lean);
            x += 0.175;
            card(x, z, -lean);
            x += 0.175;
          }
          z += 2 * half - 0.03;
          first += 0.175;
        }
      },
      [=](StepSettings& s) { s.contact_margin = margin; });
  run.step(trial.dt(), trial.steps(20));
  const Moved m = moved(run);
  trial.report("across [m]", m.across, 0.05);
  trial.report("down [m]", m.down, 0.05);
}

/// Between two of its joints, or a joint and its mirror image, an arch has a stone: 1 m deep, of 200 kg/m^3.
void add_stone(scenes::Builder& builder, std::array<Vec3, 4> face) {
  std::vector<Vec3> corners;
  for (const Vec3& corner : face)
    for (double y : {-0.5, 0.5}) corners.push_back(corner + Vec3{0, y, 0});
  const Result<Hull> hull = make_hull(corners);
  if (!hull) return builder.fail(hull.error());
  BodyDef def;
  def.shapes = {ShapeDef::hull(*hull)};
  def.density = 200;
  def.pose = hull->frame();
  builder.add(def);
}

/// Box2D's and Box3D's: 17 stones without mortar, and four slabs on the keystone.
void arch(Trial& trial) {
  static const Csv joints = read_csv("B09_arch.csv");
  Simulated& run = trial.start([](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    builder.set_material(0.6, 0);
    add_level_floor(builder);
    const auto inner = [](std::size_t i, double side) {
      return Vec3{side * joints.at(i, "x_inner"), 0, joints.at(i, "z_inner")};
    };
    const auto outer = [](std::size_t i, double side) {
      return Vec3{side * joints.at(i, "x_outer"), 0, joints.at(i, "z_outer")};
    };
    const std::size_t last = joints.rows.size() - 1;
    for (double side : {1.0, -1.0})
      for (std::size_t i = 0; i < last; ++i)
        add_stone(builder, {inner(i, side), outer(i, side), outer(i + 1, side), inner(i + 1, side)});
    add_stone(builder, {inner(last, 1), outer(last, 1), outer(last, -1), inner(last, -1)});
    const Vec3 half{2, 0.5, 0.5};
    for (int i = 0; i < 4; ++i)
      add_block(builder, half, 200 * 8 * half.x * half.y * half.z,
                {{0, 0, outer(last, 1).z + half.z * (2 * i + 1)}, {}});
  });
  const auto [across, sunk] = farthest(trial, run, 60);
  trial.report("across [m]", across, 0.02);
  trial.report("down [m]", sunk, 0.02);
}

/// 18 layers of three blocks each, laid crosswise.
void jenga(Trial& trial) {
  const Vec3 half{0.0375, 0.0125, 0.0075};
  Simulated& run = trial.start([=](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    builder.set_material(0.5, 0);
    add_floor(builder);
    for (int layer = 0; layer < 18; ++layer)
      for (int i = -1; i <= 1; ++i) {
        const bool turned = layer % 2 == 1;
        const Vec3 centre{turned ? 2 * half.y * i : 0, turned ? 0 : 2 * half.y * i, half.z * (2 * layer + 1)};
        add_block(builder, half, 0.015, {centre, turned ? axis_angle({0, 0, 1}, 0.5 * pi) : Quat{}});
      }
  });
  run.step(trial.dt(), trial.steps(20));
  const Moved m = moved(run);
  trial.report("across [m]", m.across, 0.005);
  trial.report("down [m]", m.down, 0.005);
}

/// Box3D's (samples, class JengaStack; E. Catto, MIT): 30 layers of two beams each, laid crosswise; 1 cm of air between
/// two layers, and the lowest is half sunk into the floor.
void beams(Trial& trial) {
  const double thick = 0.1, half = 1;
  const int layers = 30;
  Simulated& run = trial.start([=](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    builder.set_material(0.6, 0);
    add_floor(builder);
    for (int layer = 0; layer < layers; ++layer)
      for (const double side : {1.0, -1.0}) {
        const bool turned = layer % 2 == 0;
        const double out = side * (half - 2 * thick);
        const Vec3 centre{turned ? out : 0, turned ? 0 : out, (2.1 * layer + 0.5) * thick};
        add_block(builder, {half, thick, thick}, 1000 * 8 * half * thick * thick,
                  {centre, turned ? axis_angle({0, 0, 1}, 0.5 * pi) : Quat{}});
      }
  });
  std::vector<Vec3> start;
  for (int i = 0; i < 2 * layers; ++i) start.push_back(run.pose(i + 1).position);
  run.step(trial.dt(), trial.steps(20));
  Worst across, height;
  for (int i = 0; i < 2 * layers; ++i) {
    const Vec3 at = run.pose(i + 1).position, from = start[std::size_t(i)];
    across.add(std::hypot(at.x - from.x, at.y - from.y));
    height.add(std::fabs(at.z - (2 * (i / 2) + 1) * thick));
  }
  trial.report("across [m]", across, 0.05);
  trial.report("off its height [m]", height, 0.05);
}

/// A row of dominoes, of which the first is pushed: all must fall.
void dominoes(Trial& trial) {
  const int count = 20;
  Simulated& run = trial.start([=](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    builder.set_material(0.4, 0);
    add_floor(builder);
    for (int i = 0; i < count; ++i) {
      BodyDef def;
      def.shapes = {ShapeDef::box({0.05, 0.2, 0.4})};
      def.mass = 1;
      def.pose.position = {0.4 * i, 0, 0.4};
      if (i == 0) def.angular_velocity = {0, 2.5, 0}, def.velocity = {1, 0, 0};
      builder.add(def);
    }
  });
  run.step(trial.dt(), trial.steps(8));
  int standing = 0;
  for (int i = 1; i <= count; ++i) standing += rotate(run.pose(i).orientation, {0, 0, 1}).z > 0.9;
  trial.report("dominoes that stand", standing, 0.0);
  trial.report("not finite", nonfinite(run), 0.0);
}

}  // namespace

void add_stacks(std::vector<Case>& cases) {
  const auto name = [](const char* format, double x) {
    char text[64];
    std::snprintf(text, sizeof text, format, x);
    return std::string(text);
  };
  const std::vector<double> longer{1.0 / 60};
  const std::vector<std::uint32_t> fewer{1, 2};  // sub-steps
  Case& heavy = cases.emplace_back(Case{"B3", "heavy on light", {}});
  for (double top : {10.0, 100.0, 1e3, 1e4})
    heavy.variants.push_back({.name = name("tower of 10, top x%g", top),
                              .run = [=](Trial& t) { heavy_tower(t, 10, top, top <= 100); },
                              .steps = fine,
                              .substeps = {4},
                              .more_steps = longer,
                              .more_substeps = fewer,
                              .lost_at = 0.5});
  for (double top : {1.0, 100.0, 1e4, 1e6})
    heavy.variants.push_back({.name = name("two boxes, 1:%g", top),
                              .run = [=](Trial& t) { heavy_tower(t, 2, top, top <= 1e4); },
                              .steps = fine,
                              .substeps = {4},
                              .more_steps = longer,
                              .more_substeps = fewer,
                              .lost_at = 0.5});
  for (double top : {100.0, 200.0, 300.0})
    heavy.variants.push_back({.name = name("pyramid of 10, top x%g", top),
                              .run = [=](Trial& t) { heavy_pyramid(t, top); },
                              .steps = fine,
                              .substeps = {4},
                              .more_steps = longer,
                              .more_substeps = fewer,
                              .lost_at = 0.5});

  Case& towers = cases.emplace_back(Case{"B4", "towers of cubes", {}});
  for (int count : {10, 20, 30, 40, 100})
    towers.variants.push_back({.name = std::to_string(count) + " cubes",
                               .run = [=](Trial& t) { plain_tower(t, count); },
                               .steps = {1.0 / 60, 1.0 / 240},
                               .substeps = {4},
                               .more_substeps = fewer,
                               .lost_at = 0.5});

  cases.push_back({"B9",
                   "card house, arch, jenga, beams, dominoes",
                   {{.name = "cards",
                     .run = [](Trial& t) { card_house(t, StepSettings{}.contact_margin); },
                     .steps = fine,
                     .substeps = {4},
                     .more_steps = longer,
                     .more_substeps = fewer,
                     .lost_at = 0.5},
                    {.name = "cards, margin 0.5 mm",
                     .run = [](Trial& t) { card_house(t, 5e-4); },
                     .steps = fine,
                     .substeps = {4},
                     .more_steps = longer,
                     .more_substeps = fewer,
                     .lost_at = 0.5},
                    {.name = "arch",
                     .run = arch,
                     .steps = {1.0 / 60},
                     .substeps = {4},
                     .more_steps = {1.0 / 30},
                     .more_substeps = fewer,
                     .lost_at = 0.5},
                    {.name = "jenga",
                     .run = jenga,
                     .steps = fine,
                     .substeps = {4},
                     .more_steps = longer,
                     .more_substeps = fewer,
                     .lost_at = 0.5},
                    {.name = "30 layers of beams",
                     .run = beams,
                     .steps = fine,
                     .substeps = {4},
                     .more_steps = longer,
                     .more_substeps = fewer,
                     .lost_at = 0.5},
                    {.name = "dominoes",
                     .run = dominoes,
                     .steps = fine,
                     .substeps = {4},
                     .more_steps = longer,
                     .more_substeps = fewer}}});
}

}  // namespace pcphys::cases
