// Tables of study `reproduction`: for which values of what the article leaves open its claims hold.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "metrics/registry.hpp"
#include "report/view.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr const char* kTogether = "all";
/// Lower ends of the bands of iterations per frame, over all substeps; `paper` has 5 by default.
constexpr std::array kIterations = {1.0, 10.0, 30.0, 100.0, 300.0};

/// True if the run keeps every bound of the claim. The motion check is no part of a claim.
bool holds(const Row& r) {
  bool bounded = false;
  for (const auto& [name, passed] : r.run->summary) {
    if (!name.starts_with(kExpect) || name == kExpect + "motion" || name == kExpect + "outcome") continue;
    if (!(passed == 1)) return false;
    bounded = true;
  }
  return bounded && r.status() == "ok";
}

/// Points of the box, each with the number of claims that were run and that hold there.
struct Point {
  std::size_t claims = 0, held = 0;
  double dispatches = 0;
};
std::map<std::string, Point> points_of(const Group& runs) {
  std::map<std::string, Point> out;
  for (const Row* r : runs) {
    Point& p = out[r->drawn()["settings"].dump()];
    ++p.claims;
    p.held += holds(*r);
    if (const double d = r->value("dispatches"); d > p.dispatches) p.dispatches = d;
  }
  return out;
}

/// Points of the group at which all of its claims hold, of how many. A point without some claims does not count: the
/// last one, if the number of scenes is no multiple of the claims.
std::pair<std::size_t, std::size_t> held_of(const Group& g) {
  std::set<std::string> claims;
  for (const Row* r : g) claims.insert(r->drawn().at("kind"));
  std::size_t held = 0, all = 0;
  for (const auto& [settings, p] : points_of(g)) {
    if (p.claims != claims.size()) continue;
    ++all;
    held += p.held == p.claims;
  }
  return {held, all};
}

std::string share(const Group& g) {
  const auto [held, all] = held_of(g);
  return share_text(held, all);
}

std::string reading(const Group& g) {
  const auto [held, all] = held_of(g);
  return held == all ? "reproduced" : held > 0 ? "reproducible" : "not reproduced in the box";
}

std::string cheapest(const Group& g) {
  double fewest = kMissing;
  for (const auto& [settings, p] : points_of(g))
    if (p.held == p.claims && p.dispatches > 0) fewest = std::fmin(fewest, p.dispatches);
  return std::isfinite(fewest) ? fmt::format("{:.0f}", fewest) : std::string();
}

/// Lower end of the run's band. All claims of a point are in one band, because they share the settings.
double band_of_settings(const Row& r) {
  double n = 1;
  const json drawn = r.drawn();
  for (const json& settings : drawn["settings"])
    for (const char* name : {"iterations", "substeps"}) n *= settings.value(name, 1.0);
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
         "point. Fewest dispatches: the cheapest point, in dispatches per frame of its most expensive claim.",
         [](const Row& r) { return r.part == Part::Claims; }};
  v.keys = {solver_key(), {"claim", [](const Row& r) { return Texts{r.drawn().value("kind", ""), kTogether}; }}};
  v.columns = {{"reading", [](const Group& g, const Texts&) { return reading(g); }},
               {"holds", [](const Group& g, const Texts&) { return share(g); }},
               {"fewest dispatches", [](const Group& g, const Texts&) { return cheapest(g); }}};
  v.across = {key("", band_text), share, band_of_settings};
  v.by_key = true;
  return v;
}

}  // namespace

std::vector<View> reproduction_views() { return {claims()}; }

}  // namespace clothbench
