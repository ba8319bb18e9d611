#include "compare_table.h"

#include <algorithm>
#include <cstdio>
#include <numbers>

namespace pcphys::command {
namespace {

constexpr double degrees = 180 / std::numbers::pi;
constexpr double mm = 1000;

template <class... Values> std::string format(const char* pattern, Values... values) {
  char buffer[256];
  std::snprintf(buffer, sizeof buffer, pattern, values...);
  return buffer;
}

/// pcphys's median step over this entrant's, of as many steps as it made; 0 when it made none.
double time_ratio(const Contest& contest, std::size_t entrant) {
  const std::vector<double>&all = contest.score(0).ms, &its = contest.score(entrant).ms;
  if (its.empty()) return 0;
  const std::vector<double> own(all.begin(), all.begin() + std::ptrdiff_t(std::min(all.size(), its.size())));
  return median(own) / median(its);
}

bool has_cones(const Contest& contest) {
  return std::any_of(contest.scene().joints.begin(), contest.scene().joints.end(), [&](JointId id) {
    const auto joint = contest.world().joint(id);
    return joint && joint->freedom.kind == AngleFreedom::Kind::cone_twist;
  });
}

Json identity(const Contest& contest, const Entrant& who) {
  const scenes::Scene& scene = contest.scene();
  Json untranslated = Json::array();
  if (who.engine)
    for (const std::string& sentence : who.engine->untranslated()) untranslated.push_back(sentence);
  return {{"scene", scene.name},
          {"count", scene.count},
          {"ratio", scene.ratio},
          {"bodies", contest.world().body_count()},
          {"joints", contest.world().joint_count()},
          {"engine", who.name},
          {"version", who.version},
          {"solver", who.solver},
          {"precision", who.precision},
          {"substeps", who.engine ? Json(who.engine->substeps(contest.dt())) : Json(nullptr)},
          {"iterations", who.engine ? Json(who.engine->iterations()) : Json(nullptr)},
          {"problem", who.problem.empty() ? Json(nullptr) : Json(who.problem)},
          {"untranslated", untranslated}};
}

Json measures(const Contest& contest, std::size_t entrant) {
  const Score& score = contest.score(entrant);
  const scenes::Metrics& end = score.end;
  const peers::Peer& engine = *contest.entrants()[entrant].engine;
  const auto deepest = engine.deepest();
  const bool boxes = !contest.scene().supports.empty();
  return {{"steps", score.steps},
          {"dt", contest.dt()},
          {"clock", contest.processor_time() ? "processor" : "wall"},
          {"median_ms", median(score.ms)},
          {"p99_ms", quantile(score.ms, 0.99)},
          {"time_ratio", time_ratio(contest, entrant)},
          {"max_penetration", end.penetration.max},
          {"mean_penetration", end.penetration.mean()},
          {"peak_penetration", score.peak_penetration},
          {"max_joint_separation", end.separation.max},
          {"mean_joint_separation", end.separation.mean},
          {"peak_joint_separation", score.peak_separation},
          {"limit_excess_degrees", end.limit_excess.any * degrees},
          {"peak_limit_excess_degrees", score.peak_limit.any * degrees},
          {"cone_excess_degrees", end.limit_excess.cone * degrees},
          {"peak_cone_excess_degrees", score.peak_limit.cone * degrees},
          {"energy_start", score.start.energy()},
          {"energy_end", end.energy()},
          {"kinetic_energy_end", end.kinetic},
          {"energy_max", score.peak_energy},
          {"drift", end.drift.sideways},
          {"fallen", end.drift.fallen},
          {"stands", boxes ? Json(end.drift.fallen == 0 && end.nonfinite == 0) : Json(nullptr)},
          {"escaped", end.escapes.through},
          {"escaped_over_rim", end.escapes.over_the_rim},
          {"nonfinite", end.nonfinite},
          {"contact_points", engine.contacts()},
          {"engine_penetration", deepest ? Json(*deepest) : Json(nullptr)},
          {"failures", engine.failures()}};
}

/// A table whose columns are as wide as what stands in them; the first is of words, the others of numbers.
class Table {
 public:
  void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  std::string text() const {
    std::vector<std::size_t> widths;
    for (const auto& row : rows_)
      for (std::size_t i = 0; i < row.size(); ++i) {
        if (i == widths.size()) widths.push_back(0);
        widths[i] = std::max(widths[i], row[i].size());
      }
    std::string text;
    for (const auto& row : rows_) {
      for (std::size_t i = 0; i < row.size(); ++i) {
        const std::string pad(widths[i] - row[i].size(), ' ');
        text += i == 0 ? row[i] + pad : "  " + pad + row[i];
      }
      text += "\n";
    }
    return text;
  }

 private:
  std::vector<std::vector<std::string>> rows_;
};

std::vector<std::string> head(const Contest& contest) {
  std::vector<std::string> cells{"", "ms a step", "pcphys / it"};
  const bool collide = contest.scene().floor.has_value(), jointed = !contest.scene().joints.empty();
  if (collide) cells.insert(cells.end(), {"overlap max", "mean", "peak [mm]"});
  if (jointed) cells.insert(cells.end(), {"joints apart max", "mean", "peak [mm]"});
  if (jointed && contest.scene().floor) cells.insert(cells.end(), {"beyond limits", "peak [deg]"});
  cells.insert(cells.end(), {"energy end", "max [of start]"});
  if (!contest.scene().supports.empty()) cells.insert(cells.end(), {"drift [mm]", ""});
  return cells;
}

std::vector<std::string> line(const Contest& contest, std::size_t entrant) {
  const Entrant& who = contest.entrants()[entrant];
  const Score& score = contest.score(entrant);
  const scenes::Metrics& end = score.end;
  std::vector<std::string> cells{who.name};
  if (!who.engine || score.steps == 0) return cells;
  cells.push_back(format("%.4f", median(score.ms)));
  cells.push_back(entrant == 0 ? "" : format("%.2g", time_ratio(contest, entrant)));
  if (contest.scene().floor)
    for (double depth : {end.penetration.max, end.penetration.mean(), score.peak_penetration})
      cells.push_back(format("%.3g", mm * depth));
  if (!contest.scene().joints.empty())
    for (double gap : {end.separation.max, end.separation.mean, score.peak_separation})
      cells.push_back(format("%.3g", mm * gap));
  if (!contest.scene().joints.empty() && contest.scene().floor) {
    const bool cones = has_cones(contest);
    cells.push_back(format("%.2f", degrees * (cones ? end.limit_excess.cone : end.limit_excess.any)));
    cells.push_back(format("%.2f", degrees * (cones ? score.peak_limit.cone : score.peak_limit.any)));
  }
  const double start = contest.score(0).start.energy();  // one unit for all
  cells.push_back(format("%.4g", end.energy() / start));
  cells.push_back(format("%.4g", score.peak_energy / start));
  if (!contest.scene().supports.empty()) {
    cells.push_back(format("%.1f", mm * end.drift.sideways));
    cells.push_back(end.drift.fallen ? "falls" : "stands");
  }
  return cells;
}

/// What the numbers do not say.
std::string remarks(const Contest& contest, std::size_t entrant) {
  const Entrant& who = contest.entrants()[entrant];
  const scenes::Metrics& end = contest.score(entrant).end;
  std::vector<std::string> said;
  if (!who.problem.empty()) said.push_back(who.problem);
  if (end.escapes.through) said.push_back(format("bodies that escaped: %ld", end.escapes.through));
  if (end.escapes.over_the_rim) said.push_back(format("bodies thrown over the rim: %ld", end.escapes.over_the_rim));
  if (end.nonfinite) said.push_back(format("bodies that are not finite: %ld", end.nonfinite));
  if (who.engine && who.engine->failures())
    said.push_back(
        format("it dropped contacts or constraints in %llu sub-steps", (unsigned long long)who.engine->failures()));
  if (who.engine)
    for (const std::string& sentence : who.engine->untranslated()) said.push_back(sentence);
  std::string text;
  for (const std::string& sentence : said) text += "  " + who.name + ": " + sentence + "\n";
  return text;
}

}  // namespace

Json compare_rows(const Contest& contest) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < contest.entrants().size(); ++i) {
    Json row = identity(contest, contest.entrants()[i]);
    if (contest.entrants()[i].engine) row.update(measures(contest, i));
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string compare_csv(const Json& rows, bool with_head) {
  std::string text;
  const Json& full = rows.front();  // pcphys's, which has every key
  const auto add = [&](auto cell) {
    std::string line;
    for (const auto& [key, value] : full.items()) line += (line.empty() ? "" : ",") + cell(key);
    text += line + "\n";
  };
  if (with_head) add([](const std::string& key) { return key; });
  for (const Json& row : rows)
    add([&](const std::string& key) {
      if (!row.contains(key) || row[key].is_null()) return std::string();
      return row[key].is_array() ? std::to_string(row[key].size()) : row[key].dump();
    });
  return text;
}

std::string compare_text(const Contest& contest) {
  const scenes::Scene& scene = contest.scene();
  std::string text = format("%s %d: %zu bodies, %zu joints, %llu steps of %g s\n", scene.name.c_str(), scene.count,
                            contest.world().body_count(), contest.world().joint_count(),
                            (unsigned long long)contest.score(0).steps, contest.dt());
  Table table;
  table.add(head(contest));
  for (std::size_t i = 0; i < contest.entrants().size(); ++i) table.add(line(contest, i));
  text += table.text();
  for (std::size_t i = 0; i < contest.entrants().size(); ++i) text += remarks(contest, i);
  return text;
}

}  // namespace pcphys::command
