#include "report/across_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "report/grid.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr double kHitchFactor = 3;

struct Run {
  const RunRecord* run;
  json scenario;
  bool ok() const { return run->outcome.status == "ok"; }
  double number(const char* name) const { return summary_value(*run, name); }
};

using Runs = std::vector<Run>;

/// Positions of all frames in units of the cloth's width, relative to its centre.
std::vector<double> shape_of(const Run& r) {
  const RunRecord whole = read_run(r.run->file);
  const json& cloth = r.scenario["cloth"];
  const double width = cloth["size_m"][0].get<double>();
  std::vector<double> out;
  for (std::size_t k = 0; k < whole.accuracy.position.size(); ++k)
    out.push_back((static_cast<double>(whole.accuracy.position[k]) - cloth["pose"]["center_m"][k % 3].get<double>()) /
                  width);
  return out;
}

/// Greatest difference; infinity if sizes differ or values are NaN. Bitwise equal positions give 0.
double difference(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size() || a.empty()) return INFINITY;
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double d = std::abs(a[k] - b[k]);
    most = d <= most ? most : std::isnan(d) ? INFINITY : d;
  }
  return most;
}

double simulated_s(const json& scenario) {
  const json& time = scenario["time"];
  const double more =
      time.contains("hitch") ? time["hitch"]["dt_s"].get<double>() - 1 / time["frame_rate_hz"].get<double>() : 0;
  return time["duration_s"].get<double>() + more;
}

bool is_even(const Run& r) { return !r.scenario["time"].contains("hitch") && !r.scenario["time"].contains("jitter"); }

void hitches(const Runs& runs, const AcrossRuns& begin, std::vector<AcrossRuns>& out) {
  for (const Run& r : runs) {
    if (is_even(r)) continue;
    const Run* even = nullptr;
    const auto apart = [&](const Run& e) { return std::abs(simulated_s(e.scenario) - simulated_s(r.scenario)); };
    for (const Run& e : runs)
      if (is_even(e) && (even == nullptr || apart(e) < apart(*even))) even = &e;
    if (even == nullptr || !even->ok()) continue;
    AcrossRuns a = begin;
    a.figure = "error over that of even frames, " + r.run->header.scene;
    a.value = r.ok() ? r.number("truth_e2") / even->number("truth_e2") : INFINITY;
    a.bound = kHitchFactor;
    a.text = fmt::format("{:.2g} against {:.2g} L", r.number("truth_e2"), even->number("truth_e2"));
    out.push_back(std::move(a));
  }
}

void scales(const Runs& runs, const AcrossRuns& begin, std::vector<AcrossRuns>& out) {
  const auto width = [](const Run& r) { return r.scenario["cloth"]["size_m"][0].get<double>(); };
  const auto middle = std::find_if(runs.begin(), runs.end(), [&](const Run& r) { return width(r) == 1; });
  if (middle == runs.end() || !middle->ok()) return;
  const std::vector<double> right = shape_of(*middle);
  for (const Run& r : runs) {
    if (&r == &*middle) continue;
    AcrossRuns a = begin;
    a.figure = fmt::format("greatest difference at {:g} m from 1 m, over L", width(r));
    a.value = r.ok() ? difference(shape_of(r), right) : INFINITY;
    a.bound = 0;
    a.text = a.value == 0 ? "the same bits" : fmt::format("{:.2g} L", a.value);
    out.push_back(std::move(a));
  }
}

void resolutions(const Runs& runs, const AcrossRuns& begin, std::vector<AcrossRuns>& out) {
  std::map<int, double> strain;
  for (const Run& r : runs)
    if (r.ok()) strain[r.scenario["cloth"]["grid"][0].get<int>()] = r.number("stretch_max_last_second");
  if (strain.size() < 2) return;
  AcrossRuns a = begin;
  a.figure =
      fmt::format("greatest strain of the last second, {}² over {}²", strain.rbegin()->first, strain.begin()->first);
  a.value = strain.rbegin()->second / strain.begin()->second;
  for (const auto& [n, e] : strain) a.text += fmt::format("{}{}²: {:.3g} %", a.text.empty() ? "" : ", ", n, 100 * e);
  out.push_back(std::move(a));
}

void repeats(const Runs& runs, const AcrossRuns& begin, std::vector<AcrossRuns>& out) {
  std::map<int, Runs> seeds;
  for (const Run& r : runs) seeds[r.scenario["cloth"]["start"].value("seed", 0)].push_back(r);
  std::vector<std::vector<double>> firsts;
  double repeat = -1, spread = -1;
  int again = 0;
  for (const auto& [seed, same] : seeds) {
    if (!std::all_of(same.begin(), same.end(), [](const Run& r) { return r.ok(); })) {
      repeat = INFINITY;
      continue;
    }
    firsts.push_back(shape_of(same.front()));
    for (std::size_t k = 1; k < same.size(); ++k, ++again)
      repeat = std::max(repeat, difference(firsts.back(), shape_of(same[k])));
    spread = std::max(spread, firsts.size() > 1 ? difference(firsts.front(), firsts.back()) : spread);
  }
  if (repeat < 0) return;
  AcrossRuns a = begin;
  a.figure = "greatest difference of the same run in other processes, over L";
  a.value = repeat;
  a.bound = 0;
  a.text = repeat == 0 ? fmt::format("the same bits, {} repeats", again) : fmt::format("{:.2g} L", repeat);
  if (spread >= 0) a.text += fmt::format("; other seeds of 1e-4 m: {:.2g} L apart", spread);
  out.push_back(std::move(a));
}

const Columns<AcrossRuns>& across_columns() {
  static const auto plain = [](double v) { return std::isnan(v) ? "–" : fmt::format("{:.3g}", v); };
  static const Columns<AcrossRuns> all = {
      {"case", "case", &AcrossRuns::case_name},
      {"solver", "solver", &AcrossRuns::solver},
      {"setting", "setting", &AcrossRuns::setting},
      {"figure", "figure", &AcrossRuns::figure},
      {"value", "value", &AcrossRuns::value, plain},
      {"bound", In::Both, &AcrossRuns::bound},
      {"verdict", "verdict", [](auto& a) { return !a.judged()  ? ""
                                                  : a.passed() ? "pass"
                                                               : "fail"; }},
      {"", "", &AcrossRuns::text}};
  return all;
}

}  // namespace

std::vector<AcrossRuns> across_runs(const std::vector<RunRecord>& runs) {
  std::map<std::tuple<std::string, std::string, std::string>, Runs> groups;
  for (const RunRecord& c : runs) {
    json scenario = scenario_of(c);
    if (!scenario.is_object() || !scenario.contains("stability") || c.outcome.status == "unsupported" ||
        c.outcome.status == "missing")
      continue;
    auto name = scenario["stability"].value("case", "");
    groups[{std::move(name), c.header.solver, c.header.setting}].push_back({&c, std::move(scenario)});
  }
  std::vector<AcrossRuns> out;
  for (const auto& [key, runs] : groups) {
    AcrossRuns begin;
    std::tie(begin.case_name, begin.solver, begin.setting) = key;
    if (begin.case_name == "S22") hitches(runs, begin, out);
    if (begin.case_name == "S24") scales(runs, begin, out);
    if (begin.case_name == "S25") resolutions(runs, begin, out);
    if (begin.case_name == "S26") repeats(runs, begin, out);
  }
  return out;
}

Table across_table(const std::vector<AcrossRuns>& all) {
  return across_columns().table(
      {"Across runs",
       "What no run shows alone. S22: at most 3 times the error of even frames. S24, S26: the same "
       "bits. S25 is reported, not judged.",
       {}},
      all);
}

std::string across_csv(const std::vector<AcrossRuns>& all) { return across_columns().csv(all); }

}  // namespace clothbench
