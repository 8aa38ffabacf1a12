#include "runner/stability_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <set>

#include "results/store.hpp"
#include "runner/boundary.hpp"
#include "runner/cell.hpp"
#include "runner/stability_theory.hpp"
#include "scenario/json_text.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const char* protocol_name(StudyLength length) {
  return length == StudyLength::Full ? "full" : length == StudyLength::Quick ? "quick" : "short";
}

void stop_if_interrupted() {
  if (interrupt_requested())
    throw Error("interrupted; finished cells are kept (continue with --resume)", ExitCode::Interrupted);
}

bool on_gpu(const std::string& solver) {
  for (const SolverEntry& e : solvers())
    if (e.info.name == solver) return e.info.on_gpu;
  return false;
}

/// Strings within are expressions of x and y.
json at_values(const json& j, double x, double y) {
  if (j.is_string()) return evaluate(j.get<std::string>(), x, y);
  json out = j;
  if (j.is_structured())
    for (auto& item : out) item = at_values(item, x, y);
  return out;
}

json or_null(double v) { return std::isfinite(v) ? json(v) : json(); }

/// Answers so far, on disk line by line. A torn last line, from a kill, is passed over.
class Probes {
 public:
  Probes(fs::path file, bool resume) : file_(std::move(file)) {
    std::ifstream in(file_);
    for (std::string line; resume && std::getline(in, line);) {
      const json j = json::parse(line, nullptr, false);
      if (j.is_object() && j.contains("key") && j.contains("answer")) known_[j["key"]] = answer_from_json(j["answer"]);
    }
    if (!resume) write_file_atomically(file_, "");
  }
  const CellAnswer* find(const std::string& key) const {
    const auto at = known_.find(key);
    return at == known_.end() ? nullptr : &at->second;
  }
  const CellAnswer& add(const std::string& key, const CellAnswer& a) {
    std::ofstream out(file_, std::ios::app);
    out << json{{"key", key}, {"answer", to_json(a)}}.dump() << '\n';
    out.flush();
    if (!out) throw Error(file_.string() + ": cannot be written", ExitCode::CheckFailed);
    return known_[key] = a;
  }

 private:
  const fs::path file_;
  std::map<std::string, CellAnswer> known_;
};

double grade_of(const CellAnswer& a) {
  const auto at = a.summary.find("stability_grade");
  return at != a.summary.end() && std::isfinite(at->second) ? at->second
         : a.outcome.status == "unsupported"                ? kMissing
                                                            : 2;
}

/// One map of one study.
class Map {
 public:
  Map(const json& j, const Study& study, const StabilityOptions& o, Probes& probes, StabilityCounts& counts)
      : j_(j), study_(study), o_(o), probes_(probes), counts_(counts) {
    const bool quick = study.length == StudyLength::Quick;
    const json& axes = quick ? j["quick"] : j;
    x_ = (quick ? axes["x"] : axes["x"]["values"]).get<std::vector<double>>();
    y_ = (quick ? axes["y"] : axes["y"]["values"]).get<std::vector<double>>();
    seeds_ = quick ? 1 : study.length == StudyLength::Full ? j["seeds"].get<int>() : 1;
    file_ = find_scenario(j["scene"].get<std::string>());
    scenario_ = parse_json(read_text(file_), file_.string());
    std::sort(x_.begin(), x_.end());
  }

  /// `keep` is called whenever a row is done, with the map as it then stands.
  void run(const std::function<void(const json&)>& keep) {
    json out = {{"name", j_["name"]},      {"title", j_["title"]},       {"scene", j_["scene"]},
                {"good", j_["good"]},      {"headline", j_["headline"]}, {"theory", json::array()},
                {"solvers", json::array()}};
    for (const char* axis : {"x", "y"}) out[axis] = {{"label", j_[axis]["label"]}, {"unit", j_[axis]["unit"]}};
    for (const json& solver : j_["solvers"]) {
      if (!o_.solvers.empty() && std::find(o_.solvers.begin(), o_.solvers.end(), solver["solver"]) == o_.solvers.end())
        continue;
      if (out["theory"].empty()) out["theory"] = lines(solver);
      out["solvers"].push_back(begin(solver));
      const std::size_t at = out["solvers"].size() - 1;
      for (double y : y_) {
        if (out["solvers"][at]["unsupported"].get<bool>()) break;
        row(solver, y, out["solvers"][at]);
        keep(out);
      }
      keep(out);
    }
  }

 private:
  static json begin(const json& solver) {
    return {{"solver", solver["solver"]},
            {"setting", solver["label"]},
            {"on_gpu", on_gpu(solver["solver"])},
            {"unsupported", false},
            {"message", ""},
            {"probes", json::array()},
            {"rows", json::array()},
            {"largest", json()},
            {"open", true}};
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

  const CellAnswer& probe(const json& solver, double x, double y, int seed, json& told) {
    const auto label = solver["label"].get<std::string>();
    const std::string key = fmt::format("{}|{}|{}|{:.17g}|{:.17g}|{}", j_["name"].get<std::string>(),
                                        solver["solver"].get<std::string>(), label, x, y, seed);
    const CellAnswer* found = probes_.find(key);
    if (found == nullptr) {
      stop_if_interrupted();
      if (o_.progress)
        o_.progress(fmt::format("{} {}: x = {:.4g}, y = {:.4g}", j_["name"].get<std::string>(),
                                solver["solver"].get<std::string>(), x, y),
                    0, 0);
      CellRequest r;
      r.scenario = scenario_;
      r.source = file_.string();
      r.set = set_at(x, y, seed);
      r.name = j_["name"].get<std::string>();
      r.solver = solver["solver"];
      r.setting = label;
      r.settings = settings_at(solver, x, y);
      r.device = o_.device;
      r.protocol = protocol_name(study_.length);
      r.limit_s = study_.cell_limit_s;
      found = &probes_.add(key, run_in_process(r, o_.program, o_.out / "scratch"));
    }
    counts_.add(*found);
    told["probes"].push_back({{"x", x},
                              {"y", y},
                              {"seed", seed},
                              {"status", found->outcome.status},
                              {"class", found->outcome.klass},
                              {"grade", or_null(grade_of(*found))},
                              {"frame", found->outcome.failed_frame},
                              {"message", found->outcome.message}});
    return *found;
  }

  void row(const json& solver, double y, json& told) {
    constexpr double kDecades = 0.05;
    const double most = j_["good"] == "stable" ? 0 : 1;
    const bool quick = study_.length == StudyLength::Quick;
    json seeds = json::array();
    std::vector<double> values = x_;
    for (int seed = 0; seed < seeds_; ++seed) {
      const auto good = [&](double x) {
        if (told["unsupported"].get<bool>()) return false;
        const CellAnswer& a = probe(solver, x, y, seed, told);
        if (a.outcome.status == "unsupported") {
          told["unsupported"] = true;
          told["message"] = a.outcome.message;
        }
        return grade_of(a) <= most;
      };
      const int beyond = seed > 0 || quick ? 0 : static_cast<int>(x_.size());
      const Boundary b = find_boundary(values, quick ? 0.25 : kDecades, beyond, good);
      if (told["unsupported"].get<bool>()) return;
      seeds.push_back({{"last_good", b.last_good}, {"first_bad", or_null(b.first_bad)}});
      if (std::isfinite(b.first_bad)) told["open"] = false;
      if (told["largest"].is_null() || b.last_good < told["largest"].get<double>()) told["largest"] = b.last_good;
      if (seed == 0) values = around(b);
    }
    told["rows"].push_back({{"y", y}, {"seeds", seeds}});
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
  StabilityCounts& counts_;
  std::vector<double> x_, y_;
  int seeds_ = 1;
  fs::path file_;
  json scenario_;
};

}  // namespace

void StabilityCounts::add(const CellAnswer& a) {
  const double grade = grade_of(a);
  if (a.outcome.status == "unsupported")
    ++unsupported;
  else if (grade == 0)
    ++stable;
  else if (grade == 1)
    ++degraded;
  else
    ++failed;
  if (a.outcome.status == "crashed" || a.outcome.message.starts_with("its process")) ++crashed;
}

StabilityCounts run_stability_cells(const Study& study, const StabilityOptions& o) {
  StabilityCounts counts;
  std::size_t all = 0, done = 0;
  for (const Study::Item& item : study.scenes) all += item.solvers.size();
  for (const Study::Item& item : study.scenes)
    for (const std::size_t k : item.solvers) {
      const StudySolver& s = study.solvers[k];
      stop_if_interrupted();
      if (o.progress) o.progress(item.scene.name + " with " + s.name(), done, all);
      ++done;
      CellHeader h;
      h.scene = item.scene.name;
      h.solver = s.solver;
      h.setting = s.label;
      const std::string cell = cell_name(h);
      if (cell_finished(o.out, cell)) {
        if (!o.resume)
          throw Error(fmt::format("{}: {} is already there; give another --out, or --resume to go on with this folder",
                                  o.out.string(), cell));
        const CellRecord before =
            read_cell_summary(fs::exists(o.out / (cell + ".h5")) ? o.out / (cell + ".h5") : o.out / (cell + ".part"));
        counts.add({before.outcome, before.summary, kMissing});
        continue;
      }
      CellRequest r;
      r.scenario = json::parse(item.scene.json);
      r.source = item.scene.source;
      r.name = item.scene.name;
      r.solver = s.solver;
      r.setting = s.label;
      r.settings = s.settings;
      r.device = o.device;
      r.protocol = protocol_name(study.length);
      r.limit_s = study.cell_limit_s;
      r.out = o.out;
      counts.add(run_in_process(r, o.program, o.out / "scratch"));
    }
  std::error_code ignored;
  fs::remove_all(o.out / "scratch", ignored);
  return counts;
}

StabilityCounts run_stability_maps(const Study& study, const StabilityOptions& o) {
  StabilityCounts counts;
  if (!study.definition.contains("maps")) return counts;
  fs::create_directories(o.out);
  Probes probes(o.out / "stability-probes.jsonl", o.resume);
  json finished = json::array();
  for (const json& map : study.definition["maps"]) {
    if (study.length == StudyLength::Quick && !map.contains("quick")) continue;
    json now;
    Map(map, study, o, probes, counts).run([&](const json& so_far) {
      now = so_far;
      json all = finished;
      all.push_back(now);
      write_file_atomically(
          o.out / "stability.json",
          json{{"format", "clothbench-stability"}, {"format_version", 1}, {"environment", o.environment}, {"maps", all}}
                  .dump(1) +
              "\n");
    });
    if (!now.is_null() && !now["solvers"].empty()) finished.push_back(now);
  }
  std::error_code ignored;
  fs::remove_all(o.out / "scratch", ignored);
  return counts;
}

}  // namespace clothbench
