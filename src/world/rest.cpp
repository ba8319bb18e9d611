// Who sleeps, may sleep and is woken by the host.
#include "world/state.h"
#include "world/validate.h"

namespace pcphys {

Result<bool> World::is_asleep(BodyId body) const {
  if (!valid(body)) return stale("body");
  const std::uint32_t row = state_->body_ids.row(body.index);
  return state_->asleep(row) && state_->tables.get(Buffer::rest, row, rest_stirred) == 0;
}

Status World::wake(BodyId body) {
  if (!valid(body)) return stale("body");
  state_->stir(state_->body_ids.row(body.index));
  return {};
}

Result<bool> World::can_sleep(BodyId body) const {
  if (!valid(body)) return stale("body");
  return state_->tables.get(Buffer::rest, state_->body_ids.row(body.index), rest_can_sleep) > 0;
}

Status World::set_can_sleep(BodyId body, bool can_sleep) {
  if (!valid(body)) return stale("body");
  const std::uint32_t row = state_->body_ids.row(body.index);
  state_->tables.set(Buffer::rest, row, rest_can_sleep, can_sleep);
  state_->stir_moving(row);
  return {};
}

}  // namespace pcphys
