// The judge over the library itself, and replays that must have the same bits.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "wild/judge.h"
#include "wild/overlaps.h"
#include "wild/phantoms.h"
#include "wild/play.h"
#include "wild/shapes.h"

namespace pcphys::wild {
namespace {

using Clock = std::chrono::steady_clock;

/// The trace's own time does not count as the step's.
class TimedPhantoms final : public ContactTrace {
 public:
  Phantoms phantoms;
  Clock::duration spent{};

  void begin(const WorldState& state) override {
    const auto start = Clock::now();
    phantoms.begin(state);
    spent += Clock::now() - start;
  }
  void substep(const WorldState& state, double h, std::span<const TracedContact> contacts) override {
    const auto start = Clock::now();
    phantoms.substep(state, h, contacts);
    spent += Clock::now() - start;
  }
};

/// Sub-steps of bodies, of their joints and of points of contact, and pairs that were looked at, for each body that
/// moves.
double counted_work(const StepReport& r, const StepSettings& settings, double bodies) {
  const double rows = double(r.joints) + double(r.points), base = settings.substeps, most = r.substeps;
  const double refined = bodies > 0 ? double(r.refined) / bodies : 0;
  const double once = double(r.pairs) + (bodies + rows) * (base + (most - base) * refined);
  return (1 + double(r.repeats)) * once / std::max(bodies, 1.0);
}

class LibraryWatcher final : public Watcher {
 public:
  LibraryWatcher(const Scene& scene, const PlayOptions& options) : judge(scene, options.precision) {}
  Judge judge;
  TimedPhantoms trace;

  void before_call(const Player& player, const Call& call) override {
    if (begun_ && !std::holds_alternative<Steps>(call)) before_ = eye_.look(player);
  }
  void after_call(const Player& player, const Call& call, const Status& status) override {
    eye_.follow(call);
    if (std::holds_alternative<Steps>(call)) {
      if (begun_) return;
      begun_ = true;
      before_ = eye_.look(player);
      judge.begin(before_);
      overlaps_.made(eye_);
      return;
    }
    if (!begun_ || !status) return;
    const Observation& after = eye_.look(player);
    judge.changed(before_, after);
    before_ = after;
    if (const SetPose* moved = std::get_if<SetPose>(&call)) {
      overlaps_.made(eye_, moved->body, true);
      for (std::size_t i = 0; i < after.joints.size(); i++)
        if (after.joints[i].a == moved->body || after.joints[i].b == moved->body) allow_gap(int(i));
    }
    if (const MakeJoint* made = std::get_if<MakeJoint>(&call)) allow_gap(made->joint);
    if (const MakeBody* made = std::get_if<MakeBody>(&call)) overlaps_.made(eye_, made->body, true);
    if (std::holds_alternative<Destroy>(call) || std::holds_alternative<SetFilter>(call) ||
        std::holds_alternative<SetCollide>(call))
      overlaps_.made(eye_);
  }
  bool after_step(const Player& player, double dt, const StepReport& report) override {
    const Observation& after = eye_.look(player);
    StepFacts facts;
    facts.dt = dt;
    judge.allow(overlaps_.undone(eye_, player.settings(), dt));
    const bool traced = player.options().place == Place::cpu;
    if (traced) {
      facts.contact_work = trace.phantoms.driven_work();
      facts.contact_impulses = trace.phantoms.impulses();
      facts.phantom = trace.phantoms.widest();
    }
    double bodies = 0;
    for (const SeenBody& b : after.bodies) bodies += b.there && b.kind == BodyKind::dynamic;
    facts.work = counted_work(report, player.settings(), bodies);
    facts.frozen = report.frozen.size();
    judge.stepped(before_, after, facts);
    before_ = after;
    return true;
  }
  void end(const Player& player) {
    const Observation& seen = eye_.look(player);
    judge.ended(seen, deepest_share(player));
  }

 private:
  /// Bodies of a joint that the host has opened may be lifted by its gap: it is closed by places alone.
  void allow_gap(int number) {
    const Observation& seen = eye_.seen();
    const SeenJoint& joint = seen.joints[std::size_t(number)];
    if (!joint.there) return;
    const SeenBody &a = seen.body(joint.a), &b = seen.body(joint.b);
    double mass = 0;
    for (const SeenBody* body : {&a, &b}) mass += body->kind == BodyKind::dynamic ? body->mass.mass : 0;
    const double open = gap(seen, joint);
    judge.allow(mass * length(seen.gravity) * open);
    judge.opened(number, open);
  }
  /// Of the contacts of the last step.
  double deepest_share(const Player& player) const {
    const World& world = player.world();
    double deepest = 0;
    for (const Contact& c : world.contacts()) {
      double smaller = 1e30;
      for (const BodyId id : {c.a, c.b}) {
        const auto shapes = world.shapes(id);
        if (!shapes) continue;
        for (const ShapeDef& s : *shapes)
          if (s.kind != ShapeKind::plane) smaller = std::min(smaller, 2 * outer_radius(s));
      }
      for (const Contact::Point& p : c.points) deepest = std::max(deepest, -p.separation / smaller);
    }
    return deepest;
  }

  Eye eye_;
  Overlaps overlaps_;
  Observation before_;
  bool begun_ = false;
};

std::uint64_t played_hash(const Scene& scene, const PlayOptions& options) {
  Player player(scene, options);
  if (Status ok = player.play(); !ok) return 0;
  return player.own_hash();
}

/// Objects that are made between steps have other ids where unrelated islands took some.
bool makes_while_it_runs(const Scene& scene) {
  bool stepped = false;
  for (const Call& call : scene.calls) {
    stepped |= std::holds_alternative<Steps>(call);
    const bool makes = std::holds_alternative<MakeBody>(call) || std::holds_alternative<MakeRagdoll>(call) ||
                       std::holds_alternative<MakeJoint>(call) || std::holds_alternative<MakeSpring>(call) ||
                       std::holds_alternative<Destroy>(call) || std::holds_alternative<Restore>(call);
    if (stepped && makes) return true;
  }
  return false;
}

}  // namespace

Verdict judge(const Scene& scene, const PlayOptions& options) {
  Player player(scene, options);
  LibraryWatcher watcher(scene, options);
  if (options.place == Place::cpu) player.set_trace(&watcher.trace);
  const Status played = player.play(&watcher);
  if (!played) watcher.judge.verdict().failure = played.error().message;
  watcher.end(player);
  player.set_trace(nullptr);
  Verdict verdict = watcher.judge.verdict();
  verdict.seconds = player.seconds() - std::chrono::duration<double>(watcher.trace.spent).count();
  return verdict;
}

void judge_bits(const Scene& scene, const PlayOptions& options, bool gl, Verdict& verdict) {
  PlayOptions plain = options;
  plain.lanes = 1;
  const std::uint64_t expected = played_hash(scene, plain);
  double other = 0;
  const auto compare = [&](auto change) {
    PlayOptions changed = options;
    change(changed);
    other += played_hash(scene, changed) != expected;
  };
  // each differs in several ways: what one of them alone would change shows all the same
  compare([](PlayOptions& o) { o.lanes = 4, o.steppers = 2; });
  compare([&](PlayOptions& o) { o.lanes = options.precision == Precision::f32 ? 8 : 4, o.fresh_every = 5; });
  compare([](PlayOptions& o) { o.threads = 2; });
  compare([](PlayOptions& o) { o.fresh_every = 7, o.restored = true; });
  if (!makes_while_it_runs(scene)) compare([](PlayOptions& o) { o.unrelated = true; });
  if (gl) compare([](PlayOptions& o) { o.place = Place::gl; });
  if (gl) compare([](PlayOptions& o) { o.place = Place::gl, o.mixed = true, o.steppers = 2; });
  Finding& f = verdict[Measure::bits];
  f.measured = true;
  f.worst = other;
  f.bound = 0;
  f.step = verdict.steps;
}

}  // namespace pcphys::wild
