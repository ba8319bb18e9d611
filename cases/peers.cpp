// The cases in other engines: a peer is made from the world that a case built.
#include "peers/peer.h"

#include "simulated.h"

namespace pcphys::cases {
namespace {

class Other final : public Simulated {
 public:
  Other(Problem problem, std::unique_ptr<peers::Peer> peer) : Simulated(std::move(problem)), peer_(std::move(peer)) {}

  Pose pose(int body) const override { return peer_->pose(std::size_t(body)); }
  Vec3 velocity(int body) const override { return peer_->velocity(std::size_t(body)); }
  Vec3 angular_velocity(int body) const override { return peer_->angular_velocity(std::size_t(body)); }

 protected:
  Status advance(double dt) override { return peer_->step(dt); }
  void apply_wrench(int body, const Wrench& wrench) override { check(peer_->set_wrench(std::size_t(body), wrench)); }
  void apply_gravity(Vec3 gravity) override { check(peer_->set_gravity(gravity)); }
  void apply_velocity(int body, Vec3 velocity, Vec3 angular_velocity) override {
    check(peer_->set_velocity(std::size_t(body), velocity, angular_velocity));
  }

 private:
  void check(const Status& status) {
    if (!status) refuse(status.error().message);
  }
  std::unique_ptr<peers::Peer> peer_;
};

class PeerEngine final : public Engine {
 public:
  PeerEngine(const peers::Variant& variant, double budget) : variant_(variant), budget_(budget) {}

  Result<std::unique_ptr<Simulated>> start(Problem problem, const Conditions& conditions) override {
    peers::Options options;
    options.substeps = int(conditions.settings.substeps);
    options.restitution_threshold = conditions.settings.restitution_threshold;
    std::vector<BodyId> bodies;
    for (const scenes::SceneBody& body : problem.scene.bodies) bodies.push_back(body.id);
    auto peer = peers::make(variant_.name, problem.world, bodies, options);
    if (!peer) return peer.error();
    if (const auto& missing = (*peer)->untranslated(); !missing.empty())  // an error of it would not be its own
      return Error{ErrorCode::unavailable, "Not its own motion: " + missing.front() + "."};
    return std::unique_ptr<Simulated>(std::make_unique<Other>(std::move(problem), std::move(*peer)));
  }
  double budget() const override { return budget_; }
  std::string peer() const override { return std::string(variant_.name); }
  bool has(Precision precision) const override {
    return (variant_.precision == "double") == (precision == Precision::f64);
  }

 private:
  const peers::Variant& variant_;
  double budget_;
};

}  // namespace

std::unique_ptr<Engine> make_peer(std::string_view name, double budget) {
  for (const peers::Variant& variant : peers::variants())
    if (variant.name == name && variant.found) return std::make_unique<PeerEngine>(variant, budget);
  return nullptr;
}

}  // namespace pcphys::cases
