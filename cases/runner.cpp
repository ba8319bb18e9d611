#include "runner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

namespace pcphys::cases {
namespace {

constexpr double seconds_to_repeat = 0.3;  // a trial that takes longer is not repeated

std::vector<const Case*> selected(const Selection& selection) {
  std::vector<const Case*> result;
  for (const Case& c : list()) {
    const bool named = std::find(selection.names.begin(), selection.names.end(), c.name) != selection.names.end();
    if (selection.groups.find(c.group()) != std::string::npos && (named || selection.names.empty()))
      result.push_back(&c);
  }
  return result;
}

std::vector<const Variant*> variants_of(const Selection& selection, const Case& c) {
  std::vector<const Variant*> result;
  for (const Variant& variant : c.variants) {
    if (variant.name == selection.variant) return {&variant};
    if (variant.name.starts_with(selection.variant)) result.push_back(&variant);
  }
  return result;
}

bool same(double a, double b) { return std::fabs(a / b - 1) < 1e-9; }

/// A value of a variant, and whether what it is run with has bounds.
template <class Value> struct Rung {
  Value value;
  bool bounded;
};
template <class Value> std::vector<Rung<Value>> rungs(std::span<const Value> bounded, std::span<const Value> more) {
  std::vector<Rung<Value>> all;
  for (const Value& value : more) all.push_back({value, false});
  for (const Value& value : bounded) all.push_back({value, true});
  return all;
}

std::vector<Rung<double>> step_lengths(const Selection& selection, const Variant& variant, Precision precision) {
  const std::vector<double> steps = variant.direct ? std::vector<double>{direct_step(precision)} : variant.steps;
  std::vector<double> more = variant.more_steps;
  if (variant.coarse) more.insert(more.begin(), long_steps.begin(), long_steps.end());
  if (!selection.coarse) more.clear();
  return rungs<double>(steps, more);
}

/// The trials of one variant with one engine.
std::vector<Setting> settings(const Selection& selection, const Variant& variant, const Engine& engine) {
  std::vector<Setting> result;
  if ((variant.direct || variant.own) && !engine.peer().empty()) return result;
  const std::vector<std::uint32_t> more = selection.coarse ? variant.more_substeps : std::vector<std::uint32_t>();
  const auto substeps = rungs<std::uint32_t>(variant.substeps, more);
  for (Precision precision : {Precision::f64, Precision::f32}) {
    const bool twice = precision == Precision::f64;
    if (!(twice ? selection.twice : selection.single && variant.single) || !engine.has(precision)) continue;
    const auto steps = step_lengths(selection, variant, precision);
    for (const auto& n : substeps)
      for (const auto& dt : steps) {
        const bool slow =
            std::any_of(variant.slow.begin(), variant.slow.end(), [&](double s) { return same(s, dt.value); });
        if ((slow && !selection.slow) || (selection.dt && !same(*selection.dt, dt.value))) continue;
        // what is slow with one sub-step is slower with more
        if (n.value > 1 && substeps.size() > 1 && same(dt.value, ladder.back()) && !selection.slow) continue;
        if (n.value > 1 && !engine.has_substeps() && substeps.size() > 1) continue;
        result.push_back({precision, dt.value, n.value, dt.bounded && n.bounded, variant.order});
      }
  }
  return result;
}

std::unique_ptr<Trial> make_trial(Engine& engine, const Variant& variant, const Setting& setting, long limit,
                                  int repeats = 0) {
  auto trial = std::make_unique<Trial>(engine, setting);
  trial->set_limit(limit);
  trial->set_repeats(repeats);
  trial->set_budget(engine.budget());
  variant.run(*trial);
  trial->finish();
  return trial;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

std::vector<Row> rows_of(const Trial& trial, const Case& c, const Variant& variant, const Setting& setting,
                         Engine& engine, double seconds, const std::string& gl) {
  Row row;
  row.case_name = c.name;
  row.title = c.title;
  row.variant = variant.name;
  row.backend = engine.backend();
  row.precision = setting.precision;
  row.dt = setting.dt;
  row.substeps = setting.substeps;
  row.bounded = setting.bounded;
  row.total_ms = 1000 * seconds;
  row.ns_per_body_step = 1e9 * seconds / std::max(1.0, trial.meter().body_steps);
  row.peer = engine.peer();
  row.gl = gl;
  row.failure = trial.meter().error.message;
  std::vector<Row> rows;
  for (const Finding& finding : trial.findings()) {
    row.metric = finding.metric;
    row.error = row.failure.empty() ? finding.error : std::numeric_limits<double>::quiet_NaN();
    row.lost = variant.lost_at && &finding == trial.findings().data() && !(row.error < *variant.lost_at);
    row.floor = &finding == trial.findings().data() ? variant.floor : std::nullopt;
    row.must = finding.must;
    row.target = finding.target;
    // NaN fails too
    row.pass = row.failure.empty() && (gl.empty() || gl == "equal") &&
               (row.must ? row.error <= *row.must : std::isfinite(row.error));
    rows.push_back(row);
  }
  return rows;
}

/// With repeats the median of so many runs in which nothing is read; a clock that stops for each reading costs as much
/// as a step of the least worlds. Without, or where a run takes long, what the trial's own steps took.
double time_of(Trial& trial, int repeats) {
  const double first = trial.meter().seconds;
  if (repeats < 2 || first > seconds_to_repeat || trial.meter().error.code != ErrorCode::none) return first;
  std::vector<double> seconds;
  for (int i = 0; i < repeats; ++i) {
    const auto again = trial.time_again();
    if (!again) return first;
    seconds.push_back(*again);
  }
  return median(seconds);
}

/// Of a motion that was cut short nothing is known but its hash.
void drop_error(Row& row) {
  row.error = std::numeric_limits<double>::quiet_NaN();
  row.must = row.target = std::nullopt;
  row.lost = false;
  row.pass = row.gl.empty() || row.gl == "equal";
}

std::vector<Row> run_trial(const Selection& selection, const Case& c, const Variant& variant, const Setting& setting,
                           Engine& engine, Engine* gl) {
  const long limit = selection.first ? hashed_steps : std::numeric_limits<long>::max();
  const auto trial = make_trial(engine, variant, setting, limit, selection.repeats > 1 ? selection.repeats : 0);
  const double seconds = time_of(*trial, selection.repeats);
  std::string equal, refused;
  if (gl && engine.peer().empty() && trial->meter().error.code != ErrorCode::unavailable) {
    const auto there = make_trial(*gl, variant, setting, hashed_steps);
    refused = there->meter().error.message;  // too large for the device, say
    equal = !refused.empty() ? "refused" : there->meter().hash == trial->meter().hash ? "equal" : "differs";
  }
  auto rows = rows_of(*trial, c, variant, setting, engine, seconds, equal);
  for (Row& row : rows) {
    if (selection.first) drop_error(row);
    if (row.failure.empty()) row.failure = refused;
  }
  return rows;
}

/// Fills in the orders, and adds the row that says whether the first metric's is what it must be.
void add_orders(const Variant& variant, std::vector<Row>& rows) {
  using Key = std::tuple<std::string, Precision, std::uint32_t, std::string>;
  const auto key = [](const Row& row) { return Key{row.peer, row.precision, row.substeps, row.metric}; };
  std::map<Key, std::pair<std::vector<double>, std::vector<double>>> series;
  for (const Row& row : rows) {
    if (!row.bounded) continue;
    series[key(row)].first.push_back(row.dt);
    series[key(row)].second.push_back(row.error);
  }
  for (Row& row : rows) {
    const auto& [steps, errors] = series[key(row)];
    row.order = order_of_convergence(steps, errors, row.precision);
  }
  const std::string& metric = variant.second_order;
  if (metric.empty()) return;
  std::vector<Row> added;
  for (const auto& [k, points] : series) {
    const auto last = std::find_if(rows.rbegin(), rows.rend(), [&, &k = k](const Row& row) { return key(row) == k; });
    if (std::get<3>(k) != metric || !last->bounded || last->precision != Precision::f64 || !last->peer.empty() ||
        !last->order)
      continue;
    Row row = *last;
    row.metric = std::to_string(variant.order) + " - order of " + metric.substr(0, metric.find(" ["));
    row.error = variant.order - *row.order;
    (variant.order_is_target ? row.target : row.must) = variant.order == 4 ? 0.5 : 0.1;
    (variant.order_is_target ? row.must : row.target).reset();
    row.pass = !row.must || row.error <= *row.must;
    added.push_back(row);
  }
  rows.insert(rows.end(), added.begin(), added.end());
}

}  // namespace

Status check(const Selection& selection) {
  std::string known;
  for (const Case& c : list())
    if (selection.groups.find(c.group()) != std::string::npos) known += (known.empty() ? "" : ", ") + c.name;
  for (const std::string& name : selection.names) {
    Selection one = selection;
    one.names = {name};
    if (selected(one).empty())
      return Error{ErrorCode::unknown_name, "There is no case '" + name + "' here; choose of " + known + "."};
  }
  for (const Case* c : selected(selection))
    if (!variants_of(selection, *c).empty()) return {};
  return Error{ErrorCode::unknown_name,
               "No variant of these cases is named '" + selection.variant + "' or starts so; --list names them."};
}

std::size_t count_trials(const Selection& selection, std::span<Engine* const> engines) {
  std::size_t count = 0;
  for (const Case* c : selected(selection))
    for (const Variant* variant : variants_of(selection, *c))
      for (const Engine* engine : engines) count += settings(selection, *variant, *engine).size();
  return count;
}

std::vector<Row> run(const Selection& selection, std::span<Engine* const> engines,
                     const std::function<void(std::span<const Row>)>& tell,
                     const std::function<void(std::size_t)>& progress) {
  const std::unique_ptr<Engine> gl = selection.gl ? make_pcphys(Place::gl, 0, selection.device) : nullptr;
  std::vector<Row> all;
  std::size_t done = 0;
  for (const Case* c : selected(selection))
    for (const Variant* variant : variants_of(selection, *c)) {
      std::vector<Row> rows;
      for (Engine* engine : engines)
        for (const Setting& setting : settings(selection, *variant, *engine)) {
          const std::vector<Row> found = run_trial(selection, *c, *variant, setting, *engine, gl.get());
          rows.insert(rows.end(), found.begin(), found.end());
          if (progress) progress(++done);
        }
      add_orders(*variant, rows);
      if (tell) tell(rows);
      all.insert(all.end(), rows.begin(), rows.end());
    }
  return all;
}

std::optional<double> order_of_convergence(std::span<const double> steps, std::span<const double> errors,
                                           Precision precision) {
  const double floor = precision == Precision::f64 ? 1e-11 : 1e-5;
  std::vector<std::pair<double, double>> points;
  for (std::size_t i = 0; i < steps.size(); ++i) points.emplace_back(steps[i], errors[i]);
  std::sort(points.begin(), points.end(), std::greater<>());
  std::vector<std::pair<double, double>> kept;  // logarithms, from the longest step on
  for (const auto& [dt, error] : points) {
    if (!(error > floor) || !std::isfinite(error)) break;
    kept.emplace_back(std::log(dt), std::log(error));
  }
  const auto level = [&] {  // at the end: what is left there is rounding
    const auto [x, y] = kept.back();
    const auto [longer, before] = kept[kept.size() - 2];
    return before - y < 0.3 * (longer - x);
  };
  while (kept.size() > 1 && level()) kept.pop_back();
  if (kept.size() < 2) return {};
  const std::size_t first = kept.size() > 3 ? kept.size() - 3 : 0;
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = first; i < kept.size(); ++i) {
    const auto [x, y] = kept[i];
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

}  // namespace pcphys::cases
