#include "step/called_forces.h"

#include <exception>
#include <string>
#include <utility>

#include "world/validate.h"

namespace pcphys {

namespace {

Status check(const Wrench& answer, std::uint32_t body) {
  for (const auto& [value, what] : {std::pair(answer.force, "force"), std::pair(answer.torque, "torque")})
    if (!check_finite(value, what))
      return check_finite(value, (std::string(what) + " of a callback of body " + std::to_string(body)).c_str());
  return {};
}

}  // namespace

namespace {
Error threw(std::uint32_t body, const std::string& what) {
  return {ErrorCode::bad_argument, "A force callback of body " + std::to_string(body) + " threw " + what +
                                       "; it must answer with a force. The world is as before the step."};
}

Result<Wrench> call(const ForceRecord& f, const World& world, BodyId body) {
  try {
    return f.callback(world, body);
  } catch (const std::exception& e) {
    return threw(f.body, "\"" + std::string(e.what()) + "\"");
  } catch (...) {
    return threw(f.body, "something");
  }
}
}  // namespace

Status CalledForces::ask(const World& world) {
  const WorldState& s = world.state();
  answers_.clear();
  if (s.callbacks == 0) return {};
  for (const ForceRecord& f : s.forces) {
    if (!f.callback) continue;
    const Result<Wrench> answer = call(f, world, s.body_ids.id<BodyId>(f.body));
    if (!answer) return answer.error();
    answers_.push_back(*answer);
    if (Status ok = check(answers_.back(), f.body); !ok) return ok;
  }
  return {};
}

void CalledForces::add(WorldState& s, Runner& runner) const {
  if (answers_.empty()) return;
  runner.keep(s, s.gathered ? s.gathered->force : Buffer::force);
  if (s.gathered) runner.keep(s, s.gathered->torque);
  for (const ForceRecord& f : s.forces)
    if (f.callback) s.sum_forces(s.body_ids.row(f.body));
  std::size_t i = 0;
  for (const ForceRecord& f : s.forces) {
    if (!f.callback) continue;
    const std::uint32_t row = s.body_ids.row(f.body);
    const Wrench& w = answers_[i++];
    s.give_forces(row, s.given_force(row) + w.force, s.given_torque(row) + w.torque);
  }
}

}  // namespace pcphys
