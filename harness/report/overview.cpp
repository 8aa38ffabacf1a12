// First part of a report: title, facts, warnings and notes on all runs, four tiles, and Table 3 with errors.
#include <fmt/format.h>

#include <map>
#include <set>

#include "report/report.hpp"
#include "report/view.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double kFallLimit = 0.01;  // with a larger free-fall error, a frame rate means nothing
constexpr double kBudget_ms = 1;     // budget of wall time per frame
constexpr double kMaxError = 0.1;    // with a larger error, a solver does not lead, however fast it is
constexpr double kUneven = 1.5;      // mean over median frame time
constexpr double kFastest = 1e9;     // frames per second: above any real rate
constexpr std::size_t kNamed = 3;    // studies in a title

/// Frames per second with at most four digits; larger values in thousands or millions.
std::string rate_text(double v) {
  if (!std::isfinite(v)) return "";
  if (v >= 999500) return significant(1e-6 * v, 3) + "M";
  return v >= 9999.5 ? significant(1e-3 * v, 3) + "k" : fmt::format("{:.{}f}", v, v >= 1000 ? 0 : 1);
}

/// A solver's run with the largest mesh; null if its outcome is not ok.
const Row* largest(const Group& g) {
  const auto at = std::find_if(g.begin(), g.end(),
                               [](const Row* r) { return r->largest && r->status() == "ok" && r->published < 0; });
  return at == g.end() ? nullptr : *at;
}

ViewColumn at_largest(std::string head, std::function<Cell(const Row&)> cell) {
  return column(std::move(head), std::move(cell), false, largest);
}

std::string rate_interval(const Row& r) {
  const Interval i = r.times->wall.rate;
  return std::isfinite(i.low) ? rate_text(i.low) + "–" + rate_text(i.high) + (r.times->wall.uncertain() ? " ~" : "")
                              : std::string();
}

/// A frame rate, marked if it is no measure of a frame's cost.
Cell rate_cell(const Row& r) {
  const double fps = r.value(r.published >= 0 ? "fps_at_72" : "fps_median");
  if (r.published >= 0) return {fmt::format("{:g}", fps), fps};
  if (r.status() != "ok") return ending_cell(*r.run);
  const bool uneven = 1 / fps > kUneven * r.times->wall.at(0.5);
  return {rate_text(fps) + (uneven ? " (uneven)" : "") + in_brackets(r.frames_mark()), fps};
}

Cell rate_ratio_cell(const Row& r) {
  const double fps = r.value("fps_median");
  if (!r.baseline || !std::isfinite(fps)) return {};
  return ratio_cell(r, fps, r.times->wall.rate, r.baseline->value("fps_median"), r.baseline->times->wall.rate);
}

/// Notes: the errors of these runs, the source of the published rows, and solvers that wrap a published engine.
std::string about_rates(const Group& runs) {
  const auto any = [&](const char* name) {
    return std::any_of(runs.begin(), runs.end(), [&](auto* r) { return std::isfinite(r->value(name)); });
  };
  Texts out;
  if (const std::string scene = scenario_of(*runs.front()->run).value("why", ""); !scene.empty()) out.push_back(scene);
  if (any("free_fall_error"))
    out.push_back(
        "Free-fall error: distance from the solver's own integrator, not accuracy; above 1 % (!) a rate "
        "means nothing.");
  if (any("stretch_max_last_second"))
    out.push_back("Stretch: structural edges, last second; edges shorter than at rest count as 0 in the mean.");
  if (!any("free_fall_error") && !any("stretch_max_last_second"))
    out.push_back("These runs have no comparable error; runs of `clothbench study work-precision` have one.");
  if (runs.front()->paper_table != 3) return joined(out, " ");
  const json published = published_table3();
  out.push_back(
      "Published: Kim, Ma and Hong (Appl. Sci. 2025, 15, 6611), Table 3, Quest 3, with rendering, capped at 72.");
  for (const Row* r : runs)
    for (const json& column : published.at("columns")) {
      const std::string engine = engine_of(*r->run), peer = r->label() + ": " + column.value("peer", "");
      if (!engine.empty() && column.value("engine", "") == engine && !contains(out, peer)) out.push_back(peer);
    }
  return joined(out, " ");
}

/// Speed and error: in the scene of the paper's Table 3 if `paper`, otherwise in every other scene.
View speed_and_error(bool paper) {
  View v{"rates", paper ? "Table 3: speed and error" : "Frame rates", note("rates") + note("intervals"),
         [paper](const Row& r) {
           return r.part == Part::Rates && (r.paper_table == 3) == paper && (!paper || r.is_main()) &&
                  !is_floor(r.solver);
         }};
  if (!paper) v.each = [](const Row& r) { return "Frame rates: " + r.family; };
  v.order = [](const Group& g) {  // rows are sorted by sides, then the fastest first; published values come last
    double fps = 0;
    for (const Row* r : g) fps = r->largest && std::isfinite(r->value("fps_median")) ? r->value("fps_median") : fps;
    const double group = g.front()->sides == "double" ? 1 : g.front()->sides == "double-duplicated" ? 2 : 0;
    return g.front()->published >= 0 ? INFINITY : kFastest * group - fps;
  };
  v.keys = {key(
      "solver",
      [](const Row& r) {
        const bool plain = r.sides.empty() || r.sides == "single" || r.published >= 0;
        return plain ? r.label() : r.label() + ", " + r.sides;
      },
      true)};
  v.across = {key("", [](const Row& r) { return r.resolution.label(); }),
              [](const Group& g, const Keys&) { return rate_cell(*g.front()); },
              [](const Row& r) { return r.resolution.size(); }, 1};
  v.columns = {
      at_largest("× " + time_baseline(), rate_ratio_cell),
      at_largest("rank", rank_cell),
      at_largest("free-fall error [g T²/2]",
                 [](const Row& r) {
                   const double e = r.value("free_fall_error");
                   if (!std::isfinite(e)) return Cell();
                   return e > kFallLimit ? Cell(fmt::format("{:.1e} !", e), e, "bad")
                                         : Cell(fmt::format("{:.1e}", e), e);
                 }),
      at_largest("rate: 95 % interval", [](const Row& r) { return Cell(rate_interval(r), r.times->wall.rate.low); }),
      at_largest("stretch, mean / maximum [%]",
                 [](const Row& r) {
                   const auto percent = [&](auto* name) { return std::round(1e5 * r.value(name)) / 1e3; };
                   const Cell c =
                       paired_cell(percent("stretch_mean_last_second"), percent("stretch_max_last_second"), 2);
                   return r.value("stretch_max_last_second") > kTornApart ? Cell(c.text + " !", c.value, "bad") : c;
                 }),
      at_largest("trials", trials_cell)};
  for (std::size_t k = 0; k < 3; ++k) v.columns[k].leads = true;
  add_tail_columns(v, largest);
  v.more = about_rates;
  v.timed = true;
  return v;
}

/// "not a and b" for one or two scenes.
std::string except(const Texts& scenes) {
  return scenes.empty() || scenes.size() > 2 ? "" : "not " + joined(scenes, " and ");
}

std::string in_one_line(Texts parts) {
  std::erase(parts, "");
  return joined(parts);
}

/// A fraction of scenes with its interval.
Tile::Entry share_entry(const Row& r, const std::string& label, std::size_t good, std::size_t all, Texts about) {
  const Interval i = wilson_95(good, all);
  about.insert(about.begin(), fmt::format("{:.0f}–{:.0f} %", 100 * i.low, 100 * i.high));
  return {r.solver, label, fmt::format("{}/{}", good, all), in_one_line(std::move(about)), 0};
}

/// "1 trial", "5 trials", "1 to 5 trials".
std::string trials_text(const std::set<std::size_t>& n) {
  const std::string least = *n.begin() < *n.rbegin() ? fmt::format("{} to ", *n.begin()) : "";
  return fmt::format("{}{} {}", least, *n.rbegin(), *n.rbegin() == 1 ? "trial" : "trials");
}

/// Rates on the largest mesh of the paper's Table 3; without such runs, of the first family with times.
Tile rates(const Group& rows) {
  Tile out;
  Texts left_out;
  std::string family;
  for (const Row* r : rows)
    if (r->part == Part::Rates && std::isfinite(r->value("fps_median")) && (family.empty() || r->paper_table == 3))
      family = r->family;
  for (const Row* r : rows) {
    if (r->part != Part::Rates || !r->largest || r->sides.starts_with("double") || !r->is_main() || r->repeat > 1 ||
        r->family != family || r->status() == "missing")
      continue;
    const std::string why = r->status() != "ok"                        ? ending(r->run->outcome)
                            : r->value("free_fall_error") > kFallLimit ? "free-fall error above 1 %"
                            : r->on_software                           ? "software device"
                            : !std::isfinite(r->value("fps_median"))   ? "time withheld"
                                                                       : "";
    if (!why.empty()) {
      left_out.push_back(r->label() + in_brackets(why));
      continue;
    }
    out.title = "Frames per second at " + r->resolution.label();
    const std::string interval = rate_interval(*r);
    const double off = r->value("free_fall_error");
    const std::string error =
        std::isfinite(off) ? fmt::format("free fall off by {:.1e}", off) : "free fall not checked";
    out.entries.push_back({r->solver, r->label(), rate_text(r->value("fps_median")),
                           in_one_line({interval.empty() ? "too few frames for an interval" : interval,
                                        trials_text({r->run->trials.size()}), r->frames_mark(),
                                        environment_text(*r->run, "gpu") == "CPU" ? "on the CPU" : "", error}),
                           r->times->wall.uncertain() ? 0 : r->value("fps_median")});
  }
  if (!left_out.empty()) out.left_out = fmt::format("{} not ranked: {}", left_out.size(), joined(left_out));
  return out;
}

/// For each solver, in how many scenes with an exact solution its error is smallest and not above kMaxError; errors
/// below the floor are equal.
Tile errors(const Group& rows) {
  std::map<std::string, std::map<std::string, double>> scenes;  // smallest error by solver
  std::map<std::string, std::pair<const Row*, Texts>> lost;
  std::map<std::string, std::set<std::size_t>> trials;
  for (const Row* r : rows) {
    if (r->part != Part::Truth || !r->counts() || !r->truth->refused().empty() || !r->not_ranked().empty() ||
        r->on_software || !(r->wall_ms_per_s() / r->frame_rate_hz() <= kBudget_ms) ||
        (r->times->wall.uncertain() && !(1e3 * r->times->wall.median.high <= kBudget_ms)))
      continue;
    double& least = scenes[r->scene].try_emplace(r->solver, INFINITY).first->second;
    least = std::min(least, std::max(r->truth->rank_floor(), r->error()));
    lost[r->solver].first = r;
    trials[r->solver].insert(r->run->trials.size());
  }
  for (const auto& [scene, errors] : scenes) {
    double least = kMaxError;
    for (const auto& [unused, error] : errors) least = std::min(least, error);
    for (auto& [solver, runs] : lost)
      if (!errors.contains(solver) || errors.at(solver) > least) runs.second.push_back(scene);
  }
  Tile out{"Scenes with the smallest error within 1 ms per frame, at most 10 %, ties included", {}};
  for (const auto& [solver, runs] : lost) {
    const auto& [row, names] = runs;
    out.entries.push_back(share_entry(*row, solver, scenes.size() - names.size(), scenes.size(),
                                      {trials_text(trials[solver]), except(names)}));
    out.entries.back().merit = -static_cast<double>(names.size());
  }
  return out;
}

/// For each solver, passed or stable runs as a fraction of the runs with a verdict.
Tile shares(const Group& rows, Part part, std::string title) {
  std::map<std::string, std::pair<Group, Texts>> solvers;   // runs; scenes of the runs that are not good
  std::map<std::string, std::set<std::string>> solvers_of;  // by scene; "": all
  for (const Row* r : rows)
    for (const std::string& scene : {r->scene, std::string()}) solvers_of[scene].insert(r->solver);
  for (const Row* r : rows) {
    const bool stability = part == Part::Stability, judged = stability || bounds_of(*r->run) > 0;
    // Resolutions of a sweep are not counted, whose short runs can fail but not pass, nor scenes that only one of
    // several solvers ran.
    const bool swept =
        part == Part::Contact && (r->scaled || (solvers_of[r->scene].size() == 1 && solvers_of[""].size() > 1));
    if (r->part != part || !r->is_main() || r->repeat > 1 || swept || r->status() == "missing" || !judged) continue;
    auto& [runs, bad] = solvers[r->label()];
    runs.push_back(r);
    if (!(stability ? grade_of(*r) == 0 : verdict(*r->run) == "pass")) bad.push_back(r->scene);
  }
  Tile out{std::move(title), {}};
  for (const auto& [solver, share] : solvers) {
    const auto& [runs, bad] = share;
    const std::string offset = part == Part::Stability ? "" : offset_of(runs).text;
    out.entries.push_back(
        share_entry(*runs.front(), solver, runs.size() - bad.size(), runs.size(),
                    {"one run per scene", offset.empty() ? "" : "contact offset " + offset + " mm", except(bad)}));
    const auto all = static_cast<double>(runs.size());  // between equal fractions, the one with more runs wins
    out.entries.back().merit = 1 - static_cast<double>(bad.size()) / all + 1e-9 * all;
  }
  return out;
}

/// The value of a run's environment as shown in the heading.
std::string fact(const RunRecord& c, const std::string& key) {
  const std::string value = environment_text(c, key.c_str());
  if ((key == "gpu" || key == "driver") && environment_text(c, "gpu") == "CPU") return "";
  if (key == "cpu" && environment_of(c, "cpu_threads").is_number())
    return fmt::format("{} ({} threads)", value, dump(environment_of(c, "cpu_threads")));
  if (key == "protocol" && (value == "full" || value == "run")) return "";  // the usual protocol needs no word
  if (key == "gpu") return value + (environment_of(c, "gpu_is_software") == json(true) ? " (software)" : "");
  if (key == "git_commit") return commit_of(c);
  return key == "created" ? value.substr(0, 10) : value;
}

}  // namespace

std::vector<View> overview_views() { return {speed_and_error(true), speed_and_error(false)}; }

std::string Tile::others() const {
  Texts out;
  for (std::size_t k = 1; k < entries.size(); ++k)
    out.push_back(entries[k].label + " " + entries[k].value + in_brackets(entries[k].about));
  return joined(out, " · ");
}

std::vector<Tile> tiles_of(const RunTable& table) {
  constexpr std::size_t kMostTiles = 4;
  Group rows;
  for (const Row& r : table.rows())
    if (r.published < 0 && !is_floor(r.solver) && !is_baseline(r.solver)) rows.push_back(&r);
  std::map<std::string, Group> random;  // by study
  for (const Row* r : rows)
    if (r->part == Part::Generated) random[r->drawn().value("study", "?")].push_back(r);
  std::vector<Tile> tiles = {shares(rows, Part::Contact, "Scenes with colliders or attachments passed"), errors(rows),
                             rates(rows), shares(rows, Part::Stability, "Hard cases stable")};
  for (const auto& [study, of] : random)
    tiles.insert(study == random.begin()->first ? tiles.begin() : tiles.end(),
                 shares(of, Part::Generated, "Random scenes of " + study + " passed"));
  std::erase_if(tiles, [](const Tile& t) { return t.entries.empty(); });
  tiles.resize(std::min(tiles.size(), kMostTiles));
  for (Tile& t : tiles)
    std::stable_sort(t.entries.begin(), t.entries.end(), [](auto& a, auto& b) { return a.merit > b.merit; });
  return tiles;
}

Heading heading_of(const RunTable& table, const std::vector<std::string>& studies) {
  static constexpr std::pair<const char*, const char*> kFacts[] = {
      {"gpu", "GPU"},           {"driver", "driver"},    {"cpu", "CPU"},     {"protocol", "protocol"},
      {"git_commit", "commit"}, {"build_type", "build"}, {"created", "date"}};
  Heading h;
  std::string device;
  bool several = false;  // devices of a kind
  for (const auto& [key, name] : kFacts) {
    std::set<std::string> values, short_names;
    for (const RunRecord& c : table.runs())
      if (const std::string value = fact(c, key); !value.empty()) {
        values.insert(value);
        short_names.insert(short_name(value));
      }
    if (values.empty()) continue;
    if (device.empty()) device = joined(short_names);
    several = several || (short_names.size() > 1 && (key == kFacts[0].first || key == kFacts[2].first));
    const bool span = std::string(key) == "created" && values.size() > 1;
    h.facts.emplace_back(name, span ? *values.begin() + " to " + *values.rbegin() : joined(values));
  }
  std::map<std::string, std::set<std::string>> trials, devices;  // folders by number of trials; by device
  for (const RunRecord& c : table.runs()) {
    const std::string machine = device_of(c), folder = folder_of(c);
    if (!machine.empty()) devices[machine].insert(folder);
    if (const bool withheld = c.withheld.contains("frame_wall_median_s"); withheld || !c.trials.empty())
      trials[withheld ? "withheld" : std::to_string(c.trials.size())].insert(folder);
  }
  const auto text = [](const auto& t) { return t.first + in_brackets(joined(t.second)); };
  h.facts.emplace_back("trials per run", trials.empty()       ? "none timed"
                                         : trials.size() == 1 ? trials.begin()->first
                                                              : joined(trials, ", ", text));
  if (several) {  // names devices and studies; the table of machines has the rest
    std::erase_if(h.facts, [](const auto& f) { return f.first == "GPU" || f.first == "CPU" || f.first == "driver"; });
    h.facts.emplace(h.facts.begin(), "measured on", joined(devices, ", ", text));
  } else if (studies.size() > 1) {
    h.facts.emplace_back("studies", joined(studies));
  }
  const Texts first(studies.begin(), studies.begin() + static_cast<std::ptrdiff_t>(std::min(studies.size(), kNamed)));
  h.title = fmt::format("Cloth solvers on {}{}{}{}", device.empty() ? "an unknown machine" : device,
                        studies.size() > 1 ? fmt::format(": {} studies", studies.size()) : "",
                        studies.empty() ? "" : ": " + joined(first), studies.size() > kNamed ? " …" : "");
  return h;
}

std::vector<std::string> warnings_of(const RunTable& table) {
  std::set<std::string> software, invalid;
  std::vector<const Row*> all;
  for (const Row& r : table.rows()) {
    const RunRecord& c = *r.run;
    all.push_back(&r);
    if (r.on_software) software.insert(environment_text(c, "gpu"));
    for (const json& reasons : environment_of(c, "distrusted_trials")) invalid.insert(reasons);
  }
  std::vector<std::string> out;
  for (const std::string& device : software)
    out.push_back(fmt::format(
        "Software Vulkan device ({}): its results are valid, but its times tell nothing about a GPU.", device));
  for (const std::string& reason : invalid) out.push_back(fmt::format("Not a valid measurement: {}.", reason));
  if (const std::string withheld = withheld_note(all); !withheld.empty()) out.push_back(withheld);
  return out;
}

std::vector<std::string> notes_of(const RunTable& table) {
  std::set<std::string> plugins;  // one line per build of a plugin; the hash distinguishes builds
  for (const RunRecord& c : table.runs()) {
    const json p = environment_of(c, "plugin");
    if (!p.is_object()) continue;
    const auto part = [&](const char* key) { return or_dash(p.value(key, "")); };
    plugins.insert(fmt::format("{} is a plugin, version {}: {}. Library {}, SHA-256 {}.", c.header.solver,
                               or_dash(environment_text(c, "solver_version")), part("summary"),
                               fs::path(part("path")).filename().string(), part("sha256").substr(0, 16)));
  }
  std::vector<std::string> out(plugins.begin(), plugins.end());
  if (const VerdictCounts n = count_verdicts(table.runs()); n.runs > 0)
    out.push_back("All runs with acceptance criteria, also other settings: " + n.text() + ".");
  return out;
}

}  // namespace clothbench
