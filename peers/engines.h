// One function an engine, in the file of its name; only those exist that were found when pcphys was configured.
#pragma once
#include <memory>

#include "description.h"
#include "peer.h"

namespace pcphys::peers {

Result<std::unique_ptr<Peer>> make_bullet(const Description& description, const Options& options);
std::string bullet_version();

enum class OdeStep { quick, dantzig };
Result<std::unique_ptr<Peer>> make_ode(const Description& description, const Options& options, OdeStep step);
std::string ode_version();

enum class MujocoIntegrator { euler, rk4 };
Result<std::unique_ptr<Peer>> make_mujoco(const Description& description, const Options& options,
                                          MujocoIntegrator integrator);
std::string mujoco_version();

}  // namespace pcphys::peers
