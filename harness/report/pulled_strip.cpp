#include "report/pulled_strip.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/json_number.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

struct Cell {
  double speed_m_per_s;
  const CellRecord* cell;
};

struct PulledRow {
  std::string scene;
  Series series;
  std::vector<Cell> cells;  ///< ascending speeds

  const Cell* first_fault() const {
    const auto at =
        std::find_if(cells.begin(), cells.end(), [](const Cell& c) { return !leak_of("wave", *c.cell).empty(); });
    return at == cells.end() ? nullptr : &*at;
  }
};

/// Name in the scene's file and grid: one strip at any speed.
std::string strip_of(const CellRecord& c) {
  const json s = json::parse(c.header.scenario_json, nullptr, false);
  const json grid = s.value(json::json_pointer("/cloth/grid"), json());
  return s.value("name", c.header.scene) +
         (grid.is_array() && grid.size() == 2 ? fmt::format(" {}×{}", grid[0].dump(), grid[1].dump()) : "");
}

std::vector<PulledRow> rows_of(const std::vector<ContactSetUp>& ups) {
  std::vector<PulledRow> out;
  for (const ContactSetUp& u : ups)
    for (const ContactScene& s : u.scenes)
      for (const ContactRow& r : s.rows) {
        // A cell that has not run knows no speed, one without hands says nothing.
        if (u.kind != "wave" || r.cell->header.solver == "ballistic" ||
            !(summary_value(*r.cell, "imposed_speed_m_per_s") > 0))
          continue;
        const std::string strip = strip_of(*r.cell);
        auto at = std::find_if(out.begin(), out.end(),
                               [&](const PulledRow& p) { return p.scene == strip && p.series == r.series; });
        if (at == out.end()) at = out.insert(at, {strip, r.series, {}});
        at->cells.push_back({summary_value(*r.cell, "imposed_speed_m_per_s"), r.cell});
      }
  std::stable_sort(out.begin(), out.end(), [](const PulledRow& a, const PulledRow& b) {
    return a.scene != b.scene ? a.scene < b.scene : a.series < b.series;
  });
  for (PulledRow& p : out)
    std::sort(p.cells.begin(), p.cells.end(),
              [](const Cell& a, const Cell& b) { return a.speed_m_per_s < b.speed_m_per_s; });
  return out;
}

/// Equal but for the rounding of positions.
bool same_speed(double a, double b) { return std::abs(a - b) <= 1e-6 * b; }

std::string formatted(double v, const char* form) {
  return std::isfinite(v) ? fmt::format(fmt::runtime(form), v) : "–";
}

}  // namespace

Table pulled_strip_table(const std::vector<ContactSetUp>& ups) {
  Table t{"A strip pulled at both ends against its exact wave",
          "Greatest strain along the strip less the exact one (truth card two-hand-pull, same mesh), the most of all "
          "frames, over the "
          "strain v0/c that one wave brings / RMS distance over space and time over L. Fails: the first exceeds 0.1, "
          "or is not "
          "known. The answer is proportional to v0: a solver whose first figure depends on the speed is not linear.",
          {{"strip", "solver", "first that fails"}}};
  const std::vector<PulledRow> rows = rows_of(ups);
  std::vector<double> speeds;
  for (const PulledRow& r : rows)
    for (const Cell& c : r.cells)
      if (std::none_of(speeds.begin(), speeds.end(), [&](double v) { return same_speed(v, c.speed_m_per_s); }))
        speeds.push_back(c.speed_m_per_s);
  std::sort(speeds.begin(), speeds.end());
  for (const double v : speeds) t.rows[0].push_back(fmt::format("{:g} m/s", v));
  for (const PulledRow& r : rows) {
    const Cell* fault = r.first_fault();
    std::vector<std::string> row = {r.scene, r.series.label(),
                                    fault != nullptr && leak_of("wave", *fault->cell) == "–" ? "–"
                                    : fault == nullptr
                                        ? fmt::format("none up to {:g} m/s", r.cells.back().speed_m_per_s)
                                        : fmt::format("{:g} m/s", fault->speed_m_per_s)};
    for (const double v : speeds) {
      std::string text = "–";
      for (const Cell& c : r.cells) {
        if (!same_speed(v, c.speed_m_per_s)) continue;
        text = c.cell->outcome.status != "ok"
                   ? c.cell->outcome.status
                   : formatted(summary_value(*c.cell, "truth_quantity_error_max"), "{:.2g}") + " / " +
                         formatted(summary_value(*c.cell, "truth_e2"), "{:.1e}");
      }
      row.push_back(text);
    }
    t.rows.push_back(std::move(row));
  }
  return t;
}

json pulled_strip_json(const std::vector<ContactSetUp>& ups) {
  json out = json::array();
  for (const PulledRow& r : rows_of(ups)) {
    json row = {
        {"strip", r.scene}, {"solver", r.series.solver}, {"setting", r.series.setting}, {"speeds", json::array()}};
    for (const Cell& c : r.cells)
      row["speeds"].push_back({{"speed_m_per_s", c.speed_m_per_s},
                               {"status", c.cell->outcome.status},
                               {"strain_error_max", finite_or_null(summary_value(*c.cell, "truth_quantity_error_max"))},
                               {"strain_error_rms", finite_or_null(summary_value(*c.cell, "truth_quantity_error"))},
                               {"e2", finite_or_null(summary_value(*c.cell, "truth_e2"))},
                               {"fault", leak_of("wave", *c.cell)}});
    const Cell* fault = r.first_fault();
    row["first_fault_m_per_s"] = fault == nullptr ? json() : json(fault->speed_m_per_s);
    out.push_back(std::move(row));
  }
  return out;
}

}  // namespace clothbench
