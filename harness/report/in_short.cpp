#include "report/in_short.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "report/grid.hpp"
#include "report/withheld.hpp"

namespace clothbench {
namespace {

struct Row {
  const RunRecord* run;
  double frame_s = kMissing, spread_s = kMissing;  ///< median and half the range of the trials' means
};

Row row_of(const RunRecord& c) {
  const std::vector<double> means = trial_means(c);
  if (means.empty()) return {&c};
  return {&c, middle(means), means.size() > 1 ? (means.back() - means.front()) / 2 : kMissing};
}

std::string ended(const Outcome& o) {
  if (o.status != "ok") return o.failed_frame >= 0 ? fmt::format("{} in frame {}", o.status, o.failed_frame) : o.status;
  return o.expect.empty() ? "ok" : o.expect.substr(0, o.expect.find(':'));
}

}  // namespace

Table in_short_table(const std::vector<RunRecord>& runs) {
  std::map<std::string, std::vector<Row>> scenes;
  for (const RunRecord& c : runs) scenes[c.header.scene].push_back(row_of(c));
  Table t{"In short",
          "Wall time of a frame: median of the trials' means ± half their range. Ended: ok, or whether the scene's "
          "expectations passed.",
          {{"scene", "solver", "setting", "outcome", "frame [ms]", "against the fastest"}}};
  t.note = with_withheld(t.note, runs_of(runs, [](const RunRecord& c) { return &c; }), {"frame_wall_median_s"});
  for (auto& [scene, rows] : scenes) {
    std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
      return a.frame_s < b.frame_s || (std::isnan(b.frame_s) && !std::isnan(a.frame_s));
    });
    const double fastest = rows.front().frame_s;
    for (const Row& r : rows) {
      std::string time = significant(1e3 * r.frame_s, 3);
      if (std::isfinite(r.spread_s)) time += " ± " + significant(1e3 * r.spread_s, 2);
      t.rows.push_back({scene, r.run->header.solver, r.run->header.setting, ended(r.run->outcome), time,
                        std::isfinite(r.frame_s) ? significant(r.frame_s / fastest, 3) + "×" : "–"});
    }
  }
  return t;
}

}  // namespace clothbench
