#include "report/across_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "report/pairs.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

double of_scenario(const RunRecord& c, const char* pointer) {
  return scenario_of(c)[json::json_pointer(pointer)].get<double>();
}

AcrossRuns row_of(const RunPair& p, std::string figure, double value) {
  const double judged = p.other->outcome.status == "ok" || std::isnan(p.relation->bound) ? value : INFINITY;
  return {scenario_of(*p.run)["stability"].value("case", ""),
          p.series.solver,
          p.series.setting,
          std::move(figure),
          "",
          judged,
          p.relation->bound};
}

void hitches(const std::vector<RunPair>& pairs, std::vector<AcrossRuns>& out) {
  for (const RunPair& p : pairs) {
    out.push_back(row_of(p, "error divided by that of even frames, " + p.other->header.scene, p.value));
    out.back().text =
        fmt::format("{:.2g} against {:.2g} L", summary_value(*p.other, "truth_e2"), summary_value(*p.run, "truth_e2"));
  }
}

/// Positions that could not be compared are not the same.
double known(double value) { return std::isnan(value) ? INFINITY : value; }

void scales(const std::vector<RunPair>& pairs, std::vector<AcrossRuns>& out) {
  for (const RunPair& p : pairs) {
    const double width = of_scenario(*p.other, "/cloth/size_m/0");
    out.push_back(row_of(p, fmt::format("greatest difference at {:g} m from 1 m, over L", width), known(p.value)));
    out.back().text = out.back().value == 0 ? "the same bits" : fmt::format("{:.2g} L", out.back().value);
  }
}

/// The finest against the coarsest, by solver and setting; its text has all.
void resolutions(const std::vector<RunPair>& pairs, std::vector<AcrossRuns>& out) {
  std::map<std::pair<std::string, std::string>, std::map<int, const RunPair*>> all;
  for (const RunPair& p : pairs)
    if (p.other->outcome.status == "ok")
      all[{p.series.solver, p.series.setting}][static_cast<int>(of_scenario(*p.other, "/cloth/grid/0"))] = &p;
  for (const auto& [key, finer] : all) {
    const auto& [finest, last] = *finer.rbegin();
    const double coarsest = of_scenario(*last->run, "/cloth/grid/0");
    out.push_back(
        row_of(*last, fmt::format("greatest strain of the last second, {}² over {}²", finest, coarsest), last->value));
    const auto strain = [](double n, const RunRecord& c) {
      return fmt::format("{}²: {:.3g} %", n, 100 * summary_value(c, "stretch_max_last_second"));
    };
    out.back().text = strain(coarsest, *last->run);
    for (const auto& [n, p] : finer) out.back().text += ", " + strain(n, *p->other);
  }
}

/// The greatest difference of all repeats, by solver and setting; its text has that of other seeds.
void repeats(const std::vector<RunPair>& same, const std::vector<RunPair>& seeds, std::vector<AcrossRuns>& out) {
  struct Greatest {
    AcrossRuns row;
    int again = 0;
    double spread = -1;
  };
  std::map<std::pair<std::string, std::string>, Greatest> all;
  for (const RunPair& p : same) {
    AcrossRuns row = row_of(p, "greatest difference of the same run in other processes, over L",
                            p.both_ok() ? known(p.value) : INFINITY);
    Greatest& g = all[{p.series.solver, p.series.setting}];
    if (++g.again == 1 || row.value > g.row.value) g.row = std::move(row);
  }
  for (const RunPair& p : seeds)
    if (const auto g = all.find({p.series.solver, p.series.setting}); g != all.end()) {
      if (!p.both_ok())
        g->second.row.value = INFINITY;
      else
        g->second.spread = std::max(g->second.spread, known(p.value));
    }
  for (auto& [key, g] : all) {
    g.row.text =
        g.row.value == 0 ? fmt::format("the same bits, {} repeats", g.again) : fmt::format("{:.2g} L", g.row.value);
    if (g.spread >= 0) g.row.text += fmt::format("; other seeds of 1e-4 m: {:.2g} L apart", g.spread);
    out.push_back(std::move(g.row));
  }
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
  // What is repeated is judged even where the first one failed.
  const auto pairs = [&](const char* relation, bool base_ok = true) {
    std::vector<RunPair> all = run_pairs(runs, relation);
    std::erase_if(all, [&](const RunPair& p) {
      return p.other->outcome.status == "unsupported" || p.run->outcome.status == "unsupported" ||
             (base_ok && p.run->outcome.status != "ok");
    });
    return all;
  };
  std::vector<AcrossRuns> out;
  hitches(pairs("even-frames"), out);
  scales(pairs("scale"), out);
  resolutions(pairs("resolution"), out);
  repeats(pairs("repeat", false), pairs("seed", false), out);
  std::stable_sort(out.begin(), out.end(), [](const AcrossRuns& a, const AcrossRuns& b) {
    return std::tie(a.case_name, a.solver, a.setting) < std::tie(b.case_name, b.solver, b.setting);
  });
  return out;
}

Table across_table(const std::vector<AcrossRuns>& all) {
  return across_columns().table(
      {"Across runs",
       "Figures that need several runs. S22: the error is at most 3 times that of even frames. S24, S26: "
       "the results are equal bit by bit. S25 has no bound; its value is printed.",
       {}},
      all);
}

std::string across_csv(const std::vector<AcrossRuns>& all) { return across_columns().csv(all); }

}  // namespace clothbench
