// Who sleeps, may sleep and is woken by the host.
#include "world/state.h"
#include "world/validate.h"

namespace pcphys {

Result<bool> World::is_asleep(BodyId body) const try {
  if (!valid(body)) return stale("body");
  const WorldState& s = settled();
  const std::uint32_t row = s.body_ids.row(body.index);
  return s.asleep(row) && s.tables.get(Buffer::rest, row, rest_stirred) == 0;
} catch (...) {
  return caught();
}

Status World::wake(BodyId body) try {
  if (Status ok = changeable(body); !ok) return ok;
  state().stir(state().body_ids.row(body.index));
  return {};
} catch (...) {
  return caught();
}

Result<bool> World::can_sleep(BodyId body) const try {
  if (!valid(body)) return stale("body");
  return state().tables.get(Buffer::rest, state().body_ids.row(body.index), rest_can_sleep) > 0;
} catch (...) {
  return caught();
}

Status World::set_can_sleep(BodyId body, bool can_sleep) try {
  if (Status ok = changeable(body); !ok) return ok;
  const std::uint32_t row = state().body_ids.row(body.index);
  state().tables.set(Buffer::rest, row, rest_can_sleep, can_sleep);
  state().stir_moving(row);
  return {};
} catch (...) {
  return caught();
}

}  // namespace pcphys
