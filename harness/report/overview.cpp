// The first screen: four tiles, and Table 3 with errors.
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>

#include "base/interval.hpp"
#include "report/report.hpp"
#include "report/verdict.hpp"
#include "report/view.hpp"

namespace clothbench {
namespace {

constexpr double kFallLimit = 0.01;  // a greater error of free fall makes a rate meaningless
constexpr double kBudget_ms = 1;     // of wall time per frame

constexpr const char* kTable3Note =
    "Frames per second of a falling cloth, uncapped, without rendering, median of the trials; "
    "interval, ratio, rank and error are for the largest mesh. An error of free fall above 1 % (!) "
    "makes a rate meaningless. Published: Quest 3, with rendering, capped at 72. ";
/// Runs that passed, or were stable, among those that are judged.
struct Share {
  std::size_t good = 0, all = 0;
};

Share share_of(const Group& g, Part part) {
  Share out;
  for (const Row* r : g) {
    const bool stability = part == Part::Stability;
    if (r->part != part || (stability ? grade_of(*r) < 0 : r->status() == "missing" || bounds_of(*r->run) == 0))
      continue;
    ++out.all;
    out.good += stability ? grade_of(*r) == 0 : verdict(*r->run) == "pass";
  }
  return out;
}

bool is_fastest_class(const Row& r) {
  return r.part == Part::Rates && r.largest && r.published < 0 && r.setting == "default" && r.sides != "double" &&
         r.sides != "double-duplicated" && r.repeat == 1 && r.status() == "ok" && std::isfinite(r.value("fps_median"));
}

bool within_budget(const Row& r) {
  return r.part == Part::Truth && r.counts() && r.wall_ms_per_s() / r.frame_rate_hz() <= kBudget_ms;
}

/// The text of a solver's run with the largest mesh.
ViewColumn at_largest(std::string head, std::function<std::string(const Row&)> text) {
  return {std::move(head), [text = std::move(text)](const Group& g, const Texts&) {
            for (const Row* r : g)
              if (r->largest && r->status() == "ok" && r->published < 0) return text(*r);
            return std::string();
          }};
}

std::string rate_interval(const Row& r) {
  const Interval95 i = r.times->wall.rate;
  return std::isfinite(i.low) ? rate_text(i.low) + "–" + rate_text(i.high) + (r.times->wall.uncertain() ? " ~" : "")
                              : std::string();
}

/// Names of the solvers that wrap the engine of a published row.
std::string peers(const Group& runs) {
  const nlohmann::json published = published_table3();
  std::set<std::string> out;
  for (const Row* r : runs)
    for (const nlohmann::json& column : published.at("columns"))
      if (const std::string engine = engine_of(*r->run); !engine.empty() && column.value("engine", "") == engine)
        out.insert(r->label() + ": " + column.value("peer", ""));
  return joined(out, " ");
}

View speed_and_error() {
  View v{"overview", "Table 3: speed and error", std::string(kTable3Note) + kIntervalMethod, [](const Row& r) {
           const bool other_setting = r.paper_table == 3 && r.setting != "default";
           return r.part == Part::Rates && !other_setting && !is_floor(r.solver);
         }};
  v.each = [](const Row& r) {
    return r.paper_table == 3 ? "Table 3: speed and error" : "Speed and error: " + r.family;
  };
  v.order = [](const Group& g) {  // the fastest first, published values last
    double fps = 0;
    for (const Row* r : g) fps = r->published < 0 && r->largest ? r->value("fps_median") : fps;
    return g.front()->published >= 0 ? 1 : std::isfinite(fps) ? -fps : 0;
  };
  v.keys = {solver_key("solver", [](const Row& r) {
    const bool plain = r.sides.empty() || r.sides == "single" || r.published >= 0;
    return plain ? r.label() : r.label() + ", " + r.sides;
  })};
  v.across = resolution_across([](const Group& g) {
    const Row& r = *g.front();
    if (r.published >= 0) return fmt::format("{:g}", r.value("fps_at_72"));
    return r.status() == "ok" ? rate_text(r.value("fps_median")) : std::string();
  });
  v.columns = {at_largest("95 % interval", rate_interval),
               at_largest("× " + time_baseline(),
                          [](const Row& r) { return significant(r.baseline_s / r.value("frame_wall_median_s"), 3); }),
               at_largest("rank", [](const Row& r) { return r.rank > 0 ? std::to_string(r.rank) : std::string(); }),
               at_largest("free-fall error",
                          [](const Row& r) {
                            const double e = r.value("free_fall_error");
                            return std::isfinite(e) ? fmt::format("{:.1e}{}", e, e > kFallLimit ? " !" : "")
                                                    : std::string();
                          }),
               at_largest("trials", [](const Row& r) { return trials_column().text({&r}, {}); })};
  v.more = peers;
  v.timed = true;
  return v;
}

/// A solver's value in a tile; the value with the highest merit is shown.
struct Entry {
  std::string solver;
  double merit;
  Tile tile;            ///< without `others`
  std::string shorter;  ///< as one of the others
};

bool takes_part(const Row& r) { return !is_floor(r.solver) && !is_baseline(r.solver); }

std::vector<Entry> rates(const RunTable& table) {
  std::vector<Entry> out;
  std::string family;  // the first one that was timed
  for (const Row& r : table.rows()) {
    if (!takes_part(r) || !is_fastest_class(r) || (!family.empty() && r.family != family)) continue;
    family = r.family;
    const std::string interval = rate_interval(r);
    const std::size_t trials = r.run->trials.size();
    out.push_back(
        {r.solver,
         r.value("fps_median"),
         {"Frames per second at " + r.resolution.label(), rate_text(r.value("fps_median")),
          interval + fmt::format("{}{} trial{}", interval.empty() ? "" : ", ", trials, trials == 1 ? "" : "s"), ""},
         rate_with_interval(r)});
  }
  return out;
}

std::vector<Entry> errors(const RunTable& table) {
  std::vector<Entry> out;
  std::string scene;  // the first one that ranks solvers
  for (const Row& r : table.rows()) {
    if (!takes_part(r) || !within_budget(r) || !r.truth->refused().empty() || (!scene.empty() && r.scene != scene))
      continue;
    scene = r.scene;
    const double floor = r.truth->rank_floor();
    const bool at_floor = r.error() <= floor;
    const std::string text = fmt::format("{}{:.2g} %", at_floor ? "≤ " : "", 100 * std::max(floor, r.error()));
    out.push_back({r.solver,
                   -r.error(),
                   {"Smallest error within 1 ms per frame", text, r.scene + (at_floor ? ", at the floor" : ""), ""},
                   text});
  }
  return out;
}

std::vector<Entry> shares(const RunTable& table, Part part, const char* title) {
  std::map<std::string, Group> solvers;
  for (const Row& r : table.rows())
    if (r.setting == "default" && takes_part(r)) solvers[r.solver].push_back(&r);
  std::vector<Entry> out;
  for (const auto& [solver, runs] : solvers) {
    const Share s = share_of(runs, part);
    if (s.all == 0) continue;
    const Interval i = wilson_95(s.good, s.all);
    const auto all = static_cast<double>(s.all);
    out.push_back(
        {solver,
         static_cast<double>(s.good) / all + 1e-9 * all,  // of equal shares, the one of more runs
         {title, fmt::format("{} / {}", s.good, s.all), fmt::format("{:.0f}–{:.0f} %", 100 * i.low, 100 * i.high), ""},
         fmt::format("{}/{}", s.good, s.all)});
  }
  return out;
}

}  // namespace

std::vector<View> overview_views() { return {speed_and_error()}; }

std::vector<Tile> tiles_of(const RunTable& table) {
  constexpr std::size_t kMostTiles = 4, kMostOthers = 3;
  std::vector<Tile> out;
  for (std::vector<Entry> entries :
       {rates(table), errors(table), shares(table, Part::Generated, "Generated contact scenes passed"),
        shares(table, Part::Contact, "Contact scenes passed"), shares(table, Part::Stability, "Hard cases stable")}) {
    if (entries.empty() || out.size() == kMostTiles) continue;
    std::stable_sort(entries.begin(), entries.end(), [](auto& a, auto& b) { return a.merit > b.merit; });
    std::set<std::string> others;
    Tile& tile = out.emplace_back(entries.front().tile);
    tile.title += ", " + entries.front().solver;
    for (const Entry& e : entries)
      if (e.solver != entries.front().solver && others.size() < kMostOthers && others.insert(e.solver).second)
        tile.others += (tile.others.empty() ? "" : " · ") + e.solver + " " + e.shorter;
  }
  return out;
}

}  // namespace clothbench
