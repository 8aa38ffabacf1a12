// Numbers of the penetration tables for machines, and the series their figures are drawn from.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/json_number.hpp"
#include "metrics/registry.hpp"
#include "report/penetration.hpp"
#include "report/withheld.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

const MetricSeries* find(const CellRecord& c, const std::string& name) {
  for (const MetricSeries& m : c.accuracy.metrics)
    if (m.name == name) return &m;
  return nullptr;
}

}  // namespace

json penetration_json(const std::vector<ContactSetUp>& ups) {
  json out = json::array();
  for (const ContactSetUp& u : ups)
    for (const ContactScene& s : u.scenes)
      for (const ContactRow& r : s.rows) {
        json row = {{"set_up", u.kind},          {"scene", s.name},
                    {"solver", r.series.solver}, {"setting", r.series.setting},
                    {"sides", r.series.sides},   {"status", r.cell->outcome.status},
                    {"expect", verdict(*r.cell)}};
        if (r.cell->outcome.failed_frame >= 0) row["failed_frame"] = r.cell->outcome.failed_frame;
        for (const std::string& name : penetration_columns()) row[name] = finite_or_null(summary_value(*r.cell, name));
        if (const std::string why = withheld_of(*r.cell, penetration_columns()); !why.empty()) row["withheld"] = why;
        out.push_back(std::move(row));
      }
  return out;
}

std::string series_csv(const std::vector<ContactSetUp>& ups) {
  std::vector<std::string> head = {"set_up", "scene",  "solver",       "setting", "sides",
                                   "repeat", "status", "failed_frame", "time_s"};
  const std::vector<std::string> names = series_columns();
  head.insert(head.end(), names.begin(), names.end());
  std::string out = csv_row(head);
  for (const ContactSetUp& u : ups)
    for (const ContactScene& s : u.scenes)
      for (const ContactRow& r : s.rows) {
        const CellRecord& c = *r.cell;
        std::vector<const MetricSeries*> found;
        for (const std::string& name : names) found.push_back(find(c, name));
        for (std::size_t frame = 0; frame < c.accuracy.time_s.size(); ++frame) {
          std::vector<std::string> row = {u.kind,
                                          s.name,
                                          r.series.solver,
                                          r.series.setting,
                                          r.series.sides,
                                          std::to_string(r.series.repeat),
                                          c.outcome.status,
                                          c.outcome.failed_frame < 0 ? "" : std::to_string(c.outcome.failed_frame),
                                          fmt::format("{:.6g}", c.accuracy.time_s[frame])};
          for (const MetricSeries* m : found) {
            const double v = m != nullptr && frame < m->values.size() ? m->values[frame] : kMissing;
            row.push_back(std::isfinite(v) ? fmt::format("{:.6g}", v) : "");
          }
          out += csv_row(row);
        }
      }
  return out;
}

}  // namespace clothbench
