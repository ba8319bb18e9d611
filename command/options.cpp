#include "options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>
#include <limits>
#include <sstream>
#include <thread>

#include "peers/peer.h"

namespace pcphys::command {
namespace {

Error bad(const std::string& sentence) { return {ErrorCode::bad_argument, sentence}; }

Result<Place> place_of(const char* option, const std::string& text) {
  if (text == "cpu") return Place::cpu;
  if (text == "gl") return Place::gl;
  return bad(std::string("--") + option + " is '" + text + "'; give cpu or gl.");
}

/// Nothing where the text is no decimal number from end to end, or one that `Number` cannot hold.
template <class Number> std::optional<Number> number(std::string_view text) {
  Number value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// What is wrong with the value of an option of this type of CLI11's; "" where nothing is.
std::string check_value(const std::string& type, std::string& text) {
  if (text.empty()) return "The value is empty; give one, or leave the option out.";
  if (type == "INT") {
    const auto value = number<long long>(text);
    if (!value) return "'" + text + "' is not a whole number that 64 bits hold.";
    text = std::to_string(*value);  // CLI11 would read 010 as eight
  }
  if (type == "FLOAT" && !number<double>(text)) return "'" + text + "' is not a number that double precision holds.";
  return "";
}

}  // namespace

void check_values(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    const bool flag = option->get_items_expected_min() == 0;
    if (flag) continue;
    const std::string type = option->get_type_name();
    option->transform(CLI::Validator([type](std::string& text) { return check_value(type, text); }, ""));
  }
}

Result<double> time_step(const std::string& text) {
  const std::size_t slash = text.find('/');
  const auto above = number<double>(std::string_view(text).substr(0, slash));
  const auto below = slash == std::string::npos ? std::optional<double>(1.0)
                                                : number<double>(std::string_view(text).substr(slash + 1));
  const double dt = above && below ? *above / *below : std::numeric_limits<double>::quiet_NaN();
  if (std::isfinite(dt) && dt > 0) return dt;
  return bad("--dt is '" + text + "'; give a time step above 0 in seconds, such as 0.01 or 1/60.");
}

Status check_range(const char* option, long long value, long long low, long long high) {
  if (value >= low && value <= high) return {};
  return bad(std::string("--") + option + " is " + std::to_string(value) + "; give a whole number from " +
             std::to_string(low) + " to " + std::to_string(high) + ".");
}

Status check_budget(double seconds) {
  constexpr double most = 1e9;  // 30 years, so that seconds can be counted
  if (seconds > 0 && seconds <= most) return {};
  std::ostringstream value;
  value << seconds;
  return bad("--budget is " + value.str() + "; give seconds above 0, and at most 1e9.");
}

Result<std::vector<std::string>> peer_names(const std::string& list) {
  std::vector<std::string> all, names;
  std::string known;
  for (const peers::Variant& variant : peers::variants()) {
    all.emplace_back(variant.name);
    known += (known.empty() ? "" : ", ") + all.back();
  }
  if (list == "all") return all;
  if (list == "none") return names;
  std::istringstream text(list);
  for (std::string name; std::getline(text, name, ',');) {
    if (std::find(all.begin(), all.end(), name) == all.end())
      return Error{ErrorCode::unknown_name,
                   "There is no peer '" + name + "'; give all, none, or some of " + known + " with commas between."};
    names.push_back(name);
  }
  return names;
}

Result<std::vector<std::string>> found_peers(const std::string& list) {
  auto names = peer_names(list);
  if (!names) return names.error();
  for (const peers::Variant& variant : peers::variants()) {
    const auto name = std::find(names->begin(), names->end(), variant.name);
    if (variant.found || name == names->end()) continue;
    const std::string sentence = std::string(variant.engine) + " was not found when pcphys was built; install " +
                                 std::string(variant.package) + " and configure again.";
    if (list != "all") return Error{ErrorCode::unavailable, sentence};
    std::cerr << "pcphys: without " << variant.name << ": " << sentence << "\n";
    names->erase(name);
  }
  return names;
}

Status check_choice(const char* option, const std::string& value, std::initializer_list<const char*> choices) {
  std::string list;
  for (const char* choice : choices) {
    if (value == choice) return {};
    list += (list.empty() ? "" : ", ") + std::string(choice);
  }
  return bad(std::string("--") + option + " is '" + value + "'; give one of " + list + ".");
}

namespace {

Status check_numbers(const RunOptions& options) {
  constexpr long long many = 1'000'000'000;
  if (options.count)
    if (auto status = check_range("count", *options.count, 0, many); !status) return status;
  if (options.seed)
    if (auto status = check_range("seed", *options.seed, 0, std::numeric_limits<long long>::max()); !status)
      return status;
  if (options.steps)
    if (auto status = check_range("steps", *options.steps, 1, many); !status) return status;
  if (auto status = check_range("substeps", options.substeps, 1, 1000); !status) return status;
  if (options.order != 2 && options.order != 4)
    return bad("--order is " + std::to_string(options.order) + "; give 2, or 4 for joint trees.");
  if (options.order == 4 && options.integrator == "seed") return bad("--order 4 is not for --integrator seed.");
  if (auto status = check_range("threads", options.threads, 0, 256); !status) return status;
  if (auto status = check_range("device", options.device, -1, 1000); !status) return status;
  if (!(options.ratio > 0 && std::isfinite(options.ratio)))
    return bad("--ratio is " + std::to_string(options.ratio) + "; give a finite mass ratio above 0.");
  for (const auto& [name, value] :
       {std::pair("friction", options.friction), std::pair("restitution", options.restitution),
        std::pair("drag", options.drag), std::pair("joint-damping", options.joint_damping)})
    if (value && !(*value >= 0 && std::isfinite(*value)))
      return bad("--" + std::string(name) + " is " + std::to_string(*value) + "; give a finite number, 0 or more.");
  return {};
}

Status set_places(const RunOptions& options, StepSettings& settings) {
  const auto backend = place_of("backend", options.backend);
  if (!backend) return backend.error();
  settings.set_all(*backend);
  struct Choice {
    const char* option;
    const std::string& text;
    Place& place;
  };
  for (const Choice& choice :
       {Choice{"integrate", options.integrate, settings.integrate}, Choice{"joints", options.joints, settings.joints},
        Choice{"impulses", options.impulses, settings.impulses}}) {
    if (choice.text.empty()) continue;
    const auto place = place_of(choice.option, choice.text);
    if (!place) return place.error();
    choice.place = *place;
  }
  return {};
}

Status set_precision(const RunOptions& options, Setup& setup) {
  if (auto status = check_choice("precision", options.precision, {"float", "double"}); !status) return status;
  if (auto status = check_choice("lanes", options.lanes, {"auto", "1", "4", "8"}); !status) return status;
  setup.precision = options.precision == "double" ? Precision::f64 : Precision::f32;
  setup.settings.lanes = options.lanes == "auto" ? 0 : std::uint32_t(options.lanes[0] - '0');
  if (setup.precision == Precision::f64 && setup.settings.lanes == 8)
    return bad("--lanes 8 is for --precision float; double has 1 and 4 lanes.");
  return {};
}

}  // namespace

void add_scene_argument(CLI::App& app, RunOptions& options) {
  app.add_option("SCENE", options.scene, "name of the scene; `pcphys scenes` lists them")->required();
  add_scene_options(app, options);
}

void add_scene_options(CLI::App& app, RunOptions& options) {
  app.add_option("--count", options.count, "how many of the scene's objects");
  app.add_option("--seed", options.seed, "of the scene's random draws (default: the scene's own)");
  app.add_option("--ratio", options.ratio, "mass ratio of chain, chainswing and heavy")->capture_default_str();
  app.add_option("--friction", options.friction, "of all bodies, static and kinetic (default: the scene's own)");
  app.add_option("--restitution", options.restitution, "of all bodies (default: the scene's own)");
  app.add_option("--drag", options.drag,
                 "of all bodies that move, linear and angular [1/s] (default: the scene's own)");
  app.add_option("--joint-damping", options.joint_damping, "of all joints [N m s/rad] (default: the scene's own)");
}

void add_lanes_and_threads(CLI::App& app, std::string& lanes, long long& threads) {
  app.add_option("--lanes", lanes, "SIMD lanes of the CPU: auto, 1, 4 or 8")->capture_default_str();
  app.add_option("--threads", threads, "of the CPU; 0: as many as the processor runs at a time")->capture_default_str();
}

void add_device(CLI::App& app, long long& device) {
  app.add_option("--device", device, "EGL device, as `pcphys doctor` numbers them; -1: the first that works")
      ->capture_default_str();
}

void add_run_options(CLI::App& app, RunOptions& options) {
  app.add_option("--backend", options.backend, "cpu or gl, for all three stages")->capture_default_str();
  app.add_option("--integrate", options.integrate, "cpu or gl, for this stage");
  app.add_option("--joints", options.joints, "cpu or gl, for this stage");
  app.add_option("--impulses", options.impulses, "cpu or gl, for this stage");
  app.add_option("--narrow", options.narrow, "narrow phase: native or fcl")->capture_default_str();
  app.add_option("--steps", options.steps, "how many steps (default: 600)");
  app.add_option("--dt", options.dt, "time step [s], also as a fraction")->capture_default_str();
  app.add_option("--substeps", options.substeps, "sub-steps a step")->capture_default_str();
  app.add_flag("--resident", options.resident,
               "on gl, where nothing meets or holds a body: poses come to the host when they are read");
  app.add_option("--order", options.order,
                 "2, or 4: joint trees on which nothing but forces and pins acts move in fourth order")
      ->capture_default_str();
  app.add_option("--precision", options.precision, "float or double")->capture_default_str();
  add_lanes_and_threads(app, options.lanes, options.threads);
  app.add_option("--warmup", options.warmup, "steps at the start whose times are not counted")->capture_default_str();
  app.add_option("--sleep", options.sleep, "on: islands at rest are no longer stepped")->capture_default_str();
  app.add_option("--islands", options.islands, "cpu or gl: where the islands that may sleep are found")
      ->capture_default_str();
  app.add_option("--integrator", options.integrator, "verlet, or seed: the scheme of the original document")
      ->capture_default_str();
  add_device(app, options.device);
  app.add_option("--timings", options.timings,
                 "on: clock every stage, which makes a GPU wait after each; off: whole steps only")
      ->capture_default_str();
}

void add_output_options(CLI::App& app, RunOptions& options) {
  app.add_option("--json", options.json, "write the result to this file; - is standard output");
  app.add_option("--csv", options.csv, "write a table of rows to this file");
}

Result<Setup> resolve(const RunOptions& options, std::uint64_t default_steps) {
  Setup setup;
  for (const Status& status : {check_numbers(options), check_choice("sleep", options.sleep, {"on", "off"}),
                               check_choice("islands", options.islands, {"cpu", "gl"}),
                               check_choice("narrow", options.narrow, {"native", "fcl"}),
                               check_choice("integrator", options.integrator, {"verlet", "seed"}),
                               check_choice("timings", options.timings, {"on", "off"})})
    if (!status) return status.error();
  if (auto status = set_places(options, setup.settings); !status) return status.error();
  if (auto status = set_precision(options, setup); !status) return status.error();
  const auto dt = time_step(options.dt);
  if (!dt) return dt.error();

  setup.scene = options.scene;
  if (options.count) setup.scene_options.count = int(*options.count);
  if (options.seed) setup.scene_options.seed = std::uint64_t(*options.seed);
  setup.scene_options.ratio = options.ratio;
  setup.scene_options.friction = options.friction;
  setup.scene_options.restitution = options.restitution;
  setup.scene_options.drag = options.drag;
  setup.scene_options.joint_damping = options.joint_damping;
  setup.settings.narrow = options.narrow == "fcl" ? NarrowPhase::fcl : NarrowPhase::native;
  setup.settings.integrator = options.integrator == "seed" ? Integrator::seed : Integrator::verlet;
  setup.settings.substeps = std::uint32_t(options.substeps);
  setup.settings.order = std::uint32_t(options.order);
  setup.settings.resident = options.resident;
  setup.settings.threads =
      options.threads > 0 ? std::uint32_t(options.threads) : std::clamp(std::thread::hardware_concurrency(), 1u, 256u);
  setup.settings.device = int(options.device);
  setup.settings.contact_events = setup.settings.hit_events = setup.settings.body_events = !options.events.empty();
  setup.settings.sleep = options.sleep == "on";
  setup.settings.islands = options.islands == "gl" ? Place::gl : Place::cpu;
  setup.settings.timings = options.timings == "on";
  setup.dt = *dt;
  setup.steps = options.steps ? std::uint64_t(*options.steps) : default_steps;
  if (auto status = check_range("warmup", options.warmup, 0, std::max(0ll, (long long)setup.steps - 1)); !status)
    return status.error();
  setup.warmup = std::uint64_t(options.warmup);
  return setup;
}

}  // namespace pcphys::command
