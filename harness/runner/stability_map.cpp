#include "runner/stability_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>

#include "base/json_number.hpp"
#include "base/json_text.hpp"
#include "base/sha256.hpp"
#include "base/words.hpp"
#include "results/store.hpp"
#include "runner/boundary.hpp"
#include "runner/interrupt.hpp"
#include "runner/probes.hpp"
#include "runner/stability_theory.hpp"
#include "runner/study_plan.hpp"
#include "runner/worker_pool.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

bool on_gpu(const std::string& solver) {
  const SolverEntry* entry = known_solver(solver);
  return entry != nullptr && entry->info.on_gpu;
}

/// Strings within are expressions of x and y.
json at_values(const json& j, double x, double y) {
  if (j.is_string()) return evaluate(j.get<std::string>(), x, y);
  json out = j;
  if (j.is_structured())
    for (auto& item : out) item = at_values(item, x, y);
  return out;
}

/// Where one row of a map turns, and what was probed on the way.
struct Row {
  json probes = json::array(), seeds = json::array();
  bool done = false, unsupported = false;
  std::string message;
  StabilityCounts counts;
};

/// One map of one study. Its rows, one a solver and value of y, are independent of one another.
class Map {
 public:
  Map(const json& j, const Study& study, const StabilityOptions& o, Probes& probes)
      : j_(j), study_(study), o_(o), probes_(probes) {
    const bool quick = study.length == StudyLength::Quick;
    const json& axes = quick ? j["quick"] : j;
    x_ = (quick ? axes["x"] : axes["x"]["values"]).get<std::vector<double>>();
    y_ = (quick ? axes["y"] : axes["y"]["values"]).get<std::vector<double>>();
    seeds_ = quick ? 1 : j["seeds"].get<int>();
    file_ = find_scenario(j["scene"].get<std::string>());
    scenario_ = parse_json(read_text(file_), file_.string());
    std::sort(x_.begin(), x_.end());
    for (const json& solver : j_["solvers"])
      if (asked_for(solver["solver"].get<std::string>())) solvers_.push_back(&solver);
    rows_.resize(solvers_.size(), std::vector<Row>(y_.size()));
    if (!solvers_.empty()) theory_ = lines(*solvers_.front());
  }

  /// Before the first probe. Throws Error where stored answers are not of this map as it is now.
  void begin() {
    const std::string scenario_sha256 = scene_from_json(scenario_, file_.string()).sha256;
    for (const json* solver : solvers_) {
      probed_by_[solver] = probed_by(*solver, scenario_sha256);
      probes_.require_same(probed_by_[solver]);
    }
  }

  std::size_t solvers() const { return solvers_.size(); }
  std::size_t rows() const { return y_.size(); }

  Row run(std::size_t solver, std::size_t y, RunWorker& worker) const {
    Row row;
    find_turns(*solvers_[solver], y_[y], worker, row);
    row.done = true;
    return row;
  }
  void keep(std::size_t solver, std::size_t y, Row row) { rows_[solver][y] = std::move(row); }

  void count(StabilityCounts& counts) const {
    for (const auto& of_solver : rows_)
      for (const Row& r : of_solver) counts.add(r.counts);
  }

  /// The map as far as its rows are done.
  json document() const {
    json out = {{"name", j_["name"]},         {"title", j_["title"]}, {"scene", j_["scene"]},    {"good", j_["good"]},
                {"headline", j_["headline"]}, {"theory", theory_},    {"solvers", json::array()}};
    for (const char* axis : {"x", "y"}) out[axis] = {{"label", j_[axis]["label"]}, {"unit", j_[axis]["unit"]}};
    for (std::size_t k = 0; k < solvers_.size(); ++k) out["solvers"].push_back(solver_json(k));
    return out;
  }

 private:
  bool asked_for(const std::string& solver) const { return o_.solvers.empty() || contains(o_.solvers, solver); }

  json solver_json(std::size_t k) const {
    const json& solver = *solvers_[k];
    json out = {{"solver", solver["solver"]},
                {"setting", solver["label"]},
                {"on_gpu", on_gpu(solver["solver"])},
                {"unsupported", false},
                {"message", ""},
                {"probes", json::array()},
                {"rows", json::array()},
                {"largest", json()},
                {"open", true}};
    for (std::size_t y = 0; y < y_.size(); ++y) {
      const Row& row = rows_[k][y];
      if (!row.done) continue;
      for (const json& p : row.probes) out["probes"].push_back(p);
      if (row.unsupported) {
        out["unsupported"] = true;
        out["message"] = row.message;
        break;
      }
      for (const json& s : row.seeds) {
        if (!s["first_bad"].is_null()) out["open"] = false;
        if (out["largest"].is_null() || s["last_good"] < out["largest"]) out["largest"] = s["last_good"];
      }
      out["rows"].push_back({{"y", y_[y]}, {"seeds", row.seeds}});
    }
    return out;
  }

  int substeps_at(const json& solver, double x, double y) const {
    const json s = settings_at(solver, x, y);
    return s.contains("substeps") ? std::max(1, s["substeps"].get<int>()) : 1;
  }

  json settings_at(const json& solver, double x, double y) const {
    json s = solver["settings"];
    for (const auto& [key, expression] : solver["settings_from"].items())
      s[key] = std::max<long>(1, std::lround(evaluate(expression.get<std::string>(), x, y)));
    return s;
  }

  std::vector<std::string> set_at(double x, double y, int seed) const {
    std::vector<std::string> out;
    for (const char* axis : {"x", "y"})
      for (const auto& [key, value] : j_[axis]["set"].items()) out.push_back(key + "=" + at_values(value, x, y).dump());
    out.push_back(fmt::format("cloth.start.seed={}", seed));
    return out;
  }

  json lines(const json& solver) const {
    json out = json::array();
    for (const json& name : j_["theory"]) {
      json points = json::array();
      for (double y : y_) {
        const Scene scene = scene_from_json(scenario_, file_.string(), set_at(x_.front(), y, 0));
        const double x = theory(name, scene, substeps_at(solver, x_.front(), y));
        if (std::isfinite(x)) points.push_back({x, y});
      }
      out.push_back({{"name", name}, {"label", theory_label(name)}, {"points", points}});
    }
    return out;
  }

  ProbedBy probed_by(const json& solver, const std::string& scenario_sha256) const {
    const json definition = {{"x", j_["x"]["set"]},
                             {"y", j_["y"]["set"]},
                             {"settings", solver["settings"]},
                             {"settings_from", solver["settings_from"]}};
    ProbedBy by;
    by.map = j_["name"].get<std::string>();
    by.solver = solver["solver"].get<std::string>();
    by.setting = solver["label"].get<std::string>();
    by.scenario_sha256 = scenario_sha256;
    by.definition_sha256 = sha256(definition.dump());
    if (const SolverEntry* entry = known_solver(by.solver)) by.solver_version = entry->info.version;
    return by;
  }

  const RunRecord& probe(const json& solver, double x, double y, int seed, RunWorker& worker, Row& row) const {
    const ProbedBy& by = probed_by_.at(&solver);
    const std::string key = by.key(x, y, seed);
    const RunRecord* found = probes_.find(key);
    if (found == nullptr) {
      stop_if_interrupted(kRunsKept);
      RunRequest r;
      r.scenario = scenario_;
      r.source = file_.string();
      r.set = set_at(x, y, seed);
      r.name = j_["name"].get<std::string>();
      r.solver = solver["solver"];
      r.setting = by.setting;
      r.settings = settings_at(solver, x, y);
      r.rules = {o_.device, protocol_name(study_.length), {}, study_.run_limit_s};
      found = &probes_.add(by, key, worker.run(r));
    }
    row.counts.add(*found);
    row.probes.push_back({{"x", x},
                          {"y", y},
                          {"seed", seed},
                          {"status", found->outcome.status},
                          {"class", found->outcome.klass},
                          {"grade", finite_or_null(grade_of(*found))},
                          {"frame", found->outcome.failed_frame},
                          {"message", found->outcome.message}});
    return *found;
  }

  void find_turns(const json& solver, double y, RunWorker& worker, Row& row) const {
    constexpr double kDecades = 0.05;
    const double most = j_["good"] == "stable" ? 0 : 1;
    const bool quick = study_.length == StudyLength::Quick;
    std::vector<double> values = x_;
    for (int seed = 0; seed < seeds_; ++seed) {
      const auto good = [&](double x) {
        if (row.unsupported) return false;
        const RunRecord& a = probe(solver, x, y, seed, worker, row);
        if (a.outcome.status == "unsupported") {
          row.unsupported = true;
          row.message = a.outcome.message;
        }
        return grade_of(a) <= most;
      };
      const int beyond = seed > 0 || quick ? 0 : static_cast<int>(x_.size());
      const Boundary b = find_boundary(values, quick ? 0.25 : kDecades, beyond, good);
      if (row.unsupported) return;
      row.seeds.push_back({{"last_good", b.last_good}, {"first_bad", finite_or_null(b.first_bad)}});
      if (seed == 0) values = around(b);
    }
  }

  /// Where other seeds look: the values next to the first one's boundary, and one more on either side.
  std::vector<double> around(const Boundary& b) const {
    std::size_t low = 0, high = x_.size() - 1;
    for (std::size_t k = 0; k < x_.size(); ++k) {
      if (x_[k] <= b.last_good) low = k;
      if (x_[k] >= b.first_bad) high = std::min(high, k);
    }
    return {x_.begin() + static_cast<std::ptrdiff_t>(low > 0 ? low - 1 : 0),
            x_.begin() + static_cast<std::ptrdiff_t>(std::min(high + 2, x_.size()))};
  }

  const json& j_;
  const Study& study_;
  const StabilityOptions& o_;
  Probes& probes_;
  std::vector<double> x_, y_;
  int seeds_ = 1;
  fs::path file_;
  std::map<const json*, ProbedBy> probed_by_;
  json scenario_, theory_ = json::array();
  std::vector<const json*> solvers_;
  std::vector<std::vector<Row>> rows_;  ///< a solver, a value of y
};

std::vector<std::unique_ptr<Map>> maps_of(const Study& study, const StabilityOptions& o, Probes& probes) {
  std::vector<std::unique_ptr<Map>> maps;
  if (!study.definition.contains("maps")) return maps;
  for (const json& map : study.definition["maps"])
    if (study.length != StudyLength::Quick || map.contains("quick")) {
      maps.push_back(std::make_unique<Map>(map, study, o, probes));
      maps.back()->begin();
    }
  return maps;
}

fs::path probes_file(const StabilityOptions& o) { return o.out / "stability-probes.jsonl"; }

}  // namespace

void require_same_maps(const Study& study, const StabilityOptions& o) {
  if (!o.resume) return;
  Probes probes(probes_file(o), true);
  maps_of(study, o, probes);
}

StabilityCounts run_stability_maps(const Study& study, const StabilityOptions& o) {
  StabilityCounts counts;
  if (!study.definition.contains("maps")) return counts;
  fs::create_directories(o.out);
  Probes probes(probes_file(o), o.resume);
  const std::vector<std::unique_ptr<Map>> maps = maps_of(study, o, probes);
  std::mutex mutex;
  std::size_t done = 0;
  std::vector<std::function<void(RunWorker&)>> tasks;
  const auto write = [&] {
    json all = json::array();
    for (const auto& map : maps)
      if (map->solvers() > 0) all.push_back(map->document());
    write_file_atomically(
        o.out / "stability.json",
        json{{"format", "clothbench-stability"}, {"format_version", 1}, {"environment", o.environment}, {"maps", all}}
                .dump(1) +
            "\n");
  };
  for (const auto& map : maps)
    for (std::size_t solver = 0; solver < map->solvers(); ++solver)
      for (std::size_t y = 0; y < map->rows(); ++y)
        tasks.push_back([&, m = map.get(), solver, y](RunWorker& worker) {
          Row row = m->run(solver, y, worker);
          const std::lock_guard lock(mutex);
          m->keep(solver, y, std::move(row));
          ++done;
          write();
          if (o.progress) o.progress("rows of maps", done, tasks.size());
        });
  run_tasks(tasks, o.jobs, o.program, o.out / "scratch");
  for (const auto& map : maps) map->count(counts);
  std::error_code ignored;
  fs::remove_all(o.out / "scratch", ignored);
  return counts;
}

}  // namespace clothbench
