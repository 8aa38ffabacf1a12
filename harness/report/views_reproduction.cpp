// Tables of study `reproduction`: for which values of what the article leaves open its claims hold.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/interval.hpp"
#include "metrics/registry.hpp"
#include "report/view.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr const char* kTogether = "all";
/// Lower ends of the bands of dispatches per frame; the settings assumed for `paper` take 15 of a hanging cloth.
constexpr std::array kDispatches = {0.0, 30.0, 100.0, 300.0, 1000.0};

bool is_claim(const Row& r) { return r.part == Part::Generated && r.drawn().contains("settings"); }

/// True if the run keeps every bound of the claim. The motion check is no part of a claim.
bool holds(const Row& r) {
  if (r.status() != "ok") return false;
  return std::all_of(r.run->summary.begin(), r.run->summary.end(), [](const auto& value) {
    const std::string& name = value.first;
    return !name.starts_with(kExpect) || name == std::string(kExpect) + "motion" || value.second == 1;
  });
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

/// Points of the group at which all of its claims hold, of how many.
std::pair<std::size_t, std::size_t> held_of(const Group& g) {
  const auto points = points_of(g);
  const auto held =
      std::count_if(points.begin(), points.end(), [](const auto& p) { return p.second.held == p.second.claims; });
  return {static_cast<std::size_t>(held), points.size()};
}

std::string share(const Group& g) {
  const auto [held, all] = held_of(g);
  const Interval i = wilson_95(held, all);
  return fmt::format("{}/{} ({:.0f}–{:.0f} %)", held, all, 100 * i.low, 100 * i.high);
}

std::string reading(const Group& g) {
  const auto [held, all] = held_of(g);
  return held == all ? "reproduced" : held > 0 ? "reproducible" : "not reproduced in the box";
}

std::string cheapest(const Group& g) {
  const Point* least = nullptr;
  const auto points = points_of(g);
  for (const auto& [settings, p] : points)
    if (p.held == p.claims && p.dispatches > 0 && (least == nullptr || p.dispatches < least->dispatches)) least = &p;
  return least == nullptr ? std::string() : fmt::format("{:.0f}", least->dispatches);
}

double cost_of(const Row& r) {
  const double d = r.value("dispatches");
  return *std::find_if(kDispatches.rbegin(), kDispatches.rend() - 1, [&](double low) { return d >= low; });
}

std::string band(const Row& r) {
  const auto next = std::upper_bound(kDispatches.begin(), kDispatches.end(), cost_of(r));
  return next == kDispatches.end() ? fmt::format("≥ {:g} dispatches", cost_of(r))
                                   : fmt::format("{:g}–{:g} dispatches", cost_of(r), *next - 1);
}

View claims() {
  View v{"contact", "Claims of the article, over what it leaves open",
         "Share of the points of the box at which a claim holds, with Wilson's 95 % interval, and by the dispatches of "
         "a frame, which are the cost of a setting on any device. Reproduced: holds at every point; reproducible: at "
         "some. All: every claim holds at one point.",
         is_claim};
  v.keys = {solver_key(), {"claim", [](const Row& r) { return Texts{r.drawn().value("kind", ""), kTogether}; }}};
  v.columns = {{"reading", [](const Group& g, const Texts&) { return reading(g); }},
               {"holds", [](const Group& g, const Texts&) { return share(g); }},
               {"fewest dispatches", [](const Group& g, const Texts&) { return cheapest(g); }}};
  v.across = {key("", band), share, cost_of};
  v.by_key = true;
  return v;
}

}  // namespace

std::vector<View> reproduction_views() { return {claims()}; }

}  // namespace clothbench
