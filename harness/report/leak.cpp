#include "report/leak.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "report/roles.hpp"
#include "report/withheld.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr std::size_t kLeastSpeeds = 3;

/// Text for failed bounds, in order of priority; other names are printed as they are.
constexpr std::pair<const char*, const char*> kWords[] = {{"crossings_max", "crossings"},
                                                          {"depth_max_m", "inside [m]"},
                                                          {"grip_edge_ratio_max", "edge pulled"},
                                                          {"strain_mean_released", "strain left"},
                                                          {"truth_quantity_error", "strain off [v0/c]"},
                                                          {"pop_max_m", "popping [m]"},
                                                          {"contact_length_settled_m", "contour left [m]"}};

std::size_t place(const std::string& name) {
  const auto at = std::find_if(std::begin(kWords), std::end(kWords), [&](const auto& w) { return name == w.first; });
  return static_cast<std::size_t>(at - std::begin(kWords));
}

std::string failure_text(const RunRecord& c, const std::string& name) {
  const std::string what = place(name) < std::size(kWords) ? kWords[place(name)].second : name;
  const double v = summary_value(c, name);
  return what + (std::isfinite(v) ? fmt::format(" {:.3g}", v) : " not known");
}

/// The first failed bound of the scene, as text.
std::string broken_bound(const RunRecord& c, std::vector<BoundResult> bounds) {
  std::stable_sort(bounds.begin(), bounds.end(),
                   [](const auto& a, const auto& b) { return place(a.name) < place(b.name); });
  for (const BoundResult& b : bounds)
    if (b.passed == 0) return failure_text(c, b.name);
  for (const BoundResult& b : bounds)
    if (!(b.passed == 1)) return c.withheld.contains("expect." + b.name) ? kNotPrinted : failure_text(c, b.name);
  return "";
}

/// For a scene without bounds: what counts as a failure in a scene of its kind.
std::string without_bounds(const std::string& kind, const RunRecord& c) {
  std::vector<std::pair<const char*, double>> most;
  if (kind == "rooms")
    most = {{"crossings_max", 0}};
  else if (kind == "grip")
    most = {{"grip_edge_ratio_max", 2}};
  else
    most = {{"crossings_max", 0}, {"depth_max_m", 1e-3}};
  for (const auto& [name, at_most] : most) {
    if (c.withheld.contains(name)) return kNotPrinted;
    if (!(summary_value(c, name) <= at_most)) return failure_text(c, name);
  }
  return "";
}

std::string failure_speed_text(const SpeedSweep& s) {
  const auto leak = s.failure_speed();
  if (!leak) return fmt::format("none up to {:g} m/s", s.speeds.back().speed_m_per_s);
  return leak->leak == kNotPrinted ? kNotPrinted : fmt::format("{:g} m/s: {}", leak->speed_m_per_s, leak->leak);
}

}  // namespace

std::string leak_of(const std::string& kind, const RunRecord& c) {
  if (c.outcome.status != "ok") return c.outcome.status;
  const std::vector<BoundResult> bounds = bound_results(c);
  return bounds.empty() ? without_bounds(kind, c) : broken_bound(c, bounds);
}

std::optional<SpeedSweep::At> SpeedSweep::failure_speed() const {
  const auto at = std::find_if(speeds.begin(), speeds.end(), [](const At& a) { return !a.leak.empty(); });
  return at == speeds.end() ? std::nullopt : std::optional<At>(*at);
}

std::size_t SpeedSweep::paths() const {
  std::size_t least = speeds.size();
  for (const At& at : speeds) {
    const auto same = [&](const At& other) { return other.speed_m_per_s == at.speed_m_per_s; };
    least = std::min(least, static_cast<std::size_t>(std::count_if(speeds.begin(), speeds.end(), same)));
  }
  return least;
}

std::vector<SpeedSweep> speed_sweeps(const std::vector<ContactSetUp>& ups) {
  std::vector<SpeedSweep> all;
  for (const ContactRow& r : contact_rows(ups)) {
    const double speed = summary_value(*r.run, "imposed_speed_m_per_s");
    const std::string& status = r.run->outcome.status;
    if (!(speed > 0) || status == "unsupported" || status == "over_budget" || verdict(*r.run) == "ignored" ||
        is_floor(r.run->header.solver))
      continue;
    const std::string base = base_name(*r.run);
    SpeedSweep& at = find_or_add(
        all, [&](const SpeedSweep& x) { return x.kind == r.kind && x.scene == base && x.series == r.series; },
        {r.kind, base, r.series, {}});
    at.speeds.push_back({speed, leak_of(r.kind, *r.run)});
    at.runs.push_back(r);
  }
  for (SpeedSweep& s : all)
    std::stable_sort(s.speeds.begin(), s.speeds.end(),
                     [](const auto& a, const auto& b) { return a.speed_m_per_s < b.speed_m_per_s; });
  std::erase_if(all, [](const SpeedSweep& s) {
    return s.speeds.size() < kLeastSpeeds || !(s.speeds.front().speed_m_per_s < s.speeds.back().speed_m_per_s);
  });
  return all;
}

Table leak_table(const std::vector<SpeedSweep>& sweeps) {
  std::vector<std::string> solvers = distinct(sweeps, [](const SpeedSweep& s) { return s.series.label(); });
  std::sort(solvers.begin(), solvers.end());
  std::vector<ContactRow> all;
  for (const SpeedSweep& s : sweeps) all.insert(all.end(), s.runs.begin(), s.runs.end());
  std::vector<TextRow> rows = {held_row(all)};
  if (rows.front().cells.empty()) rows.clear();
  for (const auto& [kind, scene] : distinct(sweeps, [](const SpeedSweep& s) { return std::pair(s.kind, s.scene); })) {
    TextRow row{fmt::format("{} ({})", scene, kind)};
    for (const std::string& solver : solvers)
      for (const SpeedSweep& s : sweeps) {
        if (s.kind != kind || s.scene != scene || s.series.label() != solver) continue;
        row.more = {fmt::format("{:g}…{:g}", s.speeds.front().speed_m_per_s, s.speeds.back().speed_m_per_s),
                    std::to_string(s.paths())};
        row.cells[solver] = failure_speed_text(s);
      }
    rows.push_back(std::move(row));
  }
  std::vector<std::string> names;
  for (const auto& [name, unused] : kWords) names.emplace_back(name);
  return text_columns({"scene", "speeds [m/s]", "paths"}, solvers)
      .table({"Failure speed",
              with_withheld(
                  "Failure speed: the lowest speed at which a solver fails a bound of the scene's `expect`. The table "
                  "names the first bound that fails: crossings; cloth more than 1 mm inside a collider; edges longer "
                  "than the stated multiple of what the hands impose; a "
                  "mean strain above 1 % one second after release; popping; a greatest strain of "
                  "a pulled strip more than 0.1 v0/c from its exact wave. The verdicts above use the same bounds. "
                  "none: no failure up to the greatest speed that was run. Paths: scenes that were run at each speed. "
                  "What holds "
                  "on one path may fail on another; the study `contact` draws many.",
                  runs_of(all, &ContactRow::run), names),
              {}},
             rows);
}

json leak_json(const std::vector<SpeedSweep>& sweeps) {
  json out = json::array();
  for (const SpeedSweep& s : sweeps) {
    json row = {{"set_up", s.kind},          {"scene", s.scene},
                {"solver", s.series.solver}, {"setting", s.series.setting},
                {"sides", s.series.sides},   {"speeds", json::array()}};
    for (const auto& at : s.speeds) row["speeds"].push_back({{"speed_m_per_s", at.speed_m_per_s}, {"leak", at.leak}});
    const auto leak = s.failure_speed();
    row["failure_speed_m_per_s"] = leak && leak->leak != kNotPrinted ? json(leak->speed_m_per_s) : json();
    row["paths"] = s.paths();
    row["known"] = !leak || leak->leak != kNotPrinted;
    out.push_back(std::move(row));
  }
  return out;
}

}  // namespace clothbench
