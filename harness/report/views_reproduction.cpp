// Tables of the study `reproduction`: for which settings left open by the article its claims hold.
#include <fmt/format.h>

#include <map>
#include <numeric>
#include <set>
#include <tuple>

#include "metrics/registry.hpp"
#include "report/view.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr const char* kPublished = "published: PBD";
constexpr double kUnfit = 25;  // residual [%] above which times are not a straight line over particles

/// C11 of the article is judged in the sweep: NvCloth's `roughness_end` there, from the published study `penetration`.
constexpr double kEngineRoughness = 0.0415;

struct Claim {
  std::string name;
  bool holds = false, near = false;  ///< near: all criteria except one are met
  Texts criteria = {};               ///< criteria with the values found; only violated ones of the run's claim
};
/// The claim for which the run was made, without the motion check, which is no part of it; and, of the sweep, C11.
std::vector<Claim> claims_of(const Row& r) {
  Claim own{r.drawn().value("kind", "")};
  std::size_t judged = 0;
  for (const auto& [name, met] : r.run->summary) {
    if (!name.starts_with(kExpect) || name == kExpect + "motion" || name == kExpect + "outcome") continue;
    ++judged;
    const std::string n = name.substr(kExpect.size());
    if (met != 1)
      own.criteria.push_back(fmt::format("{}: {} {} ({})", own.name, n, found_of(r, n).text, expected_of(r, n)));
  }
  const bool ended = r.status() == "ok", is_sweep = own.name == "c10-sweep" && r.resolution.grid[0] == 32;
  own.holds = ended && judged > 0 && own.criteria.empty();
  own.near = ended && judged > 1 && own.criteria.size() == 1;
  if (!is_sweep) return {own};
  const double found = r.value("roughness_end");
  const std::string c11 = fmt::format("c11-folds: roughness_end {:.3g} (below {})", found, kEngineRoughness);
  return {own, {"c11-folds", ended && found < kEngineRoughness, false, {c11}}};
}

/// One combination of drawn settings, with the numbers of claims that were run and that hold with it.
struct Point {
  std::size_t claims = 0, held = 0;
  double dispatches = 0, device_s = kMissing;  ///< per frame, of its most expensive scene
  Group runs = {};
  Texts missed = {};
  json settings = {};
};
/// The points behind a row of the table. The row for all claims has only points at which every claim was run.
std::map<std::string, Point> points_of(const Group& runs, const Keys& keys) {
  std::map<std::string, Point> out;
  const std::size_t wanted = keys.back().all ? runs.front()->drawn().value("claims", std::size_t{0}) : 1;
  for (const Row* r : runs) {
    Point& p = out[dump(r->drawn()["settings"])];
    for (const Claim& c : claims_of(*r)) {
      if (!keys.back().all && keys.back().text != c.name) continue;
      ++p.claims;
      p.held += c.holds;
      if (!c.holds) p.missed.insert(p.missed.end(), c.criteria.begin(), c.criteria.end());
    }
    p.runs.push_back(r);
    p.settings = r->drawn()["settings"].value(r->solver, json::object());
    p.dispatches = std::fmax(p.dispatches, r->value("dispatches"));
    p.device_s = std::fmax(p.device_s, r->value("frame_device_median_s"));
  }
  std::erase_if(out, [&](const auto& point) { return point.second.runs.size() != wanted; });
  return out;
}

/// Number of points at which all of the group's claims hold, and number of points.
std::pair<std::size_t, std::size_t> held_of(const Group& g, const Keys& keys) {
  const auto points = points_of(g, keys);
  const auto held =
      std::count_if(points.begin(), points.end(), [](const auto& p) { return p.second.held == p.second.claims; });
  return {static_cast<std::size_t>(held), points.size()};
}

std::string reading(const Group& g, const Keys& keys) {
  const auto [held, all] = held_of(g, keys);
  if (all == 0) return "";
  const auto n = std::count_if(g.begin(), g.end(), [](const Row* r) { return r->status() != "ok"; });
  if (held == 0 && n > 0) return fmt::format("not reproduced in the box; runs that did not end: {}", n);
  return held == all ? "reproduced" : held > 0 ? "reproducible" : "not reproduced in the box";
}

/// The cheapest of the points at which the largest number of the group's claims hold. If none holds anywhere: null, or
/// with `or_nearest` the cheapest of the points with the fewest violations.
std::optional<Point> best_of(const Group& g, const Keys& keys, bool or_nearest = false) {
  std::optional<Point> out;
  const auto rank = [](const Point& p) {
    return std::tuple(p.claims - p.held, p.held > 0 ? 0 : p.missed.size(), p.dispatches);
  };
  for (const auto& [settings, p] : points_of(g, keys))
    if ((p.held > 0 || or_nearest) && p.dispatches > 0 && (!out || rank(p) < rank(*out))) out = p;
  return out;
}

/// "substeps ≥ 5 (12 points)": of the conditions on one setting under which all points meet the row's claims, the one
/// with the most points, at least three. A setting has two words at most.
Cell always_with(const Group& g, const Keys& keys) {
  Cell out;
  const auto points = points_of(g, keys);
  std::size_t most = 2;
  for (const auto& [unused, at] : points)
    for (const auto& [name, limit] : at.settings.items())
      for (const bool above : {true, false}) {
        std::size_t inside = 0, failed = 0;
        for (const auto& [unused_too, p] : points) {
          const json value = p.settings.value(name, json());
          if (above ? value < limit : value > limit) continue;
          ++inside;
          failed += p.held < p.claims;
        }
        if (failed > 0 || inside <= most || inside == points.size()) continue;
        most = inside;
        const char* sign = limit.is_string() ? "=" : above ? "≥" : "≤";
        out = fmt::format("{} {} {} ({} points)", name, sign, dump(limit), inside);
      }
  return out;
}

/// The box, as far as points reach into it: values of the scene and of the solvers that were run.
std::string box_of(const Group& g) {
  std::map<std::string, std::set<json>> found;
  for (const Row* r : g) {
    const json drawn = r->drawn(), all = drawn.value("values", json::object());
    for (const auto& [name, value] : all.items())
      if (const std::string of = name.substr(0, name.find('.')); of == r->solver || !drawn["settings"].contains(of))
        found[name].insert(value);
  }
  std::string out;
  for (const auto& [name, in] : found)
    out += fmt::format("; {} {} to {}", name, in.begin()->dump(), in.rbegin()->dump());
  return "Box searched" + out + ".";
}

/// A column about the row's best_of.
ViewColumn at_best(const char* head, std::function<Cell(const Point&)> cell, bool or_nearest = false) {
  return {head, [=](const Group& g, const Keys& keys) {
            const std::optional<Point> p = best_of(g, keys, or_nearest);
            return p ? cell(*p) : Cell();
          }};
}

/// Command that generates and runs the scenes of the point; states how many claims hold if not all do.
Cell command_of(const Point& p) {
  const auto seed = [](const Row* r) { return r->scenario.value("seed", std::uint64_t{0}); };
  const Row& first =
      **std::min_element(p.runs.begin(), p.runs.end(), [&](auto* a, auto* b) { return seed(a) < seed(b); });
  return fmt::format("{}clothbench study {} --seed {} --count {}{}{}",
                     p.held == p.claims ? "" : fmt::format("{} of {} claims: ", p.held, p.claims),
                     first.drawn().value("study", ""), seed(&first), p.runs.size(),
                     environment_text(*first.run, "protocol") == "quick" ? " --quick" : "",
                     first.drawn().value("assets", "") == "procedural" ? " --procedural" : "");
}

View claims() {
  View v{"contact", "Claims of the article, over what it leaves open", note("claims"),
         [](const Row& r) { return r.part == Part::Claims; }};
  v.keys = {key("solver", &Row::solver, true), {"claim", [](const Row& r) {
                                                  Keys out;
                                                  for (const Claim& c : claims_of(r)) out.emplace_back(c.name);
                                                  out.emplace_back("all", true);
                                                  return out;
                                                }}};
  v.columns = {{"reading", reading},
               {"holds", [](const Group& g, const Keys& keys) { return std::apply(share_cell, held_of(g, keys)); }},
               at_best("fewest dispatches",
                       [](const Point& p) { return p.held == p.claims ? number_cell(p.dispatches, 1) : Cell(); }),
               {"at all points with", always_with},
               at_best(
                   "missed there", [](const Point& p) { return Cell(joined(p.missed, "; ")); }, true),
               at_best("best point", command_of),
               at_best("its GPU time [ms]", [](const Point& p) { return number_cell(1e3 * p.device_s, 3); })};
  v.by_key = true;
  v.more = box_of;
  return v;
}

/// Least-squares fit of time = fixed + slope · particles.
struct WorkFit {
  double fixed_s = kMissing, slope_s = kMissing, slope_error_s = kMissing, residual = kMissing;
};
using Samples = std::map<std::pair<std::string, double>, double>;  ///< frame time [s] by sides and edge of the grid

double particles(const Samples::value_type& sample) {
  const auto& [sides, width] = sample.first;
  return width * width * (sides == "double-duplicated" ? 2 : 1);
}

WorkFit fit_of(const Samples& samples) {
  const auto n = static_cast<double>(samples.size());
  if (n < 3) return {};
  const auto mean = [&](auto of) {
    return std::accumulate(samples.begin(), samples.end(), 0.0, [&](double sum, auto& s) { return sum + of(s); }) / n;
  };
  const double x = mean(particles), time_s = mean([](auto&s) { return s.second; });
  const double variance = mean([&](auto& s) { return std::pow(particles(s) - x, 2); });
  const double slope_s = mean([&](auto& s) { return (particles(s) - x) * s.second; }) / variance;
  const double fixed_s = time_s - slope_s * x;
  const auto off = [&](auto& s) { return s.second - fixed_s - slope_s * particles(s); };
  WorkFit out{fixed_s, slope_s, std::sqrt(mean([&](auto& s) { return std::pow(off(s), 2); }) / (n - 2) / variance), 0};
  for (const auto& s : samples) out.residual = std::max(out.residual, std::abs(off(s) / s.second));
  return out;
}

/// Frame times from published rates of PBD below the display's cap; a rate at the cap is only an upper bound on time.
const Samples& published_samples() {
  static const Samples all = [] {
    Samples out;
    const json table = published_table3();
    for (const json& c : table.at("columns"))
      for (std::size_t k = 0; k < c.at("fps").size(); ++k)
        if (c.contains("sides") && c["fps"][k] < table.at("display_cap_hz"))
          out[{c["sides"], table.at("resolution")[k]}] = 1 / c["fps"][k].get<double>();
    return out;
  }();
  return all;
}

/// A row's times: published, or measured at the same resolutions and sides; empty if one of these was not measured.
Samples samples_of(const Group& g, const Keys& keys) {
  if (keys.front().text == kPublished) return published_samples();
  Samples out;
  for (const Row* r : g)
    if (r->label() == keys.front().text) out[{r->sides, r->resolution.grid[0]}] = r->value("frame_wall_median_s");
  return out.size() == published_samples().size() ? out : Samples();
}

/// Iterations per frame that would take the published time per particle on the run's device.
Cell allowed_iterations(const Group& g, const Keys& keys) {
  if (keys.front().text == kPublished) return {};
  const WorkFit fit = fit_of(samples_of(g, keys)), published = fit_of(published_samples());
  const json& own = g.front()->run->header.settings;
  const double scale = own.value("iterations", kMissing) * own.value("substeps", 1.0) / fit.slope_s;
  if (!(scale > 0)) return {};
  const auto at = [&](double errors) {
    return significant(scale * std::max(0.0, published.slope_s + errors * published.slope_error_s), 2);
  };
  return {fmt::format("{} ({}–{})", at(0), at(-2), at(2)), scale * published.slope_s};
}

View work_model() {
  View v{"rates", "Table 3: work per frame", note("work per frame"), [](const Row& r) {
           return r.paper_table == 3 && r.part == Part::Rates && r.status() == "ok" &&
                  published_samples().contains({r.sides, r.resolution.grid[0]});
         }};
  v.keys = {
      {"solver", [](const Row& r) { return Keys{r.published < 0 ? r.label() : KeyValue(kPublished, true)}; }, true}};
  v.by_key = true;
  const auto add = [&](std::string head, std::function<Cell(const Samples&)> cell) {
    v.columns.push_back({std::move(head), [cell](const Group& g, const Keys& keys) {
                           const Samples s = samples_of(g, keys);
                           return s.empty() ? Cell("incomplete", kMissing, "dim") : cell(s);
                         }});
  };
  add("fixed [ms]", [](auto& s) { return number_cell(1e3 * fit_of(s).fixed_s, 3); });
  add("slope (error) [µs per particle]", [](auto& s) {
    const WorkFit f = fit_of(s);
    const std::string text = paired(1e6 * f.slope_s, 1e6 * f.slope_error_s, " (", 3) + ")";
    return std::isfinite(f.slope_s) ? Cell(text, f.slope_s) : Cell();
  });
  add("max residual [%]", [](auto& s) {
    const Cell c = number_cell(100 * fit_of(s).residual, 2);
    return c.value > kUnfit ? Cell(c.text + " !", c.value, "bad") : c;
  });
  const auto add_ratio = [&](const char* head, const Samples::key_type& of, const Samples::key_type& to) {
    add(head, [=](auto& s) { return number_cell(s.at(of) / s.at(to), 3); });
  };
  add_ratio("C2: 128² / 64²", {"single", 128}, {"single", 64});
  add_ratio("C3: doubled / single at 64²", {"double-duplicated", 64}, {"single", 64});
  add_ratio("C3: doubled / single at 128²", {"double-duplicated", 128}, {"single", 128});
  add("C3: doubled / single slope", [](auto& s) {
    const auto rise = [&](const char* sides) { return s.at({sides, 128}) - s.at({sides, 64}); };
    return number_cell(rise("double-duplicated") / rise("single"), 3);
  });
  v.columns.push_back({"iterations at the published slope", allowed_iterations});
  v.columns.push_back(column("trials", trials_cell));
  v.timed = true;
  return v;
}

}  // namespace

json claim_fields(const Row& r) {
  const Claim own = claims_of(r).front();
  const json settings = r.drawn().at("settings").value(r.solver, json::object());
  return {{"kind", own.name},
          {"iterations", settings.value("iterations", 1.0)},
          {"substeps", settings.value("substeps", 1.0)},
          {"dispatches", r.value("dispatches")},
          {"claim", own.holds  ? "holds"
                    : own.near ? "near"
                               : "fails"}};
}

void mark_best_points(std::vector<Row>& rows) {
  std::map<std::string, Group> solvers;
  for (const Row& r : rows)
    if (r.part == Part::Claims) solvers[r.solver].push_back(&r);
  for (const auto& [solver, runs] : solvers) {
    const std::optional<Point> p = best_of(runs, {solver, {"all", true}});
    if (!p) continue;
    const json best = p->runs.front()->drawn()["settings"].value(solver, json::object());
    for (Row& r : rows) {
      json settings = r.run->header.settings;
      settings.update(best);
      r.is_best = r.is_best || contains(p->runs, &r) ||
                  (r.part != Part::Claims && r.solver == solver && settings == r.run->header.settings);
    }
  }
}

std::vector<View> reproduction_views() { return {work_model(), devices(), claims()}; }

}  // namespace clothbench
