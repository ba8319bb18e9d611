// C13, C14, C15: 100,000 bodies in one place, on lines and planes, and over twelve orders of size. What touches is
// counted by brute force beside it.
#include <algorithm>
#include <functional>
#include <limits>

#include "parts.h"

namespace pcphys::cases {
namespace {

constexpr int many = 100000, few = 2000;
using Place = std::function<Vec3(int, int, scenes::Random&)>;  // of body i of n

/// Spheres of this radius without gravity, in a world of their own: the first step's report is what is asked for.
struct Crowd {
  World world;
  Stepper stepper;
  std::vector<Vec3> centres;

  Crowd(const Trial& trial, double radius, int count, const Place& place, double margin)
      : world({trial.is_double() ? Precision::f64 : Precision::f32, {}}) {
    StepSettings settings;
    settings.contact_margin = margin;
    settings.substeps = trial.substeps();
    (void)stepper.configure(settings);
    scenes::Random random(13);
    BodyDef def;
    def.shapes = {ShapeDef::sphere(radius)};
    def.mass = 1;
    for (int i = 0; i < count; ++i) {
      def.pose.position = place(i, count, random);
      // as a float world holds it
      if (!trial.is_double())
        def.pose.position = {float(def.pose.position.x), float(def.pose.position.y), float(def.pose.position.z)};
      centres.push_back(def.pose.position);
      (void)world.create_body(def);
    }
  }
};

/// Pairs within `reach` of each other, one by one.
std::size_t brute_force(const std::vector<Vec3>& centres, double reach) {
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < centres.size(); ++i)
    for (std::size_t j = i + 1; j < centres.size(); ++j) {
      const Vec3 d = centres[j] - centres[i];
      pairs += dot(d, d) <= reach * reach;
    }
  return pairs;
}

/// How many contacts a crowd of this kind has, beside brute force. A pair on the very edge of the margin may be told
/// otherwise by rounding.
double wrong_contacts(Trial& trial, double radius, const Place& place, double margin) {
  Crowd crowd(trial, radius, few, place, margin);
  const StepReport& report = crowd.stepper.step(crowd.world, 1e-6);
  if (!report) return std::numeric_limits<double>::quiet_NaN();
  const double reach = 2 * radius + margin, edge = trial.either(1e-12, 1e-6);
  const std::size_t low = brute_force(crowd.centres, reach - edge), high = brute_force(crowd.centres, reach + edge);
  const std::size_t found = report.contacts;
  return found < low ? double(low - found) : found > high ? double(found - high) : 0;
}

/// Milliseconds of the broad phase in the first step, which builds everything.
double broad_ms(Trial& trial, double radius, const Place& place, double margin) {
  double best = std::numeric_limits<double>::infinity();
  for (int repeat = 0; repeat < 3; ++repeat) {
    Crowd crowd(trial, radius, many, place, margin);
    const StepReport& report = crowd.stepper.step(crowd.world, 1e-6);
    if (!report) return std::numeric_limits<double>::quiet_NaN();
    best = std::min(best, report.ms[std::size_t(Timer::broad)]);
  }
  return best;
}

/// `pairs` of shapes are too many: the step says so with their number, and loses nothing.
void overflow(Trial& trial, const Place& place, const std::string& pairs) {
  Crowd crowd(trial, 0.01, many, place, 1e-3);
  const std::uint64_t before = crowd.world.hash();
  const StepReport& report = crowd.stepper.step(crowd.world, trial.dt());
  const bool named =
      report.error.code == ErrorCode::buffer_full && report.error.message.find(pairs) != std::string::npos;
  trial.report("overflow without the " + pairs + " pairs that are needed", named ? 0 : 1, 0.0);
  trial.report("world changed", crowd.world.hash() == before && crowd.world.body_count() == many ? 0 : 1, 0.0);
  trial.report("step [s]", 1e-3 * report.total_ms, 60.0);
}

Vec3 in_cube(int, int, scenes::Random& random) {
  const double x = random.between(0, 1), y = random.between(0, 1), z = random.between(0, 1);
  return {x, y, z};
}

// ---- C13 -----------------------------------------------------------------------------------------------

void cube(Trial& trial) {
  const double margin = 1e-3;  // a tenth of the radius
  trial.report("contacts that differ from brute force, 2000 bodies", wrong_contacts(trial, 0.05, in_cube, 5e-3), 0.0);
  Crowd crowd(trial, 0.01, many, in_cube, margin);
  const StepReport& report = crowd.stepper.step(crowd.world, trial.dt());
  trial.report("refused steps", report ? 0 : 1, 0.0);
  trial.report("step [s]", 1e-3 * report.total_ms, 60.0);
  std::size_t bytes = 0;
  for (const BufferUse& use : crowd.stepper.memory(crowd.world)) bytes += use.bytes;
  trial.report("memory of world and step [GB]", 1e-9 * double(bytes), 2.0);
  trial.report("lost bodies", double(many) - double(crowd.world.body_count()), 0.0);
}

// ---- C14 -----------------------------------------------------------------------------------------------

/// Side of a cube in which as many spheres of 0.01 m meet as on the other arrangements.
Vec3 cloud(int, int count, scenes::Random& random) {
  const double side = 0.03 * std::cbrt(double(count));
  const Vec3 p = in_cube(0, 0, random);
  return side * p;
}

struct Arrangement {
  const char* name;
  Place place;
};

const Arrangement arrangements[] = {
    {"line",
     [](int, int n, scenes::Random& r) {
       return Vec3{r.between(0, 0.03 * n), 0, 0};
     }},
    {"line, sorted",
     [](int i, int, scenes::Random&) {
       return Vec3{0.015 * i, 0, 0};
     }},
    {"line, sorted backwards",
     [](int i, int n, scenes::Random&) {
       return Vec3{0.015 * (n - i), 0, 0};
     }},
    {"plane",
     [](int, int n, scenes::Random& r) {
       const double side = 0.03 * std::sqrt(double(n)), x = r.between(0, side), y = r.between(0, side);
       return Vec3{x, y, 0};
     }},
    {"equal x", [](int, int n, scenes::Random& r) {
       const double side = 0.03 * std::sqrt(double(n)), y = r.between(0, side), z = r.between(0, side);
       return Vec3{1e3, y, z};
     }}};

void arranged(Trial& trial, const Arrangement& a) {
  trial.report("contacts that differ from brute force, 2000 bodies", wrong_contacts(trial, 0.01, a.place, 1e-3), 0.0);
  const double usual = broad_ms(trial, 0.01, cloud, 1e-3), here = broad_ms(trial, 0.01, a.place, 1e-3);
  trial.report("broad phase over that of a cloud", here / usual, 3.0);
}

// ---- C15 -----------------------------------------------------------------------------------------------

/// 10,000 spheres of 1 mm, on a ground of 10 km, and others 1,000 km away.
void spread(Trial& trial) {
  const int count = 10000;
  double ms[2] = {}, wrong = 0;
  for (int with = 0; with < 2; ++with)
    for (int repeat = 0; repeat < 3; ++repeat) {
      Crowd crowd(
          trial, 1e-3, count,
          [](int, int, scenes::Random& r) {
            const Vec3 p = in_cube(0, 0, r);
            return Vec3{0.1 * p.x, 0.1 * p.y, 0.001 + 0.1 * p.z};
          },
          1e-4);
      if (with) {
        BodyDef ground;
        ground.kind = BodyKind::fixed;
        ground.shapes = {ShapeDef::box({5e3, 5e3, 1})};
        ground.pose.position = {0, 0, -1};
        (void)crowd.world.create_body(ground);
        BodyDef far;
        far.shapes = {ShapeDef::sphere(1)};
        far.mass = 1;
        for (double side : {-1e6, 1e6})
          for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
            far.pose.position = side * axis;
            (void)crowd.world.create_body(far);
          }
      }
      const StepReport& report = crowd.stepper.step(crowd.world, 1e-6);
      const double took = report ? report.ms[std::size_t(Timer::broad)] : std::numeric_limits<double>::quiet_NaN();
      ms[with] = repeat == 0 ? took : std::min(ms[with], took);
      if (with == 0 || repeat > 0) continue;
      const double reach = 2e-3 + 1e-4, edge = trial.either(1e-12, 1e-7);
      const auto expected = [&](double slack) {  // among each other, and with the ground below z = 0
        const auto low = std::ranges::count_if(crowd.centres, [&](Vec3 c) { return c.z < 1e-3 + 1e-4 + slack; });
        return brute_force(crowd.centres, reach + slack) + std::size_t(low);
      };
      const std::size_t low = expected(-edge), high = expected(edge);
      wrong = double(report.contacts < low    ? low - report.contacts
                     : report.contacts > high ? report.contacts - high
                                              : 0);
    }
  trial.report("contacts that differ from brute force", wrong, 0.0);
  trial.report("broad phase over that without the large and the far", ms[1] / ms[0], 3.0);
}

}  // namespace

void add_crowds(std::vector<Case>& cases) {
  const std::vector<double> frame{1.0 / 60};
  cases.push_back({"C13",
                   "100,000 spheres in a cube of 1 m, and in one point",
                   {{.name = "cube", .run = cube, .steps = frame, .substeps = {4}},
                    {.name = "one point",
                     .run =
                         [](Trial& t) {
                           overflow(
                               t, [](int, int, scenes::Random&) { return Vec3{}; }, "4999950000");
                         },
                     .steps = frame,
                     .substeps = {4}}}});
  Case& c = cases.emplace_back(Case{"C14", "100,000 spheres on a line, a plane, in two points", {}});
  for (const Arrangement& a : arrangements)
    c.variants.push_back({.name = a.name, .run = [&a](Trial& t) { arranged(t, a); }, .steps = frame, .substeps = {1}});
  c.variants.push_back({.name = "two points",
                        .run =
                            [](Trial& t) {
                              overflow(
                                  t,
                                  [](int i, int, scenes::Random&) {
                                    return Vec3{i % 2 ? 5.0 : 0.0, 0, 0};
                                  },
                                  "2499950000");
                            },
                        .steps = frame,
                        .substeps = {4}});
  cases.push_back({"C15",
                   "sizes from 1 mm to 10 km in one world",
                   {{.name = "10,000 and a ground", .run = spread, .steps = frame, .substeps = {1}}}});
}

}  // namespace pcphys::cases
