#include "report.h"

#include <algorithm>
#include <cinttypes>
#include <cstdarg>
#include <cstdio>
#include <numbers>

#include "world/schema.h"

namespace pcphys::command {
namespace {

constexpr double degrees = 180 / std::numbers::pi;
constexpr double mm = 1000;

__attribute__((format(printf, 1, 2))) std::string format(const char* pattern, ...) {
  char buffer[512];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(buffer, sizeof buffer, pattern, arguments);
  va_end(arguments);
  return buffer;
}

Json vector_json(Vec3 v) { return Json::array({v.x, v.y, v.z}); }

Json stages_json(const Times& times) {
  Json result = Json::object();
  for (std::size_t i = 0; i < timer_count; ++i) result[name(Timer(i))] = median(times.stages[i]);
  return result;
}

const char* shape_name(ShapeKind kind) {
  switch (kind) {
    case ShapeKind::sphere: return "sphere";
    case ShapeKind::capsule: return "capsule";
    case ShapeKind::box: return "box";
    case ShapeKind::cylinder: return "cylinder";
    case ShapeKind::hull: return "hull";
    case ShapeKind::plane: break;
  }
  return "plane";
}

}  // namespace

Json memory_json(const Simulation& simulation) {
  Json buffers = Json::array(), absent = Json::array();
  std::size_t sum = 0;
  const std::vector<BufferUse> uses = simulation.stepper.memory(simulation.world);
  for (const BufferUse& use : uses) {
    Json row{{"buffer", use.name}, {"place", name(use.place)}, {"bytes", use.bytes}};
    if (!use.table.empty()) row["table"] = use.table;
    buffers.push_back(row);
    sum += use.bytes;
  }
  for (std::size_t b = 0; b < buffer_count; ++b) {
    const std::string_view name = schema(Buffer(b)).name;
    if (std::ranges::find(uses, name, &BufferUse::name) == uses.end()) absent.push_back(name);
  }
  return {{"bytes", sum}, {"buffers", buffers}, {"not_allocated", absent}};
}

namespace {

Json bodies_json(const Simulation& simulation) {
  Json rows = Json::array();
  for (const scenes::SceneBody& body : simulation.scene.bodies) {
    const auto pose = simulation.world.pose(body.id);
    const auto velocity = simulation.world.velocity(body.id), spin = simulation.world.angular_velocity(body.id);
    if (!pose || !velocity || !spin) continue;
    const Quat q = pose->orientation;
    rows.push_back({{"id", body.id.index},
                    {"shape", shape_name(body.shape.kind)},
                    {"size", vector_json(body.shape.size)},
                    {"fixed", body.kind == BodyKind::fixed},
                    {"group", body.group},
                    {"bone", body.bone},
                    {"position", vector_json(pose->position)},
                    {"orientation", {q.x, q.y, q.z, q.w}},
                    {"velocity", vector_json(*velocity)},
                    {"angular_velocity", vector_json(*spin)}});
  }
  return rows;
}

}  // namespace

std::string hash_text(std::uint64_t hash) { return format("0x%016" PRIx64, hash); }

std::string backend_name(const StepSettings& s) {
  return s.integrate == s.joints && s.joints == s.impulses ? name(s.integrate) : "mixed";
}

Json stage_backends(const StepSettings& s) {
  return {{"integrate", name(s.integrate)}, {"joints", name(s.joints)}, {"impulses", name(s.impulses)}};
}

std::string device_name(const Simulation& simulation) {
  std::string text;
  for (Place place : {Place::cpu, Place::gl}) {
    const std::string device = simulation.stepper.device(place);
    if (!device.empty()) text += (text.empty() ? "" : " + ") + device;
  }
  return text;
}

Json to_json(const Simulation& simulation, const Outcome& outcome, bool poses) {
  const Setup& setup = simulation.setup;
  const scenes::Metrics& end = outcome.end;
  const Incidents& all = outcome.incidents;
  Json left_out = Json::array();
  for (const LeftOut& item : simulation.stepper.plan().left_out)
    left_out.push_back({{"what", item.what}, {"why", item.why}});
  Json json{
      {"scene", simulation.scene.name},
      {"count", simulation.scene.count},
      {"ratio", simulation.scene.ratio},
      {"bodies", simulation.world.body_count()},
      {"joints", simulation.world.joint_count()},
      {"backend", backend_name(setup.settings)},
      {"stage_backends", stage_backends(setup.settings)},
      {"device", device_name(simulation)},
      {"devices", {{"cpu", simulation.stepper.device(Place::cpu)}, {"gl", simulation.stepper.device(Place::gl)}}},
      {"precision", setup.precision == Precision::f64 ? "double" : "float"},
      {"integrator", name(setup.settings.integrator)},
      {"order", setup.settings.order},
      {"narrow", setup.settings.narrow == NarrowPhase::fcl ? "fcl" : "native"},
      {"steps", setup.steps},
      {"warmup", setup.warmup},
      {"dt", setup.dt},
      {"substeps", setup.settings.substeps},
      {"substeps_last", outcome.last.substeps},
      {"refined_last", outcome.last.refined},
      {"most_substeps", all.most_substeps},
      {"repeats", all.repeats},
      {"given_up", all.given_up},
      {"limited", all.limited},
      {"frozen", all.frozen},
      {"fourth_order_last", outcome.last.fourth_order},
      {"sleep", setup.settings.sleep},
      {"islands", name(setup.settings.islands)},
      {"asleep_last", outcome.last.asleep},
      {"islands_asleep_last", outcome.last.islands_asleep},
      {"lanes", simulation.lanes},
      {"threads", setup.settings.threads},
      {"median_ms", median(outcome.times.step)},
      {"p99_ms", quantile(outcome.times.step, 0.99)},
      {"max_fps", outcome.times.max_fps()},
      {"min_fps", outcome.times.min_fps()},
      {"stages", setup.settings.timings ? stages_json(outcome.times) : Json::object()},
      {"transfers_bytes", outcome.last.transfer_bytes},
      {"uploads_bytes", outcome.last.upload_bytes},
      {"downloads_bytes", outcome.last.transfer_bytes - outcome.last.upload_bytes},
      {"left_out", left_out},
      {"memory", memory_json(simulation)},
      {"contacts", outcome.last.contacts},
      {"contact_points", outcome.last.points},
      {"pairs", outcome.last.pairs},
      {"colours", outcome.last.colours},
      {"joints_as_rows", outcome.last.joints_as_rows},
      {"tree_contacts_as_rows", outcome.last.tree_contacts_as_rows},
      {"max_penetration", end.penetration.max},
      {"mean_penetration", end.penetration.mean()},
      {"peak_penetration", outcome.peaks.penetration},
      {"max_joint_separation", end.separation.max},
      {"mean_joint_separation", end.separation.mean},
      {"peak_joint_separation", outcome.peaks.joint_separation},
      {"limit_excess_degrees", end.limit_excess.any * degrees},
      {"peak_limit_excess_degrees", outcome.peaks.limit_excess * degrees},
      {"energy_start", outcome.start.energy()},
      {"energy_end", end.energy()},
      {"kinetic_energy_end", end.kinetic},
      {"energy_max", outcome.peaks.energy},
      {"potential_range", outcome.peaks.potential_high - outcome.peaks.potential_low},
      {"momentum", vector_json(end.momentum)},
      {"angular_momentum", vector_json(end.angular_momentum)},
      {"drift", end.drift.sideways},
      {"fallen", end.drift.fallen},
      {"escaped", end.escapes.through},
      {"escaped_over_rim", end.escapes.over_the_rim},
      {"nonfinite", end.nonfinite},
      {"overflow", Json::array()},
      {"memory_bytes", simulation.world.memory_bytes()},
      {"hash", hash_text(outcome.hash)},
  };
  if (poses) json["bodies_final"] = bodies_json(simulation);
  return json;
}

std::string to_text(const Simulation& simulation, const Outcome& outcome) {
  const Setup& setup = simulation.setup;
  const StepSettings& s = setup.settings;
  const scenes::Metrics& end = outcome.end;
  std::string text = format("%s %d: %zu bodies, %zu joints\n", simulation.scene.name.c_str(), simulation.scene.count,
                            simulation.world.body_count(), simulation.world.joint_count());
  text += format("%llu steps of %g s, %u sub-steps, %s; integrate %s, joints %s, impulses %s\n",
                 (unsigned long long)setup.steps, setup.dt, s.substeps,
                 setup.precision == Precision::f64 ? "double" : "float", name(s.integrate), name(s.joints),
                 name(s.impulses));
  text += "device            " + device_name(simulation) + "\n";
  text += format("time a step       median %.4f ms, 99 %% within %.4f ms\n", median(outcome.times.step),
                 quantile(outcome.times.step, 0.99));
  text +=
      format("frames a second   %.0f to %.0f (mean of ten frames)\n", outcome.times.min_fps(), outcome.times.max_fps());
  if (s.timings) {
    text += "stages [ms]      ";
    for (std::size_t i = 0; i < timer_count; ++i)
      text += format(" %s %.4f", name(Timer(i)), median(outcome.times.stages[i]));
    text += "\n";
  }
  text += format("transfers         %llu bytes a step\n", (unsigned long long)outcome.last.transfer_bytes);
  for (const LeftOut& item : simulation.stepper.plan().left_out)
    text += "left out          " + item.what + ": " + item.why + "\n";
  text += format("contacts          %u with %u points\n", outcome.last.contacts, outcome.last.points);
  if (s.sleep)
    text += format("asleep            %u bodies in %u islands\n", outcome.last.asleep, outcome.last.islands_asleep);
  text += format("overlap           max %.3f mm, mean %.3f mm, peak %.3f mm\n", mm * end.penetration.max,
                 mm * end.penetration.mean(), mm * outcome.peaks.penetration);
  if (simulation.world.joint_count() > 0)
    text += format("joints            apart max %.4f mm, mean %.4f mm, peak %.4f mm; beyond limits %.2f degrees\n",
                   mm * end.separation.max, mm * end.separation.mean, mm * outcome.peaks.joint_separation,
                   degrees * end.limit_excess.any);
  if (!simulation.scene.supports.empty())
    text += format("boxes             moved sideways %.4f m, fallen %d\n", end.drift.sideways, end.drift.fallen);
  text += format("energy            %.6g J at the start, %.6g J at the end, %.6g J at most\n", outcome.start.energy(),
                 end.energy(), outcome.peaks.energy);
  text += format("lost              %ld escaped, %ld not finite\n", end.escapes.through, end.nonfinite);
  if (end.escapes.over_the_rim)
    text += format("over the rim      %ld thrown out of the open box\n", end.escapes.over_the_rim);
  return text + "hash              " + hash_text(outcome.hash) + "\n";
}

StepRows::StepRows(const Simulation& simulation) : simulation_(simulation), text_("step,time,ms") {
  for (std::size_t i = 0; i < timer_count; ++i) text_ += std::string(",") + name(Timer(i)) + "_ms";
  text_ += ",pairs,contacts,points,transfer_bytes,kinetic,potential,momentum_x,momentum_y,momentum_z\n";
}

void StepRows::add(std::uint64_t step, double ms, const StepReport& report) {
  const World& world = simulation_.world;
  const Vec3 p = world.momentum();
  text_ += format("%llu,%.9g,%.6g", (unsigned long long)step, double(step) * simulation_.setup.dt, ms);
  for (double stage : report.ms) text_ += format(",%.6g", stage);
  text_ += format(",%u,%u,%u,%llu,%.9g,%.9g,%.9g,%.9g,%.9g\n", report.pairs, report.contacts, report.points,
                  (unsigned long long)report.transfer_bytes, world.kinetic_energy(), world.potential_energy(), p.x, p.y,
                  p.z);
}

std::string unsound(const Outcome& outcome) {
  std::string text;
  if (outcome.end.escapes.through) text += std::to_string(outcome.end.escapes.through) + " bodies escaped";
  if (outcome.end.nonfinite)
    text += (text.empty() ? "" : ", ") + std::to_string(outcome.end.nonfinite) + " bodies are not finite";
  return text;
}

}  // namespace pcphys::command
