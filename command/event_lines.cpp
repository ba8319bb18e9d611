#include "event_lines.h"

namespace pcphys::command {
namespace {

Json numbers(Vec3 v) { return {v.x, v.y, v.z}; }
Json pair(const TouchingPair& p) { return {{"bodies", {p.a.index, p.b.index}}, {"shapes", {p.shape_a, p.shape_b}}}; }
Json meeting(const ContactBegun& c) {
  Json json = pair(c);
  json["normal"] = numbers(c.normal);
  json["point"] = numbers(c.point);
  return json;
}

}  // namespace

void EventLines::line(std::uint64_t step, const char* event, Json rest) {
  Json json{{"step", step}, {"event", event}};
  json.update(rest);
  text_ += json.dump() + "\n";
}

void EventLines::add(std::uint64_t step, const StepEvents& events) {
  for (const ContactBegun& c : events.begun) line(step, "begun", meeting(c));
  for (const ContactEnded& c : events.ended) line(step, "ended", pair(c));
  for (const ContactHit& c : events.hits) {
    Json json = meeting(c);
    json["speed"] = c.speed;
    json["impulse"] = c.impulse;
    line(step, "hit", json);
  }
  const auto list = [&](const char* event, std::span<const BodyId> of) {
    Json bodies = Json::array();
    for (const BodyId body : of) bodies.push_back(body.index);
    if (!of.empty()) line(step, event, {{"bodies", bodies}});
  };
  list("moved", events.moved);
  list("slept", events.slept);
  list("woken", events.woken);
}

}  // namespace pcphys::command
