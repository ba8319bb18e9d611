#include "peer.h"

#include <algorithm>
#include <array>

#include "engines.h"

namespace pcphys::peers {
namespace {

using Maker = Result<std::unique_ptr<Peer>> (*)(const Description&, const Options&);

struct Entry {
  Variant variant;
  Maker make = nullptr;  // none: not found
};

Entry entry(Variant variant, Maker make, std::string version) {
  variant.found = make != nullptr;
  variant.version = std::move(version);
  return {std::move(variant), make};
}

std::vector<Entry> list() {
  Maker bullet = nullptr, quick = nullptr, dantzig = nullptr, euler = nullptr, rk4 = nullptr;
  std::string bullet_is, ode_is, mujoco_is;
#ifdef PCPHYS_HAVE_BULLET
  bullet = [](const Description& d, const Options& o) { return make_bullet(d, o); };
  bullet_is = bullet_version();
#endif
#ifdef PCPHYS_HAVE_ODE
  quick = [](const Description& d, const Options& o) { return make_ode(d, o, OdeStep::quick); };
  dantzig = [](const Description& d, const Options& o) { return make_ode(d, o, OdeStep::dantzig); };
  ode_is = ode_version();
#endif
#ifdef PCPHYS_HAVE_MUJOCO
  euler = [](const Description& d, const Options& o) { return make_mujoco(d, o, MujocoIntegrator::euler); };
  rk4 = [](const Description& d, const Options& o) { return make_mujoco(d, o, MujocoIntegrator::rk4); };
  mujoco_is = mujoco_version();
#endif
  return {entry({"bullet", "Bullet", "sequential impulses", "libbullet-dev", "float", false, {}}, bullet, bullet_is),
          entry({"ode", "ODE", "QuickStep", "libode-dev", "double", false, {}}, quick, ode_is),
          entry({"ode-dantzig", "ODE", "world step with Dantzig's solver", "libode-dev", "double", false, {}}, dantzig,
                ode_is),
          entry({"mujoco", "MuJoCo", "Newton, semi-implicit Euler", "libmujoco-dev", "double", false, {}}, euler,
                mujoco_is),
          entry({"mujoco-rk4", "MuJoCo", "Newton, Runge-Kutta of order 4", "libmujoco-dev", "double", false, {}}, rk4,
                mujoco_is)};
}

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all = list();
  return all;
}

}  // namespace

namespace {
const Error cannot{ErrorCode::unavailable, "This peer cannot be changed while it runs."};
}

Status Peer::set_wrench(std::size_t, const Wrench&) { return cannot; }
Status Peer::set_gravity(Vec3) { return cannot; }
Status Peer::set_velocity(std::size_t, Vec3, Vec3) { return cannot; }

std::span<const Variant> variants() {
  static const std::vector<Variant> all = [] {
    std::vector<Variant> result;
    for (const Entry& entry : entries()) result.push_back(entry.variant);
    return result;
  }();
  return all;
}

Result<std::unique_ptr<Peer>> make(std::string_view variant, const World& world, std::span<const BodyId> bodies,
                                   const Options& options) {
  std::string names;
  for (const Entry& entry : entries()) {
    names += (names.empty() ? "" : ", ") + std::string(entry.variant.name);
    if (entry.variant.name != variant) continue;
    if (!entry.make)
      return Error{ErrorCode::unavailable, std::string(entry.variant.engine) +
                                               " was not found when pcphys was built; install " +
                                               std::string(entry.variant.package) + " and configure again."};
    const auto description = Description::of(world, bodies);
    if (!description) return description.error();
    return entry.make(*description, options);
  }
  return Error{ErrorCode::unknown_name,
               "There is no peer '" + std::string(variant) + "'; choose one of " + names + "."};
}

}  // namespace pcphys::peers
