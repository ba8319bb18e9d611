// The same scenes and the same judge in other engines: those that they can hold.
#include <chrono>
#include <memory>
#include <utility>
#include <vector>

#include "peers/peer.h"
#include "wild/judge.h"
#include "wild/overlaps.h"
#include "wild/play.h"

namespace pcphys::wild {
namespace {

Error cannot(const char* what) { return {ErrorCode::unavailable, std::string("Peers have no ") + what + "."}; }

/// A scene up to its first step, which the library builds and the peer is made of.
Scene beginning(const Scene& scene) {
  Scene first = scene;
  std::size_t calls = 0;
  while (calls < scene.calls.size() && !std::holds_alternative<Steps>(scene.calls[calls])) calls++;
  first.calls.resize(calls);
  return first;
}

/// Where the peer has the bodies; what else is seen stays as the library was told.
class PeerEye {
 public:
  PeerEye(const Player& player, const Scene& start) {
    for (const Call& call : start.calls) eye_.follow(call);
    eye_.look(player);
    for (int i = 0; i < player.body_numbers(); i++) {
      if (!player.world().valid(player.body(i))) continue;
      numbers_.push_back(i);
      ids_.push_back(player.body(i));
    }
  }
  const std::vector<BodyId>& ids() const { return ids_; }
  std::size_t index_of(int number) const {
    std::size_t i = 0;
    while (i < numbers_.size() && numbers_[i] != number) i++;
    return i;
  }
  Observation& seen() { return eye_.seen(); }
  const Eye& eye() const { return eye_; }

  const Observation& look(const peers::Peer& peer) {
    Observation& seen = eye_.seen();
    seen.momentum = seen.angular_momentum = {};
    for (std::size_t i = 0; i < numbers_.size(); i++) {
      SeenBody& b = seen.bodies[std::size_t(numbers_[i])];
      b.pose = peer.pose(i);
      b.velocity = peer.velocity(i);
      b.angular_velocity = peer.angular_velocity(i);
      if (b.kind != BodyKind::dynamic) continue;
      b.mass = peer.mass_properties(i);
      const Vec3 momentum = b.velocity * b.mass.mass;
      seen.momentum = seen.momentum + momentum;
      seen.angular_momentum =
          seen.angular_momentum + cross(b.pose.position, momentum) + angular_momentum_about_centre(b);
    }
    return seen;
  }

 private:
  Eye eye_;
  std::vector<int> numbers_;
  std::vector<BodyId> ids_;
};

/// That an engine computes in, and is judged by.
Precision precision_of(std::string_view variant) {
  for (const peers::Variant& v : peers::variants())
    if (v.name == variant && v.precision == "float") return Precision::f32;
  return Precision::f64;
}

/// What the host does between steps, as far as peers can.
Status apply(const Call& call, PeerEye& eye, peers::Peer& peer) {
  if (const SetVelocity* c = std::get_if<SetVelocity>(&call))
    return peer.set_velocity(eye.index_of(c->body), c->velocity, c->angular_velocity);
  if (const SetGravity* c = std::get_if<SetGravity>(&call)) {
    eye.seen().gravity = c->gravity;
    return peer.set_gravity(c->gravity);
  }
  const bool ours = std::holds_alternative<Configure>(call) || std::holds_alternative<SetCanSleep>(call) ||
                    std::holds_alternative<Wake>(call) || std::holds_alternative<Save>(call);
  return ours ? Status{} : Status(cannot("such changes between steps"));
}

}  // namespace

Result<Verdict> judge_peer(const Scene& scene, std::string_view variant) {
  const Scene start = beginning(scene);
  PlayOptions options;
  options.precision = Precision::f64;
  Player player(start, options);
  if (Status ok = player.play(); !ok) return ok.error();
  PeerEye eye(player, start);
  auto made = peers::make(variant, player.world(), eye.ids());
  if (!made) return made.error();
  peers::Peer& peer = **made;

  Judge judge(scene, precision_of(variant));
  judge.begin(eye.look(peer));
  Overlaps overlaps;
  overlaps.made(eye.eye());
  double seconds = 0;
  std::uint64_t failures = 0;
  for (std::size_t i = start.calls.size(); i < scene.calls.size(); i++) {
    const Steps* steps = std::get_if<Steps>(&scene.calls[i]);
    if (!steps) {
      const Observation before = eye.look(peer);
      if (Status ok = apply(scene.calls[i], eye, peer); !ok) return ok.error();
      judge.changed(before, eye.look(peer));
      continue;
    }
    for (int k = 0; k < steps->count; k++) {
      const Observation before = eye.seen();
      const auto began = std::chrono::steady_clock::now();
      const Status stepped = peer.step(steps->dt);
      seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
      if (!stepped) {
        judge.verdict().failure = stepped.error().message;
        return std::move(judge.verdict());
      }
      StepFacts facts;
      facts.dt = steps->dt;
      judge.allow(overlaps.undone(eye.eye(), scene.settings, steps->dt));
      facts.frozen = std::size_t(peer.failures() - std::exchange(failures, peer.failures()));
      judge.stepped(before, eye.look(peer), facts);
    }
  }
  judge.ended(eye.seen(), peer.deepest().value_or(0));
  judge.verdict().seconds = seconds;
  return std::move(judge.verdict());
}

}  // namespace pcphys::wild
