// The plan as text, and the names in it.
#include <string>

#include "plan/island_class.h"
#include "plan/own_kernels.h"
#include "plan/plan.h"

namespace pcphys {

const char* name(Integrator integrator) { return integrator == Integrator::seed ? "seed" : "verlet"; }
const char* name(Place place) { return place == Place::cpu ? "cpu" : "gl"; }
std::string_view kernel_name(const PlanEntry& entry) {
  if (entry.kind == PlanEntry::Kind::collide) return "manifolds";
  if (entry.transfers()) return {};
  return entry.own ? std::string_view(entry.own->name) : schema(entry.kernel).name;
}
namespace {
/// A buffer's name; of the host's own that of the property, as the kernel calls it.
std::string_view buffer_name(Buffer buffer, const OwnKernel* user) {
  if (!is_own(buffer)) return schema(buffer).name;
  for (const OwnArgument& a : user->arguments)
    if (a.of_property() && a.buffer == buffer) return a.property;
  return {};
}
}  // namespace
std::string_view buffer_name(const PlanEntry& entry) {
  return entry.transfers() ? buffer_name(entry.buffer, entry.own) : std::string_view();
}
std::string_view stage_name(const PlanEntry& entry) {
  if (entry.kind == PlanEntry::Kind::collide) return "collide";
  return entry.kind == PlanEntry::Kind::kernel ? name(stage(entry)) : std::string_view("transfer");
}
std::string_view phase_name(const PlanEntry& entry) {
  constexpr std::string_view names[phase_count] = {"first", "biased", "sent", "push", "relax", "last"};
  return names[std::size_t(entry.phase)];
}

namespace {
std::vector<std::string_view> accessed(const PlanEntry& entry, bool write) {
  std::vector<std::string_view> names;
  if (entry.transfers()) return names;
  for (const Access& a : accesses(entry))
    if (a.write == write) names.push_back(buffer_name(a.buffer, entry.own));
  return names;
}
void pad(std::string& line, std::size_t column) { line.resize(line.size() < column ? column : line.size() + 1, ' '); }
std::string join(const std::vector<std::string_view>& names) {
  std::string s;
  for (std::string_view n : names) s += (s.empty() ? "" : " ") + std::string(n);
  return s;
}
}  // namespace

std::vector<std::string_view> reads(const PlanEntry& entry) { return accessed(entry, false); }
std::vector<std::string_view> writes(const PlanEntry& entry) { return accessed(entry, true); }

TransferBytes transfer_bytes(const StepPlan& plan) {
  TransferBytes all;
  for (const PlanEntry& e : plan.entries)
    if (e.transfers()) (e.kind == PlanEntry::Kind::upload ? all.up : all.down) += e.bytes;
  return all;
}

std::string to_text(const StepPlan& plan) {
  std::string text = "sub-steps " + std::to_string(plan.substeps) + "\n";
  text += "sub     place stage      what                 phase   reads -> writes (B: waits for earlier writes)\n";
  for (const PlanEntry& e : plan.entries) {
    std::string line = std::to_string(e.substep);
    if (octave_of(e.octave) > 0) line += "/" + std::to_string(plan.substeps << octave_of(e.octave));
    pad(line, 8);
    line += name(e.place);
    pad(line, 14);
    line += stage_name(e);
    pad(line, 25);
    if (!e.transfers()) {
      line += kernel_name(e);
      pad(line, 46);
      line += phase_name(e);
      if (e.again > 0) line += "*";
      pad(line, 54);
      line += join(reads(e)) + " -> " + join(writes(e));
    } else {
      line += (e.kind == PlanEntry::Kind::upload ? "upload " : "download ") + std::string(buffer_name(e));
      if (e.bytes > 0) line += ", " + std::to_string(e.bytes) + " bytes";
    }
    text += line + (e.barrier ? "  B\n" : "\n");
  }
  if (const TransferBytes all = transfer_bytes(plan); all.up + all.down > 0)
    text += "transfers: up to " + std::to_string(all.up) + " bytes to the device, " + std::to_string(all.down) +
            " bytes from it\n";
  for (const LeftOut& l : plan.left_out) text += "left out: " + l.what + ", since " + l.why + "\n";
  return text;
}

}  // namespace pcphys
