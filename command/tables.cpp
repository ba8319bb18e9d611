// pcphys tables: Tables 1 and 2 of the original, with what pcphys measures beside them.
// The original's figures: Python with an OpenGL window, frames per second over the mean of ten frames.
#include <cstdio>
#include <iostream>

#include "commands.h"
#include "output.h"
#include "report.h"
#include "simulation.h"

namespace pcphys::command {
namespace {

struct Row {
  int table;
  const char* scene;
  int count;
  double max_fps, min_fps;  // of the original
};

constexpr Row rows[] = {
    {1, "balls", 0, 59.17, 57.80},    {1, "balls", 10, 59.17, 56.17},   {1, "balls", 20, 60.60, 47.84},
    {1, "balls", 30, 59.52, 35.58},   {1, "balls", 40, 46.94, 24.27},   {1, "balls", 50, 36.36, 19.68},
    {1, "balls", 60, 31.05, 15.12},   {2, "ragdolls", 0, 59.17, 58.47}, {2, "ragdolls", 1, 59.52, 37.17},
    {2, "ragdolls", 2, 55.86, 16.28}, {2, "ragdolls", 3, 40.16, 7.86},  {2, "ragdolls", 4, 30.48, 5.38},
    {2, "ragdolls", 5, 24.69, 4.05},  {2, "ragdolls", 6, 23.86, 2.84},  {2, "ragdolls", 7, 21.23, 2.71},
    {2, "ragdolls", 8, 18.93, 2.75},
};

struct Measured {
  Row row;
  double max_fps, min_fps, median_ms;
  long escaped, nonfinite;
  std::string hash, device;
};

Result<Measured> measure(const Row& row, Setup setup) {
  setup.scene = row.scene;
  setup.scene_options.count = row.count;
  auto simulation = Simulation::make(setup);
  if (!simulation) return simulation.error();
  Times times;
  Progress progress(std::string(row.scene) + " " + std::to_string(row.count), setup.steps);
  for (std::uint64_t step = 1; step <= setup.steps; ++step) {
    const double begin = now();
    const StepReport& report = simulation->stepper.step(simulation->world, setup.dt);
    if (!report) return report.error;
    if (step > setup.warmup) times.add(1000 * (now() - begin), report);
    progress.show(step);
  }
  const scenes::Metrics end = scenes::measure(simulation->scene, simulation->world);
  return Measured{row,
                  times.max_fps(),
                  times.min_fps(),
                  median(times.step),
                  end.escapes.through,
                  end.nonfinite,
                  hash_text(simulation->world.hash()),
                  device_name(*simulation)};
}

Json to_json(const Setup& setup, const std::vector<Measured>& all) {
  Json list = Json::array();
  for (const Measured& m : all)
    list.push_back({{"table", m.row.table},
                    {"scene", m.row.scene},
                    {"count", m.row.count},
                    {"original_max_fps", m.row.max_fps},
                    {"original_min_fps", m.row.min_fps},
                    {"max_fps", m.max_fps},
                    {"min_fps", m.min_fps},
                    {"median_ms", m.median_ms},
                    {"escaped", m.escaped},
                    {"nonfinite", m.nonfinite},
                    {"hash", m.hash}});
  return {{"backend", backend_name(setup.settings)},
          {"stage_backends", stage_backends(setup.settings)},
          {"device", all.empty() ? "" : all.front().device},
          {"steps", setup.steps},
          {"dt", setup.dt},
          {"substeps", setup.settings.substeps},
          {"rows", list}};
}

std::string to_csv(const std::vector<Measured>& all) {
  std::string text = "table,scene,count,original_max_fps,original_min_fps,max_fps,min_fps,median_ms\n";
  for (const Measured& m : all) {
    char line[200];
    std::snprintf(line, sizeof line, "%d,%s,%d,%.2f,%.2f,%.6g,%.6g,%.6g\n", m.row.table, m.row.scene, m.row.count,
                  m.row.max_fps, m.row.min_fps, m.max_fps, m.min_fps, m.median_ms);
    text += line;
  }
  return text;
}

void print_row(const Measured& m) {
  if (m.row.count == 0) {
    std::printf("\nTable %d: %s\n", m.row.table, m.row.table == 1 ? "bouncing balls" : "stacked ragdolls");
    std::printf("%8s | %21s | %23s | %9s | %s\n", "", "original, max min fps", "pcphys, max min fps", "median ms",
                "times faster (max, min)");
  }
  std::printf("%8d | %10.2f %10.2f | %11.0f %11.0f | %9.4f | %.0f, %.0f\n", m.row.count, m.row.max_fps, m.row.min_fps,
              m.max_fps, m.min_fps, m.median_ms, m.max_fps / m.row.max_fps, m.min_fps / m.row.min_fps);
  std::fflush(stdout);
}

}  // namespace

int tables(const RunOptions& options) {
  const auto setup = resolve(options, 600);
  if (!setup) return fail(setup.error());
  auto files = ResultFiles::open(options.json, options.csv);
  if (!files) return fail(files.error());
  const bool print = files->printed();
  std::vector<Measured> all;
  bool sound = true;
  for (const Row& row : rows) {
    auto measured = measure(row, *setup);
    if (!measured) return fail(measured.error());
    if (print && all.empty())
      std::printf(
          "%llu frames a row, mean of ten frames; %s\nThe original drew every frame in a window of 60 Hz; pcphys draws "
          "nothing.\n",
          (unsigned long long)setup->steps, measured->device.c_str());
    if (print) print_row(*measured);
    sound = sound && measured->escaped == 0 && measured->nonfinite == 0;
    all.push_back(std::move(*measured));
  }
  if (auto status = files->write(to_json(*setup, all), to_csv(all)); !status) return fail(status.error());
  if (sound) return exit_ok;
  std::cerr << "pcphys: bodies escaped or are not finite in a run of the tables; see --json.\n";
  return exit_unsound;
}

}  // namespace pcphys::command
