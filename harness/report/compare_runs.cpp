#include "report/compare_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "base/json_number.hpp"
#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "metrics/registry.hpp"
#include "report/grid.hpp"
#include "report/pairs.hpp"
#include "report/withheld.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

constexpr double kLevel = 0.95;

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// For every assignment of the logarithms to two sides of the same sizes but the actual one: the shift of B at which it
/// has the same difference of means as the actual one. That is the mean of those that change sides, B's minus A's.
/// Ascending.
std::vector<double> shifts_of(const std::vector<double>& a, const std::vector<double>& b) {
  const std::size_t m = a.size(), n = m + b.size();
  const std::uint32_t actual = (1u << m) - 1, end = 1u << n;
  std::vector<double> out;
  // Gosper's hack: the next larger number with as many bits.
  for (std::uint32_t on_a = actual; on_a < end;) {
    double moved = 0;
    int count = 0;
    for (std::size_t k = 0; k < n; ++k) {
      const bool is_a = (on_a >> k & 1u) != 0;
      if (k < m && !is_a) moved -= a[k];
      if (k >= m && is_a) {
        moved += b[k - m];
        ++count;
      }
    }
    if (on_a != actual) out.push_back(moved / count);
    const std::uint32_t low = on_a & (0u - on_a), next = on_a + low;
    on_a = next | (((on_a ^ next) >> 2) / low);
  }
  std::sort(out.begin(), out.end());
  return out;
}

bool differ(double a, double b) {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) != std::isnan(b);
  return !(std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b)));
}

std::string status(const RunRecord& c) { return status_with_class(c.outcome); }

void compare_results(ComparedRun& c) {
  const RunRecord &a = *c.a.front(), &b = *c.b.front();
  if (status(a) != status(b)) c.outcome = status(a) + " → " + status(b);
  std::set<std::string> names;
  for (const RunRecord* r : {&a, &b})
    for (const auto& [name, unused] : r->summary)
      if (!is_of_machine(name)) names.insert(name);
  for (const std::string& name : names) {
    const double x = summary_value(a, name), y = summary_value(b, name);
    if (differ(x, y)) c.metrics.push_back({name, x, y});
  }
  if (!c.metrics.empty() && c.outcome.empty()) c.apart = pair_of(a, b, "before").value;
}

/// Adds what differs between the first run of A and every other one. An order without turns is no difference of the
/// runs, only no basis for a statement on times.
void add_differences(ComparedRun& c, const std::vector<std::string>& allowed, DifferingRuns& differing) {
  const RunRecord& first = *c.a.front();
  const std::vector<Condition> conditions = conditions_of(first);
  std::vector<std::string> kinds;
  for (const auto* side : {&c.a, &c.b})
    for (const RunRecord* r : *side)
      for (ConditionDifference d : differences(conditions, conditions_of(*r))) {
        if (d.kind == "scene") d.what += " (" + scene_difference(first, *r) + ")";
        differing.add(c.name, d);
        if (!contains(kinds, d.kind)) kinds.push_back(d.kind);
      }
  c.in_turns = in_turns(c.a, c.b);
  if (!c.in_turns && contains(allowed, std::string("order"))) {
    differing.add(c.name, {"order", "processes", "A", "B one after the other, not in turns"});
    kinds.emplace_back("order");
    c.in_turns = true;
  }
  c.marks = joined(kinds);
}

std::string percent(double ratio) { return std::isfinite(ratio) ? fmt::format("{:+.1f} %", 100 * (ratio - 1)) : "–"; }

std::string verdict(const ComparedRun& c) {
  const TimeRatio& t = c.time;
  const std::string out = !std::isfinite(t.ratio) ? "not timed"
                          : !t.enough()           ? fmt::format("too few processes: at least {} a side", kMinProcesses)
                          : !c.in_turns           ? "no statement: A and B did not run in turns"
                          : t.noise()             ? "noise"
                          : t.ratio < 1           ? "faster"
                                                  : "slower";
  return c.marks.empty() ? out : out + "; other " + c.marks;
}

double median_ms(const std::vector<const RunRecord*>& side) {
  std::vector<double> t = process_times(side);
  std::sort(t.begin(), t.end());
  return t.empty() ? kMissing : 1e3 * middle(t);
}

}  // namespace

TimeRatio compare_times(const std::vector<double>& a, const std::vector<double>& b) {
  TimeRatio out;
  out.processes_a = a.size();
  out.processes_b = b.size();
  if (a.empty() || b.empty()) return out;
  if (a.size() > kMaxProcesses || b.size() > kMaxProcesses)
    throw Error(fmt::format("compare: {} and {} processes; at most {} on each side: leave out some folders", a.size(),
                            b.size(), kMaxProcesses));
  std::vector<double> p, q;
  for (const double t : a) p.push_back(std::log(t));
  for (const double t : b) q.push_back(std::log(t));
  out.ratio = std::exp(mean(q) - mean(p));
  if (!out.enough()) return out;
  const std::vector<double> shifts = shifts_of(p, q);
  const double assignments = static_cast<double>(shifts.size()) + 1;
  const auto tail = [&](auto is) {
    return (1 + static_cast<double>(std::count_if(shifts.begin(), shifts.end(), is))) / assignments;
  };
  out.p = std::min({1.0, 2 * tail([](double s) { return !(s > 0); }), 2 * tail([](double s) { return !(s < 0); })});
  const auto rejected = static_cast<std::size_t>((1 - kLevel) / 2 * assignments);
  out.low = std::exp(shifts[rejected - 1]);
  out.high = std::exp(shifts[shifts.size() - rejected]);
  return out;
}

std::vector<double> process_times(const std::vector<const RunRecord*>& processes) {
  std::vector<double> out;
  for (const RunRecord* r : processes)
    if (const std::vector<double> t = trial_means(*r); !t.empty()) out.push_back(middle(t));
  return out;
}

bool in_turns(const std::vector<const RunRecord*>& a, const std::vector<const RunRecord*>& b) {
  std::vector<std::pair<double, bool>> order;  // start, on B
  for (const auto* side : {&a, &b})
    for (const RunRecord* r : *side) {
      if (r->trials.empty() || !std::isfinite(r->trials.front().start_unix_s)) return true;
      order.emplace_back(r->trials.front().start_unix_s, side == &b);
    }
  std::sort(order.begin(), order.end());
  double changes = 0;
  for (std::size_t k = 1; k < order.size(); ++k) changes += order[k].second != order[k - 1].second ? 1 : 0;
  const auto m = static_cast<double>(a.size()), n = static_cast<double>(b.size());
  return changes >= std::floor(2 * m * n / (m + n));
}

Comparison compare_runs(const Processes& a, const Processes& b, const std::vector<std::string>& allowed) {
  Comparison out{{}, DifferingRuns(allowed)};
  const auto add = [&](const Processes& side, std::vector<const RunRecord*> ComparedRun::*to) {
    for (const std::vector<RunRecord>& process : side) {
      std::set<std::string> seen;
      for (const RunRecord& r : process) {
        const std::string name = run_name(r.header);
        if (!seen.insert(name).second)
          throw Error("compare: " + name + " occurs twice in one folder; expected each run once");
        const auto is = [&](const ComparedRun& c) { return c.name == name; };
        (find_or_add(out.runs, is, ComparedRun{name, {}, {}}).*to).push_back(&r);
      }
    }
  };
  add(a, &ComparedRun::a);
  add(b, &ComparedRun::b);
  for (ComparedRun& c : out.runs)
    if (!c.a.empty() && !c.b.empty()) add_differences(c, allowed, out.differing);
  out.differing.refuse("A", "B");
  for (ComparedRun& c : out.runs)
    if (!c.a.empty() && !c.b.empty()) {
      c.time = compare_times(process_times(c.a), process_times(c.b));
      compare_results(c);
    }
  return out;
}

std::vector<Table> comparison_tables(const Comparison& comparison) {
  struct Difference {
    std::string run, what, a, b;
  };
  std::vector<Difference> differences;
  std::vector<ComparedRun> timed;
  std::size_t same = 0;
  std::vector<const RunRecord*> both;
  for (const ComparedRun& c : comparison.runs) {
    both.insert(both.end(), c.a.begin(), c.a.end());
    both.insert(both.end(), c.b.begin(), c.b.end());
    const auto ended = [](const auto& side) { return side.empty() ? "–" : status(*side.front()); };
    if (c.a.empty() || c.b.empty()) {
      differences.push_back({c.name, "run", ended(c.a), ended(c.b)});
      continue;
    }
    if (std::isfinite(c.time.ratio)) timed.push_back(c);
    if (!c.outcome.empty()) differences.push_back({c.name, "outcome", ended(c.a), ended(c.b)});
    for (const ComparedRun::Change& m : c.metrics)
      differences.push_back({c.name, m.name, significant(m.a, 6), significant(m.b, 6)});
    if (std::isfinite(c.apart))
      differences.push_back({c.name, "positions, apart over L", "–", significant(c.apart, 3)});
    same += c.outcome.empty() && c.metrics.empty();
  }
  const Columns<ComparedRun> times = {
      {"", "run", &ComparedRun::name},
      {"", "A", [](auto& c) { return median_ms(c.a); }, digits(4), {"ms"}},
      {"", "B", [](auto& c) { return median_ms(c.b); }, digits(4), {"ms"}},
      {"", "change", [](auto& c) { return percent(c.time.ratio); }},
      {"", "processes", [](auto& c) { return fmt::format("{} and {}", c.time.processes_a, c.time.processes_b); }},
      {"", "95 % interval",
       [](auto& c) { return c.time.enough() ? percent(c.time.low) + " … " + percent(c.time.high) : "–"; }},
      {"", "p", [](auto& c) { return c.time.p; }, digits(2)},
      {"", "verdict", [](auto& c) { return verdict(c); }}};
  const Columns<Difference> results = {{"", "run", &Difference::run},
                                       {"", "what", &Difference::what},
                                       {"", "A", &Difference::a},
                                       {"", "B", &Difference::b}};
  const std::string of_times = fmt::format(
      "Times: median over the processes. Change: ratio of their geometric means. p: permutation test over the "
      "processes, "
      "exact. *noise*: the 95 % interval contains 0. Of {} runs without any difference, about {:.0f} would be called "
      "faster or slower by chance.",
      timed.size(), (1 - kLevel) * static_cast<double>(timed.size()));
  const std::string of_results = fmt::format(
      "{} runs have the same outcome and the same results (to 1e-9). Values that depend on the machine are "
      "not compared here.",
      same);
  return {
      times.table({"Time of a frame, A against B", with_withheld(of_times, both, {"frame_wall_median_s"}), {}}, timed),
      results.table({"Results that differ", of_results, {}}, differences)};
}

nlohmann::json comparison_json(const Comparison& comparison) {
  nlohmann::json out = {{"overridden", comparison.differing.json()}, {"runs", nlohmann::json::array()}};
  for (const ComparedRun& c : comparison.runs) {
    nlohmann::json row = {{"run", c.name},
                          {"in_a", !c.a.empty()},
                          {"in_b", !c.b.empty()},
                          {"outcome", c.outcome},
                          {"verdict", verdict(c)},
                          {"overridden", c.marks},
                          {"processes", {c.time.processes_a, c.time.processes_b}},
                          {"ratio", finite_or_null(c.time.ratio)},
                          {"low", finite_or_null(c.time.low)},
                          {"high", finite_or_null(c.time.high)},
                          {"p", finite_or_null(c.time.p)},
                          {"apart", finite_or_null(c.apart)},
                          {"metrics", nlohmann::json::object()}};
    for (const ComparedRun::Change& m : c.metrics) row["metrics"][m.name] = {finite_or_null(m.a), finite_or_null(m.b)};
    out["runs"].push_back(std::move(row));
  }
  return out;
}

}  // namespace clothbench
