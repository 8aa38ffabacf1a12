// Tables of study `reproduction`: for which values of what the article leaves open its claims hold.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "metrics/registry.hpp"
#include "report/view.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr const char* kTogether = "all";
/// Lower ends of the bands of iterations per frame, over all substeps; `paper` has 5 by default.
constexpr std::array kIterations = {1.0, 10.0, 30.0, 100.0, 300.0};

/// A point of the box, with the number of claims that were run and that hold there.
struct Point {
  std::size_t claims = 0, held = 0;
  double dispatches = 0;
  const Row* run = nullptr;  ///< one of its runs
};
/// The points of a row of the table. In the row of all claims these are points at which all were run.
std::map<std::string, Point> points_of(const Group& runs, const Texts& keys) {
  std::map<std::string, Point> out;
  const std::size_t wanted = keys.back() == kTogether ? runs.front()->drawn().value("claims", std::size_t{0}) : 1;
  for (const Row* r : runs) {
    Point& p = out[r->drawn()["settings"].dump()];
    ++p.claims;
    p.held += claim_point(*r).holds();
    p.run = r;
    if (const double d = r->value("dispatches"); d > p.dispatches) p.dispatches = d;
  }
  std::erase_if(out, [&](const auto& point) { return point.second.claims != wanted; });
  return out;
}

/// Points of the group at which all of its claims hold, of how many.
std::pair<std::size_t, std::size_t> held_of(const Group& g, const Texts& keys) {
  const auto points = points_of(g, keys);
  const auto held =
      std::count_if(points.begin(), points.end(), [](const auto& p) { return p.second.held == p.second.claims; });
  return {static_cast<std::size_t>(held), points.size()};
}

Cell share(const Group& g, const Texts& keys) {
  const auto [held, all] = held_of(g, keys);
  return share_cell(held, all);
}

std::string reading(const Group& g, const Texts& keys) {
  const auto [held, all] = held_of(g, keys);
  if (all == 0) return "";
  return held == all ? "reproduced" : held > 0 ? "reproducible" : "not reproduced in the box";
}

/// The cheapest point at which most claims of the group hold; null if none holds anywhere.
std::optional<Point> best_of(const Group& g, const Texts& keys) {
  std::optional<Point> out;
  for (const auto& [settings, p] : points_of(g, keys))
    if (p.held > 0 && p.dispatches > 0 &&
        (!out || p.held > out->held || (p.held == out->held && p.dispatches < out->dispatches)))
      out = p;
  return out;
}

Cell fewest_dispatches(const Group& g, const Texts& keys) {
  const std::optional<Point> p = best_of(g, keys);
  return p && p->held == p->claims ? number_cell(p->dispatches, 1) : Cell();
}

/// Settings of the cheapest point as the command line takes them; of the nearest miss if the claims hold nowhere
/// together.
Cell best_settings(const Group& g, const Texts& keys) {
  const std::optional<Point> p = best_of(g, keys);
  if (!p) return {};
  std::string out = p->held == p->claims ? "" : fmt::format("{} of {} claims:", p->held, p->claims);
  const json settings = p->run->drawn()["settings"].value(p->run->solver, json::object());
  for (const auto& [name, value] : settings.items())
    out += fmt::format("{}--set solver.{}={}", out.empty() ? "" : " ", name,
                       value.is_string() ? value.get<std::string>() : value.dump());
  return out;
}

/// Lower end of the run's band. All claims of a point are in one band, because they share the settings.
double band_of_settings(const Row& r) {
  const ClaimPoint p = claim_point(r);
  const double n = p.iterations * p.substeps;
  return *std::find_if(kIterations.rbegin(), kIterations.rend() - 1, [&](double low) { return n >= low; });
}

std::string band_text(const Row& r) {
  const auto next = std::upper_bound(kIterations.begin(), kIterations.end(), band_of_settings(r));
  return next == kIterations.end() ? fmt::format("≥ {:g} iterations", band_of_settings(r))
                                   : fmt::format("{:g}–{:g} iterations", band_of_settings(r), *next - 1);
}

View claims() {
  View v{"contact", "Claims of the article, over what it leaves open",
         "Share of the points of the box at which a claim holds, with Wilson's 95 % interval, also by iterations × "
         "substeps of a frame. Reproduced: holds at every point; reproducible: at some. All: every claim holds at one "
         "point. Fewest dispatches: the cheapest point, in dispatches per frame of its most expensive claim. Paper, "
         "best: the solver's settings there, as options of `clothbench run`, without the values drawn for the scene; "
         "if the claims hold nowhere together, of the point where most do.",
         [](const Row& r) { return r.part == Part::Claims; }};
  v.keys = {solver_key(), {"claim", [](const Row& r) { return Texts{r.drawn().value("kind", ""), kTogether}; }}};
  v.columns = {
      {"reading", reading}, {"holds", share}, {"fewest dispatches", fewest_dispatches}, {"paper, best", best_settings}};
  v.across = {key("", band_text), share, band_of_settings};
  v.by_key = true;
  return v;
}

}  // namespace

ClaimPoint claim_point(const Row& r) {
  const json drawn = r.drawn();
  const json settings = drawn.at("settings").value(r.solver, json::object());
  ClaimPoint out{drawn.value("kind", ""), settings.value("iterations", 1.0), settings.value("substeps", 1.0)};
  out.ended = r.status() == "ok";
  for (const auto& [name, met] : r.run->summary) {
    if (!name.starts_with(kExpect) || name == kExpect + "motion" || name == kExpect + "outcome") continue;
    ++out.bounds;
    out.unmet += !(met == 1);
  }
  return out;
}

std::vector<View> reproduction_views() { return {claims()}; }

}  // namespace clothbench
