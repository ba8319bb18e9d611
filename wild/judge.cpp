#include "wild/judge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace pcphys::wild {
namespace {

constexpr double f32_rounding = 1e-5, f64_rounding = 1e-11;   // of momentum and of speed
constexpr double encounter_f32 = 1e-5, encounter_f64 = 1e-9;  // energy of a single encounter
constexpr double energy_share = 1e-3;                         // of everything else
constexpr double widest_gap_allowed = 1e-4;                   // of joints [m]
constexpr double excess_allowed = std::numbers::pi / 180;     // of limits [rad]
constexpr double overlap_allowed = 0.02;                      // at rest, of the smaller shape
constexpr double glide_lost = 1e-3;
constexpr double hop_allowed = 1e-3;  // of the size
constexpr double work_allowed = 20;
constexpr double slow = 0.05;  // what is at rest [m/s]

constexpr MeasureInfo infos[] = {
    {"energy", "1", "energy made within steps beyond what drives put in, over the scene's scale"},
    {"momentum", "1", "change of the momentum of what is free, over the sum of magnitudes"},
    {"angular_momentum", "1", "change of the angular momentum of what is free, over the sum of magnitudes"},
    {"free_speed", "1", "change of the motion of what touches nothing, over its speed"},
    {"phantom", "1",
     "gap over which a contact pushed, over the larger of a thousandth of the smaller shape and 0.1 mm"},
    {"overlap", "1", "overlap at rest, over the smaller shape's size"},
    {"joint_gap", "m", "widest gap of a joint"},
    {"limit_excess", "rad", "most that a joint is beyond its limits"},
    {"glide", "1", "change of velocity along level, frictionless tiles, over the speed"},
    {"hop", "1", "height to which what glides is sent by them, over its size"},
    {"stand", "m", "how far a body of a tower moved"},
    {"lost", "bodies", "outside of where they belong"},
    {"frozen", "bodies", "that the engine gave up"},
    {"not_finite", "bodies", "with numbers that are none"},
    {"work", "1", "counted work of the costliest step, over the median's"},
    {"bits", "replays", "with other bits"}};
static_assert(std::size(infos) == measure_count);

bool is_finite(const SeenBody& b) {
  return finite(b.pose.position) && finite(b.pose.orientation) && finite(b.velocity) && finite(b.angular_velocity);
}

/// Whether nothing outside of the world's own bodies acts on them.
bool is_closed(const Observation& seen) {
  if (seen.gravity != Vec3{}) return false;
  for (const SeenBody& b : seen.bodies) {
    if (!b.there) continue;
    if (b.kind != BodyKind::dynamic || b.force != Vec3{} || b.torque != Vec3{} || b.drag > 0) return false;
  }
  const auto to_ground = [](const auto& j) { return j.there && (j.a == ground || j.b == ground); };
  return std::none_of(seen.joints.begin(), seen.joints.end(), to_ground) &&
         std::none_of(seen.springs.begin(), seen.springs.end(), to_ground);
}

}  // namespace

const MeasureInfo& info(Measure measure) { return infos[std::size_t(measure)]; }

bool Verdict::broken() const {
  return !failure.empty() || std::any_of(of.begin(), of.end(), [](const Finding& f) { return f.broken(); });
}

double Finding::excess() const {
  if (std::isnan(worst)) return std::numeric_limits<double>::infinity();
  if (*bound > 0) return worst / *bound;
  return worst > 0 ? 1 + worst : 0;
}

Measure Verdict::worst() const {
  Measure worst = Measure::count;
  for (std::size_t i = 0; i < measure_count; i++)
    if (of[i].broken() && (worst == Measure::count || of[i].excess() > (*this)[worst].excess())) worst = Measure(i);
  return worst;
}

Judge::Judge(const Scene& scene, Precision precision)
    : scene_(scene),
      f64_(precision == Precision::f64),
      rounding_(f64_ ? double(std::numeric_limits<double>::epsilon()) : double(std::numeric_limits<float>::epsilon())),
      balance_(rounding_, !scene.rules.single_encounter) {}

double Judge::energy_bound() const {
  if (!scene_.rules.single_encounter) return energy_share;
  return f64_ ? encounter_f64 : encounter_f32;
}

void Judge::raise(Measure measure, double value, std::optional<double> bound) {
  Finding& f = verdict_[measure];
  f.bound = bound;
  // A value that is no number is the worst there is.
  const bool worse = !f.measured || !(value <= f.worst);
  f.measured = true;
  if (!worse) return;
  f.worst = std::isfinite(value) ? value : 1e300;
  f.step = verdict_.steps;
}

void Judge::begin(const Observation& seen) {
  balance_.begin(seen);
  start_ = seen;
  closed_ = is_closed(seen);
}

void Judge::changed(const Observation& before, const Observation& after) {
  balance_.changed(before, after);
  start_ = after;
  since_ = 0;
  closed_ = is_closed(after);
}

void Judge::judge_momentum(const Observation& seen, double dt) {
  if (!closed_) return;
  double momentum = 0, angular = 0;
  for (const SeenBody& b : seen.bodies) {
    if (!b.there) continue;
    const double least = b.kind == BodyKind::dynamic ? unresolved_speed(b, rounding_, dt) : 0;
    const double p = b.mass.mass * std::max(length(b.velocity), least);
    momentum += p;
    angular += p * length(b.pose.position) + length(angular_momentum_about_centre(b));
  }
  most_momentum_ = std::max(most_momentum_, momentum);
  most_angular_momentum_ = std::max(most_angular_momentum_, angular);
  const double bound = f64_ ? f64_rounding : f32_rounding;
  const double change = length(seen.momentum - start_.momentum);
  const double turned = length(seen.angular_momentum - start_.angular_momentum);
  if (most_momentum_ > 0) raise(Measure::momentum, change / most_momentum_, bound);
  if (most_angular_momentum_ > 0) raise(Measure::angular_momentum, turned / most_angular_momentum_, bound);
}

void Judge::judge_untouched(const Observation& seen) {
  const double bound = f64_ ? f64_rounding : f32_rounding;
  for (const int i : scene_.rules.untouched) {
    const SeenBody &then = start_.body(i), &now = seen.body(i);
    if (!now.there || now.kind != BodyKind::dynamic) continue;
    const Vec3 free = then.velocity + seen.gravity * since_;
    double fastest = 0;
    for (const int j : scene_.rules.untouched) fastest = std::max(fastest, length(start_.body(j).velocity));
    const double speed = std::max({length(free), fastest, 1e-30});
    const Vec3 turned = angular_momentum_about_centre(now) - angular_momentum_about_centre(then);
    const MassProperties& m = now.mass;
    const double lever = spread(m);
    const double spun = length(turned) / (length(angular_momentum_about_centre(then)) + m.mass * speed * lever);
    raise(Measure::free_speed, std::max(length(now.velocity - free) / speed, spun), bound);
  }
}

void Judge::judge_glide(const Observation& seen) {
  if (length(seen.gravity) == 0) return;  // a smaller scene, as it is shrunk
  for (const int i : scene_.rules.gliding) {
    const SeenBody& body = seen.body(i);
    const double g = length(seen.gravity);
    const Vec3 then = start_.body(i).velocity, up = (-1 / g) * seen.gravity;
    const double rises = std::max(0.0, dot(up, body.velocity));
    const Vec3 along = body.velocity - dot(up, body.velocity) * up;
    raise(Measure::glide, length(along - then) / length(then), glide_lost);
    raise(Measure::hop, rises * rises / (2 * g) / (2 * spread(body.mass)), hop_allowed);
  }
}

void Judge::judge_bodies(const Observation& seen) {
  double lost = 0, not_finite = 0, moved = 0;
  const Vec3 low = scene_.rules.lower, high = scene_.rules.upper;
  for (std::size_t i = 0; i < seen.bodies.size(); i++) {
    const SeenBody& b = seen.bodies[i];
    if (!b.there || b.kind != BodyKind::dynamic) continue;
    if (!is_finite(b)) {
      not_finite++;
      continue;
    }
    const Vec3 p = b.pose.position;
    const bool inside = p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z;
    lost += inside ? 0 : 1;
    moved = std::max(moved, length(p - start_.body(int(i)).pose.position));
  }
  raise(Measure::lost, lost, 0);
  raise(Measure::not_finite, not_finite, 0);
  if (scene_.rules.stands_within > 0) raise(Measure::stand, moved, scene_.rules.stands_within);
}

void Judge::stepped(const Observation& before, const Observation& after, const StepFacts& facts) {
  verdict_.steps++;
  since_ += facts.dt;
  for (const SeenBody& b : after.bodies) verdict_.body_steps += b.there && b.kind == BodyKind::dynamic;
  const bool alone = scene_.rules.single_encounter && after.bodies.size() == 2;
  double work = alone ? encounter_work(before, after, facts.dt)
                      : facts.contact_work + driven_work(before, after, facts.contact_impulses, facts.dt);
  work += closings_.work(before, after, energy(after) - energy(before) - work);
  balance_.stepped(after, work, facts.dt);
  raise(Measure::energy, balance_.rise(), energy_bound());
  judge_momentum(after, facts.dt);
  judge_untouched(after);
  judge_glide(after);
  judge_bodies(after);
  if (facts.phantom) raise(Measure::phantom, *facts.phantom, 1);
  raise(Measure::frozen, verdict_[Measure::frozen].worst + double(facts.frozen), 0);
  if (facts.work) works_.push_back(*facts.work);
  if (after.joints.empty()) return;
  const bool judged = !scene_.rules.joints_may_yield;
  raise(Measure::joint_gap, widest_gap(after), judged ? std::optional(widest_gap_allowed) : std::nullopt);
  raise(Measure::limit_excess, largest_excess(after), judged ? std::optional(excess_allowed) : std::nullopt);
}

void Judge::ended(const Observation& seen, double overlap) {
  double fastest = 0;
  for (const SeenBody& b : seen.bodies)
    if (b.there && b.kind == BodyKind::dynamic) fastest = std::max(fastest, length(b.velocity));
  if (scene_.rules.rests && fastest < slow) raise(Measure::overlap, overlap, overlap_allowed);
  if (works_.size() < 10) return;
  std::vector<double> sorted = works_;
  std::sort(sorted.begin(), sorted.end());
  raise(Measure::work, sorted.back() / sorted[sorted.size() / 2], work_allowed);
}

}  // namespace pcphys::wild
