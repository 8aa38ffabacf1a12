#include "report/pulled_strip.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/roles.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

struct PulledRun {
  double speed_m_per_s;
  const RunRecord* run;
};

struct PulledRow {
  std::string scene;
  Series series;
  std::vector<PulledRun> runs;  ///< ascending speeds

  const PulledRun* first_fault() const {
    const auto at =
        std::find_if(runs.begin(), runs.end(), [](const PulledRun& c) { return !leak_of("wave", *c.run).empty(); });
    return at == runs.end() ? nullptr : &*at;
  }
};

/// Name from the scene's file, and grid: the same for all speeds of a strip.
std::string strip_of(const RunRecord& c) {
  const json s = scenario_of(c);
  const json grid = s.value(json::json_pointer("/cloth/grid"), json());
  return s.value("name", c.header.scene) +
         (grid.is_array() && grid.size() == 2 ? fmt::format(" {}×{}", grid[0].dump(), grid[1].dump()) : "");
}

std::vector<PulledRow> rows_of(const std::vector<ContactSetUp>& ups) {
  std::vector<PulledRow> out;
  for (const ContactRow& r : contact_rows(ups)) {
    const double speed = summary_value(*r.run, "imposed_speed_m_per_s");
    // A run without frames has no speed, and a solver that ignores the hands has no result to compare.
    if (r.kind != "wave" || is_floor(r.run->header.solver) || !(speed > 0)) continue;
    const std::string strip = strip_of(*r.run);
    find_or_add(out, [&](const PulledRow& p) { return p.scene == strip && p.series == r.series; },
                {strip, r.series, {}})
        .runs.push_back({speed, r.run});
  }
  std::stable_sort(out.begin(), out.end(), [](const PulledRow& a, const PulledRow& b) {
    return a.scene != b.scene ? a.scene < b.scene : a.series < b.series;
  });
  for (PulledRow& p : out)
    std::sort(p.runs.begin(), p.runs.end(),
              [](const PulledRun& a, const PulledRun& b) { return a.speed_m_per_s < b.speed_m_per_s; });
  return out;
}

/// Equal but for the rounding of positions.
bool same_speed(double a, double b) { return std::abs(a - b) <= 1e-6 * b; }

}  // namespace

Table pulled_strip_table(const std::vector<ContactSetUp>& ups) {
  const std::vector<PulledRow> rows = rows_of(ups);
  std::vector<double> speeds;
  for (const PulledRow& r : rows)
    for (const PulledRun& c : r.runs)
      if (std::none_of(speeds.begin(), speeds.end(), [&](double v) { return same_speed(v, c.speed_m_per_s); }))
        speeds.push_back(c.speed_m_per_s);
  std::sort(speeds.begin(), speeds.end());
  static const auto in_metres = [](double v) { return fmt::format("{:g} m/s", v); };
  static const auto failure_speed = [](const PulledRow& r) -> std::string {
    const PulledRun* fault = r.first_fault();
    if (fault == nullptr) return "none up to " + in_metres(r.runs.back().speed_m_per_s);
    return leak_of("wave", *fault->run) == "–" ? "–" : in_metres(fault->speed_m_per_s);
  };
  static const auto errors = [](const PulledRow& r, double v) -> std::string {
    const auto at =
        std::find_if(r.runs.rbegin(), r.runs.rend(), [&](auto& c) { return same_speed(v, c.speed_m_per_s); });
    if (at == r.runs.rend()) return "";
    const RunRecord& c = *at->run;
    if (c.outcome.status != "ok") return c.outcome.status;
    return in_form("{:.2g}")(summary_value(c, "truth_quantity_error_max")) + " / " +
           in_form("{:.1e}")(summary_value(c, "truth_e2"));
  };
  return Columns<PulledRow>{{"", "strip", &PulledRow::scene},
                            {"", "solver", [](auto& r) { return r.series.label(); }},
                            {"", "failure speed", failure_speed}}
      .across(speeds, in_metres, errors)
      .table({"A strip pulled at both ends against its exact wave",
              "First figure: the greatest strain along the strip minus the exact one (reference case "
              "two-hand-pull, same mesh), the greatest over all frames, divided by v0/c, the strain that one wave "
              "brings. Second figure: RMS distance over space and time, divided by L. A run fails by the bounds of the "
              "exact solution (scalars `truth_e2_bound`, `truth_quantity_error_bound`). The exact solution is "
              "proportional to v0, so a solver is not linear if its first figure depends on the speed.",
              {}},
             rows);
}

json pulled_strip_json(const std::vector<ContactSetUp>& ups) {
  const Columns<PulledRun> speeds = {{"speed_m_per_s", In::Json, &PulledRun::speed_m_per_s},
                                     {"status", In::Json, status_of},
                                     {"strain_error_max", In::Json, summary("truth_quantity_error_max")},
                                     {"strain_error_rms", In::Json, summary("truth_quantity_error")},
                                     {"e2", In::Json, summary("truth_e2")},
                                     {"fault", In::Json, [](auto& c) { return leak_of("wave", *c.run); }}};
  const Columns<PulledRow> strips = {{"strip", In::Json, &PulledRow::scene},
                                     {"solver", In::Json, [](auto& r) { return r.series.solver; }},
                                     {"setting", In::Json, [](auto& r) { return r.series.setting; }},
                                     {"speeds", In::Json, [&](auto& r) { return speeds.json(r.runs); }},
                                     {"first_fault_m_per_s", In::Json, [](auto& r) {
                                        const PulledRun* fault = r.first_fault();
                                        return fault == nullptr ? json() : json(fault->speed_m_per_s);
                                      }}};
  return strips.json(rows_of(ups));
}

}  // namespace clothbench
