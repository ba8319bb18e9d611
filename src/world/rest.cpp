// Who sleeps, may sleep and is woken by the host.
#include "world/state.h"
#include "world/validate.h"

namespace pcphys {

Result<bool> World::is_asleep(BodyId body) const {
  if (!valid(body)) return stale("body");
  const WorldState& s = settled();
  const std::uint32_t row = s.body_ids.row(body.index);
  return s.asleep(row) && s.tables.get(Buffer::rest, row, rest_stirred) == 0;
}

Status World::wake(BodyId body) {
  if (Status ok = changeable(body); !ok) return ok;
  state().stir(state().body_ids.row(body.index));
  return {};
}

Result<bool> World::can_sleep(BodyId body) const {
  if (!valid(body)) return stale("body");
  return state().tables.get(Buffer::rest, state().body_ids.row(body.index), rest_can_sleep) > 0;
}

Status World::set_can_sleep(BodyId body, bool can_sleep) {
  if (Status ok = changeable(body); !ok) return ok;
  const std::uint32_t row = state().body_ids.row(body.index);
  state().tables.set(Buffer::rest, row, rest_can_sleep, can_sleep);
  state().stir_moving(row);
  return {};
}

}  // namespace pcphys
