#include "report/in_short.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "report/grid.hpp"
#include "report/plugin_marks.hpp"
#include "report/verdict.hpp"
#include "report/withheld.hpp"

namespace clothbench {
namespace {

constexpr double kTornApart = 1;  // edges of twice their length

struct Row {
  const RunRecord* run;
  double frame_s = kMissing, spread_s = kMissing;  ///< median and half the range of the trials' means
  double stretch = kMissing;                       ///< greatest strain of a structural edge in the last second
  double fastest_s = kMissing;                     ///< frame_s of its scene's first run
  /// Whether its time may be compared: it ended well, and its cloth is not torn apart.
  bool ranked() const {
    return std::isfinite(frame_s) && run->outcome.status == "ok" && verdict(*run) != "fail" && !(stretch > kTornApart);
  }
};

Row row_of(const RunRecord& c) {
  const std::vector<double> means = trial_means(c);
  const double stretch = summary_value(c, "stretch_max_last_second");
  if (means.empty()) return {&c, kMissing, kMissing, stretch};
  return {&c, middle(means), means.size() > 1 ? (means.back() - means.front()) / 2 : kMissing, stretch};
}

std::string ended(const RunRecord& c) {
  const std::string v = verdict(c);
  return v == "–" ? c.outcome.status : v;
}

}  // namespace

Table in_short_table(const std::vector<RunRecord>& runs) {
  std::map<std::string, std::vector<Row>> scenes;
  for (const RunRecord& c : runs) scenes[c.header.scene].push_back(row_of(c));
  std::vector<Row> all;
  for (auto& [scene, rows] : scenes) {
    std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
      if (a.ranked() != b.ranked()) return a.ranked();
      return a.frame_s < b.frame_s || (std::isnan(b.frame_s) && !std::isnan(a.frame_s));
    });
    for (Row& r : rows) {
      r.fastest_s = rows.front().frame_s;
      all.push_back(r);
    }
  }
  const std::vector<const RunRecord*> beside = runs_of(runs, [](const RunRecord& c) { return &c; });
  const auto time = [&](const Row& r) {
    std::string text = significant(1e3 * r.frame_s, 3);
    if (std::isfinite(r.spread_s)) text += " ± " + significant(1e3 * r.spread_s, 2);
    return std::isfinite(r.frame_s) ? text + frames_mark(*r.run, beside) : text;
  };
  const Columns<Row> columns = {{"", "scene", [](auto& r) { return r.run->header.scene; }},
                                {"", "solver", [](auto& r) { return r.run->header.solver; }},
                                {"", "setting", [](auto& r) { return r.run->header.setting; }},
                                {"", "outcome", [](auto& r) { return ended(*r.run); }},
                                {"", "stretch", &Row::stretch, digits(3), {"%", 100}},
                                {"", "frame [ms]", time},
                                {"", "relative to the fastest", [](auto& r) {
                                   return r.ranked()                 ? significant(r.frame_s / r.fastest_s, 3) + "×"
                                          : std::isfinite(r.frame_s) ? "not ranked"
                                                                     : "–";
                                 }}};
  const char* note =
      "Frame: wall time, median of the trials' means ± half their range. Outcome: how the run ended, or the "
      "verdict on the scene's bounds; ignored: they hold, but the solver ignores all contact. Stretch: greatest strain "
      "of a structural edge in the last second. "
      "Not ranked: runs that failed, and cloths with an edge of more than twice its length.";
  return PluginMarks(runs).table(
      columns.table({"In short", with_withheld(note, beside, {"frame_wall_median_s"}), {}}, all));
}

}  // namespace clothbench
