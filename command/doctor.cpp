// pcphys doctor: what this machine offers, and what is missing with the package that brings it.
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "commands.h"
#include "output.h"
#include "pcphys/device.h"
#include "pcphys/step.h"
#include "pcphys/version.h"
#include "peers/peer.h"
#include "step/backend.h"

namespace pcphys::command {
namespace {

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

Json lanes_of(Precision precision) {
  Json lanes = Json::array();
  for (std::uint32_t width : {1u, 4u, 8u})
    if (make_cpu_backend(precision, width)) lanes.push_back(width);
  return lanes;
}

Json arithmetic_json(const GlArithmetic& a) {
  return {{"supported", a.supported},
          {"parity", a.parity()},
          {"division", name(a.division)},
          {"square_root", name(a.square_root)},
          {"two_roundings", a.two_roundings},
          {"fma_fused", a.fma_fused},
          {"subnormals_kept", a.subnormals_kept}};
}

Json device_json(const GlReport& r) {
  return {{"device", r.device},
          {"usable", r.usable},
          {"problem", r.problem},
          {"package", r.package},
          {"renderer", r.renderer},
          {"vendor", r.vendor},
          {"version", r.version},
          {"software", r.software},
          {"limits",
           {{"storage_blocks", r.limits.storage_blocks},
            {"storage_block_bytes", r.limits.storage_block_bytes},
            {"shared_memory_bytes", r.limits.shared_memory_bytes},
            {"work_group_invocations", r.limits.work_group_invocations},
            {"work_group_count", r.limits.work_group_count}}},
          {"float", arithmetic_json(r.f32)},
          {"double", arithmetic_json(r.f64)}};
}

/// Every device that EGL lists; when there is none, what the library would find or why it finds nothing.
std::vector<GlReport> gl_reports() {
  std::vector<GlReport> reports;
  for (const GlDevice& device : gl_devices()) reports.push_back(probe_gl(device.index));
  if (reports.empty()) reports.push_back(probe_gl(-1));
  return reports;
}

bool has_fcl() {
  StepSettings settings;
  settings.narrow = NarrowPhase::fcl;
  return bool(Stepper().configure(settings));
}

/// Engines by name, one for all of its variants.
Json peers_json(Json& missing) {
  Json found = Json::object();
  for (const peers::Variant& variant : peers::variants()) {
    const std::string engine(variant.engine);
    if (found.contains(engine)) continue;
    found[engine] = variant.found ? Json(variant.version) : Json(nullptr);
    if (!variant.found)
      missing.push_back(
          {{"what", engine + " when pcphys was built, for `pcphys compare`"}, {"package", variant.package}});
  }
  return found;
}

void print_arithmetic(const char* label, const GlArithmetic& a) {
  if (!a.supported) {
    std::printf("    %-7s not supported\n", label);
    return;
  }
  std::printf("    %-7s %s; division %s, square root %s; fma %s; subnormals %s\n", label,
              a.parity() ? "equal to the CPU bit for bit" : "NOT equal to the CPU", name(a.division),
              name(a.square_root), a.fma_fused ? "fused" : "not fused", a.subnormals_kept ? "kept" : "flushed");
}

void print_device(const GlReport& r) {
  if (!r.usable) {
    std::printf("  device %d: not usable. %s\n", r.device, r.problem.c_str());
    return;
  }
  std::printf("  device %d: %s (%s)%s\n", r.device, r.renderer.c_str(), r.version.c_str(),
              r.software ? ", software" : "");
  std::printf("    limits  %u storage blocks of %.0f MiB, %u KiB shared memory, work groups of %u\n",
              r.limits.storage_blocks, double(r.limits.storage_block_bytes) / (1 << 20),
              r.limits.shared_memory_bytes >> 10, r.limits.work_group_invocations);
  // llvmpipe hands each dispatch to threads of its own and waits: longer than a small one takes (docs/gpu.md).
  if (r.renderer.find("llvmpipe") != std::string::npos && std::getenv("LP_NUM_THREADS") == nullptr)
    std::puts("    hint    small scenes run two to five times as fast with LP_NUM_THREADS=0 in the environment");
  print_arithmetic("float", r.f32);
  print_arithmetic("double", r.f64);
}

}  // namespace

int doctor(const OutputOptions& options) {
  auto files = ResultFiles::open(options.json, options.csv);
  if (!files) return fail(files.error());
  const std::vector<GlReport> reports = gl_reports();
  Json devices = Json::array(), missing = Json::array();
  std::string table = "device,usable,renderer,version,float_parity,double_parity\n";
  bool usable = false;
  for (const GlReport& r : reports) {
    devices.push_back(device_json(r));
    usable = usable || r.usable;
    table += std::to_string(r.device) + "," + (r.usable ? "1" : "0") + ",\"" + r.renderer + "\",\"" + r.version +
             "\"," + (r.f32.parity() ? "1" : "0") + "," + (r.f64.parity() ? "1" : "0") + "\n";
  }
  if (!usable && !reports.front().package.empty())
    missing.push_back({{"what", "OpenGL 4.3 through EGL, for --backend gl"}, {"package", reports.front().package}});
  if (!has_fcl())
    missing.push_back({{"what", "FCL when pcphys was built, for --narrow fcl"}, {"package", "libfcl-dev"}});
  const Json peers = peers_json(missing);
  const Json report{{"version", PCPHYS_VERSION},
                    {"processor", processor()},
                    {"lanes_float", lanes_of(Precision::f32)},
                    {"lanes_double", lanes_of(Precision::f64)},
                    {"gl", devices},
                    {"fcl", has_fcl()},
                    {"peers", peers},
                    {"missing", missing}};

  if (auto status = files->write(report, table); !status) return fail(status.error());
  if (files->printed()) {
    std::printf("pcphys %s\nCPU: %s\n  lanes: float %s, double %s\nOpenGL through EGL:\n", PCPHYS_VERSION,
                processor().c_str(), report["lanes_float"].dump().c_str(), report["lanes_double"].dump().c_str());
    for (const GlReport& r : reports) print_device(r);
    std::printf("FCL narrow phase: %s\n", has_fcl() ? "there" : "not there");
    for (const auto& [engine, version] : peers.items())
      std::printf("peer %s: %s\n", engine.c_str(),
                  version.is_null() ? "not there" : version.get<std::string>().c_str());
    for (const Json& item : missing)
      std::printf("missing: %s; install %s\n", item["what"].get<std::string>().c_str(),
                  item["package"].get<std::string>().c_str());
    if (missing.empty()) std::printf("Nothing is missing.\n");
  }
  return exit_ok;
}

}  // namespace pcphys::command
