#include "report/leak.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace clothbench {
namespace {

using nlohmann::json;

constexpr double kInside_m = 1e-3;
constexpr double kPulled = 1.25, kHeld = 1.10, kReleased = 0.01;
constexpr double kWave = 0.1;
constexpr std::size_t kLeastSpeeds = 3;

struct Bound {
  const char* name;
  double at_most;
  const char* text;
};

/// Written so that NaN is beyond it.
std::string beyond(const CellRecord& c, std::initializer_list<Bound> bounds) {
  for (const Bound& b : bounds) {
    const double v = summary_value(c, b.name);
    if (!(v <= b.at_most)) return std::isfinite(v) ? fmt::format("{} {:.3g}", b.text, v) : std::string(b.text) + " not known";
  }
  return "";
}

std::string base_name(const CellRecord& c) {
  const json j = json::parse(c.header.scenario_json, nullptr, false);
  return j.is_object() && j.contains("name") && j["name"].is_string() ? j["name"].get<std::string>() : c.header.scene;
}

std::string metres_per_second(double v) { return fmt::format("{:g} m/s", v); }

}  // namespace

std::string leak_of(const std::string& kind, const CellRecord& c) {
  if (c.outcome.status != "ok") return c.outcome.status;
  if (kind == "rooms") return beyond(c, {{"tunnelled_fraction_max", 0, "tunnelled"}});
  if (kind == "capsules" || kind == "hand")
    return beyond(c, {{"wrong_side_samples_max", 0, "wrong side"}, {"depth_vertex_max_m", kInside_m, "inside [m]"}});
  if (kind == "grip")
    return beyond(c, {{"grip_edge_ratio_max", kPulled, "edge pulled"}, {"grip_edge_ratio_held", kHeld, "edge held"},
                      {"strain_mean_released", kReleased, "strain left"}});
  if (kind == "wave") return beyond(c, {{"truth_quantity_error_max", kWave, "strain off [v0/c]"}});
  return beyond(c, {{"depth_vertex_max_m", kInside_m, "inside [m]"}});
}

std::optional<SpeedSweep::At> SpeedSweep::first_leak() const {
  const auto at = std::find_if(speeds.begin(), speeds.end(), [](const At& a) { return !a.leak.empty(); });
  return at == speeds.end() ? std::nullopt : std::optional<At>(*at);
}

std::vector<SpeedSweep> speed_sweeps(const std::vector<ContactSetUp>& ups) {
  std::vector<SpeedSweep> all;
  for (const ContactSetUp& u : ups)
    for (const ContactScene& s : u.scenes)
      for (const ContactRow& r : s.rows) {
        const double speed = summary_value(*r.cell, "imposed_speed_m_per_s");
        const std::string &status = r.cell->outcome.status, seen = verdict(*r.cell);
        if (!(speed > 0) || status == "unsupported" || status == "over_budget" || seen == "ignored" || r.cell->header.solver == "ballistic") continue;
        const std::string base = base_name(*r.cell);
        auto at = std::find_if(all.begin(), all.end(), [&](const SpeedSweep& x) { return x.kind == u.kind && x.scene == base && x.series == r.series; });
        if (at == all.end()) at = all.insert(all.end(), {u.kind, base, r.series, {}});
        at->speeds.push_back({speed, leak_of(u.kind, *r.cell)});
      }
  for (SpeedSweep& s : all) std::stable_sort(s.speeds.begin(), s.speeds.end(), [](const auto& a, const auto& b) { return a.speed_m_per_s < b.speed_m_per_s; });
  std::erase_if(all, [](const SpeedSweep& s) { return s.speeds.size() < kLeastSpeeds || !(s.speeds.front().speed_m_per_s < s.speeds.back().speed_m_per_s); });
  return all;
}

Table leak_table(const std::vector<SpeedSweep>& sweeps) {
  Table t{"Speed of the first leak",
          "The lowest speed at which cloth is through a mesh, on the wrong side of a hand or over 1 mm inside it, or an edge is "
          "longer than 1.25 times what the hands impose (1.10 times once they hold; mean strain of 1 % a second after they let go), or "
          "the greatest strain of a strip pulled by bars is off its exact wave by over a tenth of v0/c in any frame. none: up to the greatest speed that was run.",
          {{"scene", "speeds [m/s]"}}};
  std::vector<std::string> solvers;
  for (const SpeedSweep& s : sweeps)
    if (std::find(solvers.begin(), solvers.end(), s.series.label()) == solvers.end()) solvers.push_back(s.series.label());
  std::sort(solvers.begin(), solvers.end());
  t.rows[0].insert(t.rows[0].end(), solvers.begin(), solvers.end());
  std::vector<std::pair<std::string, std::string>> rows;
  for (const SpeedSweep& s : sweeps)
    if (std::find(rows.begin(), rows.end(), std::pair(s.kind, s.scene)) == rows.end()) rows.emplace_back(s.kind, s.scene);
  for (const auto& [kind, scene] : rows) {
    std::vector<std::string> row = {fmt::format("{} ({})", scene, kind), "–"};
    for (const std::string& solver : solvers) {
      std::string text = "–";
      for (const SpeedSweep& s : sweeps) {
        if (s.kind != kind || s.scene != scene || s.series.label() != solver) continue;
        row[1] = fmt::format("{:g}…{:g}", s.speeds.front().speed_m_per_s, s.speeds.back().speed_m_per_s);
        const auto leak = s.first_leak();
        text = leak ? metres_per_second(leak->speed_m_per_s) + ": " + leak->leak : "none up to " + metres_per_second(s.speeds.back().speed_m_per_s);
      }
      row.push_back(text);
    }
    t.rows.push_back(std::move(row));
  }
  return t;
}

json leak_json(const std::vector<SpeedSweep>& sweeps) {
  json out = json::array();
  for (const SpeedSweep& s : sweeps) {
    json row = {{"set_up", s.kind}, {"scene", s.scene}, {"solver", s.series.solver}, {"setting", s.series.setting}, {"sides", s.series.sides}, {"speeds", json::array()}};
    for (const auto& at : s.speeds) row["speeds"].push_back({{"speed_m_per_s", at.speed_m_per_s}, {"leak", at.leak}});
    const auto leak = s.first_leak();
    row["first_leak_m_per_s"] = leak ? json(leak->speed_m_per_s) : json();
    out.push_back(std::move(row));
  }
  return out;
}

}  // namespace clothbench
