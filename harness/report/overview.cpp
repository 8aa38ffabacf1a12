// The first screen: what the report is about, four tiles, Table 3 with errors, and all solvers in one table.
#include "report/overview.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>

#include "base/interval.hpp"
#include "report/verdict.hpp"

namespace clothbench {
namespace {

constexpr double kFallLimit = 0.01;   // a greater error of free fall makes a rate meaningless
constexpr double kBudget_ms = 1;      // of wall time per frame
constexpr double kSmallError = 0.01;  // of the reference case's scale

constexpr const char* kTable3Note =
    "Frames per second of a falling cloth, uncapped, without rendering, median of the trials; "
    "interval, ratio, rank and error are for the largest mesh. An error of free fall above 1 % (!) "
    "makes a rate meaningless. Published: Quest 3, with rendering, capped at 72. ";
constexpr const char* kAllSolversNote =
    "Frames per second: the largest mesh of the first scene of that kind, default setting. Scenes below 1 %: "
    "reference cases in which some setting has an error below 0.01 of the case's scale and takes at most 1 ms of "
    "wall time per frame. Passed: runs that meet every acceptance criterion of their scene, with the 95 % interval "
    "of the probability (Wilson); unsupported counts as not passed. CPU threads: CPU time over wall time.";

bool judged(const Row& r, Part part) {
  return r.part == part && r.status() != "missing" && bounds_of(*r.run) > 0 && r.published < 0;
}

bool passed(const Row& r) { return verdict(*r.run) == "pass"; }

bool is_fastest_class(const Row& r) {
  return r.part == Part::Rates && r.largest && r.published < 0 && r.setting == "default" && r.sides != "double" &&
         r.sides != "double-duplicated" && r.repeat == 1 && r.status() == "ok" && std::isfinite(r.value("fps_median"));
}

bool within_budget(const Row& r) {
  return r.part == Part::Truth && r.counts() && r.wall_ms_per_s() / r.frame_rate_hz() <= kBudget_ms;
}

View speed_and_error() {
  View v{"overview", "Table 3: speed and error", std::string(kTable3Note) + kIntervalMethod, [](const Row& r) {
           return r.part == Part::Rates && r.paper_table == 3 && r.setting == "default" && !is_floor(r.solver);
         }};
  v.order = [](const Group& g) {  // the fastest first, published values last
    double fps = 0;
    for (const Row* r : g) fps = r->published < 0 && r->largest ? r->value("fps_median") : fps;
    return g.front()->published >= 0 ? 1 : std::isfinite(fps) ? -fps : 0;
  };
  v.keys = {key("solver", [](const Row& r) {
    const bool plain = r.sides.empty() || r.sides == "single" || r.published >= 0;
    return plain ? r.label() : r.label() + ", " + r.sides;
  })};
  v.keys[0].is_solver = true;
  v.across = {key("", [](const Row& r) { return r.resolution.label(); }),
              [](const Group& g) {
                const Row& r = *g.front();
                if (r.published >= 0) return fmt::format("{:g}", r.value("fps_at_72"));
                return r.status() == "ok" ? rate_text(r.value("fps_median")) : std::string();
              },
              [](const Row& r) { return r.resolution.size(); },
              {},
              [](const Group& g) { return g.front()->status() == "ok" ? "" : ending(g.front()->run->outcome); }};
  const auto at_largest = [](const char* head, std::function<std::string(const Row&)> text) {
    return ViewColumn{head, [text](const Group& g, const Texts&) {
                        for (const Row* r : g)
                          if (r->largest && r->status() == "ok" && r->published < 0) return text(*r);
                        return std::string();
                      }};
  };
  v.columns = {at_largest("95 % interval",
                          [](const Row& r) {
                            const Interval95 i = r.times->rate;
                            return std::isfinite(i.low)
                                       ? rate_text(i.low) + "–" + rate_text(i.high) + (r.times->uncertain() ? " ~" : "")
                                       : std::string();
                          }),
               {"× " + time_baseline(),
                [at_largest](const Group& g, const Texts& keys) {
                  return at_largest("",
                                    [](const Row& r) {
                                      const double wall_s = r.value("frame_wall_median_s");
                                      return significant(r.baseline_s / wall_s, 3);
                                    })
                      .text(g, keys);
                }},
               at_largest("rank", [](const Row& r) { return r.rank > 0 ? std::to_string(r.rank) : std::string(); }),
               at_largest("free-fall error",
                          [](const Row& r) {
                            const double e = r.value("free_fall_error");
                            return std::isfinite(e) ? fmt::format("{:.1e}{}", e, e > kFallLimit ? " !" : "")
                                                    : std::string();
                          }),
               at_largest("trials", [](const Row& r) {
                 return r.run->trials.empty() ? std::string() : std::to_string(r.run->trials.size());
               })};
  v.timed = true;
  return v;
}

std::string share_of(const Group& g, const std::function<bool(const Row&)>& among,
                     const std::function<bool(const Row&)>& is) {
  std::size_t all = 0, good = 0;
  for (const Row* r : g)
    if (among(*r)) {
      ++all;
      good += is(*r);
    }
  return share_text(good, all);
}

/// Distinct values among the runs of a solver.
std::string values_of(const Group& g, const std::function<std::string(const Row&)>& of) {
  std::set<std::string> all;
  for (const Row* r : g)
    if (const std::string text = of(*r); !text.empty()) all.insert(text);
  return joined(all, ", ", [](const std::string& t) { return t; });
}

std::string device_of(const Row& r) {
  const nlohmann::json gpu = environment_of(*r.run, "gpu");
  return !gpu.is_string() || r.status() != "ok" ? "" : gpu_of(*r.run).empty() ? "CPU" : gpu.get<std::string>();
}

std::string precision_of(const Row& r) {
  const nlohmann::json e = environment_of(*r.run, "precision");
  return e.is_string() ? e.get<std::string>() : "";
}

/// Median over the runs: a single short run counts other work of the machine.
std::string threads_of(const Group& g) {
  std::vector<double> all;
  for (const Row* r : g)
    if (std::isfinite(r->times->threads)) all.push_back(r->times->threads);
  std::sort(all.begin(), all.end());
  return all.empty() ? "" : significant(quantile(all, 0.5), 1);
}

View all_solvers() {
  View v{"overview", "All solvers in one table", kAllSolversNote,
         [](const Row& r) { return r.published < 0 && r.part != Part::None; }};
  Key solver = key("solver", [](const Row& r) { return r.solver; });
  solver.is_solver = true;
  v.keys = {solver};
  v.by_key = true;
  const auto of = [](const char* head, auto text) {
    return ViewColumn{head, [text](const Group& g, const Texts&) { return text(g); }};
  };
  const auto in_part = [](Part part) { return [part](const Row& r) { return judged(r, part); }; };
  v.columns = {
      of("frames/s, largest mesh",
         [](const Group& g) {
           for (const Row* r : g)
             if (is_fastest_class(*r)) return rate_with_interval(*r);
           return std::string();
         }),
      of("scenes below 1 % within 1 ms",
         [](const Group& g) {
           std::map<std::string, bool> scenes;
           for (const Row* r : g)
             if (r->part == Part::Truth)
               scenes[r->scene] = scenes[r->scene] || (within_budget(*r) && r->error() <= kSmallError);
           const auto good = std::count_if(scenes.begin(), scenes.end(), [](auto& s) { return s.second; });
           return scenes.empty() ? std::string() : fmt::format("{} of {}", good, scenes.size());
         }),
      of("contact scenes passed", [in_part](const Group& g) { return share_of(g, in_part(Part::Contact), passed); }),
      of("generated contact passed",
         [in_part](const Group& g) { return share_of(g, in_part(Part::Generated), passed); }),
      of("stable",
         [](const Group& g) {
           return share_of(
               g, [](const Row& r) { return grade_of(r) >= 0; }, [](const Row& r) { return grade_of(r) == 0; });
         }),
      of("trials",
         [](const Group& g) {
           return values_of(g, [](const Row& r) {
             return r.run->trials.empty() ? std::string() : std::to_string(r.run->trials.size());
           });
         }),
      of("precision", [](const Group& g) { return values_of(g, precision_of); }),
      of("CPU threads", threads_of),
      of("device", [](const Group& g) { return values_of(g, device_of); })};
  v.timed = true;
  return v;
}

/// Solvers that take part in a comparison, by the value of `of`, best first. Each solver's best row.
std::vector<std::pair<double, const Row*>> best_rows(const RunTable& table, const std::function<bool(const Row&)>& when,
                                                     const std::function<double(const Row&)>& of) {
  std::vector<std::pair<double, const Row*>> out;
  for (const Row& r : table.rows()) {
    if (!when(r) || is_floor(r.solver) || is_baseline(r.solver) || !std::isfinite(of(r))) continue;
    auto& entry = find_or_add(out, [&](auto& e) { return e.second->solver == r.solver; }, {of(r), &r});
    if (of(r) < entry.first) entry = {of(r), &r};
  }
  std::stable_sort(out.begin(), out.end(), [](auto& a, auto& b) { return a.first < b.first; });
  return out;
}

std::string others(const std::vector<std::pair<double, const Row*>>& best,
                   const std::function<std::string(const Row&)>& text) {
  std::string out;
  for (std::size_t k = 1; k < std::min<std::size_t>(best.size(), 4); ++k)
    out += (k > 1 ? " · " : "") + best[k].second->solver + " " + text(*best[k].second);
  return out;
}

void add_rate_tile(const RunTable& table, std::vector<Tile>& out) {
  std::string family;
  const auto best = best_rows(
      table,
      [&](const Row& r) {
        if (!is_fastest_class(r) || (!family.empty() && r.family != family)) return false;
        family = r.family;
        return true;
      },
      [](const Row& r) { return -r.value("fps_median"); });
  if (best.empty()) return;
  const Row& r = *best.front().second;
  const Interval95 i = r.times->rate;
  out.push_back({fmt::format("Frames per second at {}, {}", r.resolution.label(), r.solver),
                 rate_text(r.value("fps_median")),
                 (std::isfinite(i.low) ? rate_text(i.low) + "–" + rate_text(i.high) + ", " : "") +
                     fmt::format("{} trial{}", r.run->trials.size(), r.run->trials.size() == 1 ? "" : "s"),
                 others(best, [](const Row& o) { return rate_with_interval(o); })});
}

void add_error_tile(const RunTable& table, std::vector<Tile>& out) {
  std::string scene;
  const auto best = best_rows(
      table,
      [&](const Row& r) {
        if (!within_budget(r) || !r.truth->refused().empty() || (!scene.empty() && r.scene != scene)) return false;
        scene = r.scene;
        return true;
      },
      &Row::error);
  if (best.empty()) return;
  const auto text = [](const Row& r) {
    const double floor = r.truth->rank_floor();
    return r.error() <= floor ? fmt::format("≤ {:.2g} %", 100 * floor) : fmt::format("{:.2g} %", 100 * r.error());
  };
  const Row& r = *best.front().second;
  out.push_back({fmt::format("Smallest error within 1 ms per frame, {}", r.solver), text(r),
                 r.scene + (r.error() <= r.truth->rank_floor() ? ", at the floor" : ""), others(best, text)});
}

void add_share_tile(const RunTable& table, Part part, const char* title, std::vector<Tile>& out) {
  std::map<std::string, std::pair<std::size_t, std::size_t>> counts;  // passed, all
  for (const Row& r : table.rows()) {
    const bool counts_here = part == Part::Stability ? grade_of(r) >= 0 : judged(r, part);
    if (!counts_here || is_floor(r.solver) || is_baseline(r.solver) || r.setting != "default") continue;
    auto& [good, all] = counts[r.solver];
    good += part == Part::Stability ? grade_of(r) == 0 : passed(r);
    ++all;
  }
  std::vector<std::pair<std::string, std::pair<std::size_t, std::size_t>>> best(counts.begin(), counts.end());
  const auto share = [](auto& c) { return static_cast<double>(c.second.first) / static_cast<double>(c.second.second); };
  std::stable_sort(best.begin(), best.end(), [&](auto& a, auto& b) {
    return share(a) > share(b) || (share(a) == share(b) && a.second.second > b.second.second);
  });
  if (best.empty()) return;
  std::string more;
  for (std::size_t k = 1; k < std::min<std::size_t>(best.size(), 5); ++k)
    more += fmt::format("{}{} {}/{}", k > 1 ? " · " : "", best[k].first, best[k].second.first, best[k].second.second);
  const auto [good, all] = best.front().second;
  const Interval i = wilson_95(good, all);
  out.push_back({fmt::format("{}, {}", title, best.front().first), fmt::format("{} / {}", good, all),
                 fmt::format("{:.0f}–{:.0f} %", 100 * i.low, 100 * i.high), more});
}

}  // namespace

std::vector<View> overview_views() { return {speed_and_error(), all_solvers()}; }

std::vector<Tile> tiles_of(const RunTable& table) {
  std::vector<Tile> out;
  add_rate_tile(table, out);
  add_error_tile(table, out);
  add_share_tile(table, Part::Generated, "Generated contact scenes passed", out);
  add_share_tile(table, Part::Contact, "Contact scenes passed", out);
  add_share_tile(table, Part::Stability, "Hard cases stable", out);
  if (out.size() > 4) out.resize(4);
  return out;
}

Heading heading_of(const RunTable& table, const std::vector<std::string>& studies) {
  std::set<std::string> gpus, drivers, cpus, commits, trials, days;
  bool software = false;
  for (const RunRecord& c : table.runs()) {
    const auto text = [&](const char* name) {
      const nlohmann::json e = environment_of(c, name);
      return e.is_string() ? e.get<std::string>() : std::string();
    };
    const auto add = [](std::set<std::string>& to, const std::string& t) {
      if (!t.empty()) to.insert(t);
    };
    if (!gpu_of(c).empty()) {
      add(gpus, text("gpu"));
      add(drivers, text("driver"));
      software = software || environment_of(c, "gpu_is_software") == nlohmann::json(true);
    }
    add(cpus, text("cpu"));
    add(commits, text("git_commit").substr(0, 12));
    add(days, text("created").substr(0, 10));
    if (!c.trials.empty()) trials.insert(std::to_string(c.trials.size()));
  }
  const auto list = [](const std::set<std::string>& all) {
    return joined(all, ", ", [](const std::string& t) { return t; });
  };
  Heading h;
  const std::string what = studies.empty() ? "runs" : joined(studies, ", ", [](const std::string& s) { return s; });
  std::set<std::string> short_names;  // "llvmpipe" of "llvmpipe (LLVM 15.0.6, 256 bits)"
  for (const std::string& gpu : gpus) short_names.insert(gpu.substr(0, gpu.find(" (")));
  const std::string device = !gpus.empty() ? list(short_names) : !cpus.empty() ? list(cpus) : "an unknown machine";
  h.title = fmt::format("Cloth solvers on {}: {}", device, what);
  if (!gpus.empty()) h.facts.emplace_back("GPU", list(gpus) + (software ? " (software)" : ""));
  if (!drivers.empty()) h.facts.emplace_back("driver", list(drivers));
  if (!cpus.empty()) h.facts.emplace_back("CPU", list(cpus));
  if (!commits.empty()) h.facts.emplace_back("commit", list(commits));
  if (!days.empty())
    h.facts.emplace_back("date", days.size() == 1 ? *days.begin() : *days.begin() + " to " + *days.rbegin());
  h.facts.emplace_back("trials", trials.empty() ? "none timed" : list(trials));
  return h;
}

}  // namespace clothbench
