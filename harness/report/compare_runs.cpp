#include "report/compare_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

/// Probability of each value of U = #{(i, j): a_i < b_j} for m and n trials under the null hypothesis, where all orders
/// are equally likely. Recursion over the side that has the greatest trial.
std::vector<double> u_distribution(std::size_t m, std::size_t n) {
  std::vector<std::vector<std::vector<double>>> count(m + 1, std::vector<std::vector<double>>(n + 1));
  for (std::size_t i = 0; i <= m; ++i)
    for (std::size_t j = 0; j <= n; ++j) {
      std::vector<double>& now = count[i][j];
      now.assign(i * j + 1, 0);
      if (i == 0 || j == 0) {
        now[0] = 1;
        continue;
      }
      const double a = static_cast<double>(i) / static_cast<double>(i + j);  // P(the greatest is one of A's)
      for (std::size_t u = 0; u < count[i - 1][j].size(); ++u) now[u] += a * count[i - 1][j][u];
      for (std::size_t u = 0; u < count[i][j - 1].size(); ++u) now[u + i] += (1 - a) * count[i][j - 1][u];
    }
  return count[m][n];
}

bool differ(double a, double b) {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) != std::isnan(b);
  return !(std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b)));
}

std::string status(const RunRecord& c) { return status_with_class(c.outcome); }

/// Metrics that both runs have, with different versions of their rule.
std::vector<ComparedRun::Versions> differing_versions(const RunRecord& a, const RunRecord& b) {
  std::vector<ComparedRun::Versions> out;
  for (const MetricSeries& m : a.accuracy.metrics)
    for (const MetricSeries& n : b.accuracy.metrics)
      if (m.name == n.name && m.version != n.version) out.push_back({m.name, m.version, n.version});
  return out;
}

bool hangs_on(const std::string& name, const std::vector<ComparedRun::Versions>& versions) {
  const std::vector<std::string> behind = metrics_behind(name);
  return std::any_of(versions.begin(), versions.end(), [&](const auto& v) { return contains(behind, v.metric); });
}

void compare_run(ComparedRun& c) {
  c.versions = differing_versions(*c.a, *c.b);
  c.time = compare_times(trial_means(*c.a), trial_means(*c.b));
  if (status(*c.a) != status(*c.b)) c.outcome = status(*c.a) + " → " + status(*c.b);
  std::set<std::string> names;
  for (const RunRecord* r : {c.a, c.b})
    for (const auto& [name, unused] : r->summary)
      if (!is_of_machine(name) && !hangs_on(name, c.versions)) names.insert(name);
  for (const std::string& name : names) {
    const double a = summary_value(*c.a, name), b = summary_value(*c.b, name);
    if (differ(a, b)) c.metrics.push_back({name, a, b});
  }
  if (!c.metrics.empty() && c.outcome.empty()) c.apart = pair_of(*c.a, *c.b, "before").value;
}

std::string percent(double ratio) { return std::isfinite(ratio) ? fmt::format("{:+.1f} %", 100 * (ratio - 1)) : "–"; }

std::string verdict(const TimeRatio& t) {
  return !std::isfinite(t.ratio) ? "not timed" : t.noise() ? "noise" : t.ratio < 1 ? "faster" : "slower";
}

double mean_ms(const RunRecord& c) {
  const std::vector<double> t = trial_means(c);
  return t.empty() ? kMissing : 1e3 * middle(t);
}

}  // namespace

TimeRatio compare_times(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr std::size_t kMost = 40;
  TimeRatio out;
  if (a.empty() || b.empty()) return out;
  if (a.size() > kMost || b.size() > kMost) throw Error(fmt::format("comparing times: at most {} trials a run", kMost));
  std::vector<double> logs;
  double u = 0;
  for (const double x : a)
    for (const double y : b) {
      logs.push_back(std::log(y / x));
      u += x < y ? 1 : x == y ? 0.5 : 0;
    }
  std::sort(logs.begin(), logs.end());
  out.ratio = std::exp(middle(logs));
  const std::vector<double> at = u_distribution(a.size(), b.size());
  const double pairs = static_cast<double>(logs.size()), far = std::max(u, pairs - u);
  double tail = 0;
  for (std::size_t k = at.size(); k-- > 0 && static_cast<double>(k) >= far;) tail += at[k];
  out.p = std::min(1.0, 2 * tail);
  // The interval from the kth ratio to the kth last has level 1 - 2 P(U < k); takes the greatest k that keeps kLevel.
  std::size_t k = 1;
  double outside = at[0];
  for (; 2 * (k + 1) <= logs.size() && 1 - 2 * (outside + at[k]) >= kLevel; ++k) outside += at[k];
  out.level = 1 - 2 * outside;
  out.low = std::exp(logs[k - 1]);
  out.high = std::exp(logs[logs.size() - k]);
  return out;
}

std::vector<ComparedRun> compare_runs(const std::vector<RunRecord>& a, const std::vector<RunRecord>& b) {
  std::vector<ComparedRun> out;
  const auto find = [&](const std::string& name) {
    return std::find_if(out.begin(), out.end(), [&](const ComparedRun& c) { return c.name == name; });
  };
  for (const RunRecord& c : a) {
    const std::string name = run_name(c.header);
    if (find(name) != out.end())
      throw Error("compare: " + name + " occurs twice in the first folder; expected each run once");
    out.push_back({name, &c});
  }
  for (const RunRecord& c : b) {
    const std::string name = run_name(c.header);
    auto at = find(name);
    if (at == out.end()) at = out.insert(out.end(), ComparedRun{name});
    if (at->b != nullptr)
      throw Error("compare: " + name + " occurs twice in the second folder; expected each run once");
    at->b = &c;
  }
  for (ComparedRun& c : out)
    if (c.a != nullptr && c.b != nullptr) compare_run(c);
  return out;
}

std::vector<Table> comparison_tables(const std::vector<ComparedRun>& runs) {
  struct Difference {
    std::string run, what, a, b;
  };
  std::vector<Difference> differences;
  std::vector<ComparedRun> timed;
  std::size_t same = 0;
  std::vector<const RunRecord*> both;
  for (const ComparedRun& c : runs) {
    for (const RunRecord* r : {c.a, c.b})
      if (r != nullptr) both.push_back(r);
    if (c.a == nullptr || c.b == nullptr) {
      differences.push_back({c.name, "run", c.a != nullptr ? status(*c.a) : "–", c.b != nullptr ? status(*c.b) : "–"});
      continue;
    }
    if (std::isfinite(c.time.ratio)) timed.push_back(c);
    if (!c.outcome.empty()) differences.push_back({c.name, "outcome", status(*c.a), status(*c.b)});
    for (const ComparedRun::Change& m : c.metrics)
      differences.push_back({c.name, m.name, significant(m.a, 6), significant(m.b, 6)});
    if (std::isfinite(c.apart))
      differences.push_back({c.name, "positions, apart over L", "–", significant(c.apart, 3)});
    for (const ComparedRun::Versions& v : c.versions)
      differences.push_back(
          {c.name, v.metric, fmt::format("by version {}", v.a), fmt::format("by version {}: not compared", v.b)});
    same += c.outcome.empty() && c.metrics.empty() && c.versions.empty();
  }
  const Columns<ComparedRun> times = {
      {"", "run", &ComparedRun::name},
      {"", "A", [](auto& c) { return mean_ms(*c.a); }, digits(4), {"ms"}},
      {"", "B", [](auto& c) { return mean_ms(*c.b); }, digits(4), {"ms"}},
      {"", "change", [](auto& c) { return percent(c.time.ratio); }},
      {"", "95 % interval",
       [](auto& c) {
         return c.time.level >= kLevel ? percent(c.time.low) + " … " + percent(c.time.high) : "too few trials";
       }},
      {"", "p", [](auto& c) { return c.time.p; }, digits(2)},
      {"", "verdict", [](auto& c) { return verdict(c.time); }}};
  const Columns<Difference> results = {{"", "run", &Difference::run},
                                       {"", "what", &Difference::what},
                                       {"", "A", &Difference::a},
                                       {"", "B", &Difference::b}};
  const std::string of_times = fmt::format(
      "Times: median of the trials' means. Change: median of all pairwise ratios. p: Mann and Whitney's U "
      "test, exact. *noise*: p is above 5 %, the interval holds 0, or there are too few trials. Of {} runs "
      "without any difference, about {:.0f} would be called faster or slower by chance.",
      timed.size(), 0.05 * static_cast<double>(timed.size()));
  const std::string of_results = fmt::format(
      "{} runs have the same outcome and the same results (to 1e-9). Values that depend on the machine are "
      "not compared here.",
      same);
  return {
      times.table({"Time of a frame, A against B", with_withheld(of_times, both, {"frame_wall_median_s"}), {}}, timed),
      results.table({"Results that differ", of_results, {}}, differences)};
}

nlohmann::json comparison_json(const std::vector<ComparedRun>& runs) {
  nlohmann::json out = nlohmann::json::array();
  for (const ComparedRun& c : runs) {
    nlohmann::json row = {{"run", c.name},
                          {"in_a", c.a != nullptr},
                          {"in_b", c.b != nullptr},
                          {"outcome", c.outcome},
                          {"verdict", verdict(c.time)},
                          {"ratio", finite_or_null(c.time.ratio)},
                          {"low", finite_or_null(c.time.low)},
                          {"high", finite_or_null(c.time.high)},
                          {"level", finite_or_null(c.time.level)},
                          {"p", finite_or_null(c.time.p)},
                          {"apart", finite_or_null(c.apart)},
                          {"metrics", nlohmann::json::object()}};
    for (const ComparedRun::Versions& v : c.versions) row["versions"][v.metric] = {v.a, v.b};
    for (const ComparedRun::Change& m : c.metrics) row["metrics"][m.name] = {finite_or_null(m.a), finite_or_null(m.b)};
    out.push_back(std::move(row));
  }
  return out;
}

nlohmann::json history_json(const std::vector<RunRecord>& runs) {
  nlohmann::json out = nlohmann::json::array();
  for (const RunRecord& c : runs) {
    const std::string name = run_name(c.header);
    const auto& e = c.header.environment;
    const std::string extra =
        "status " + c.outcome.status +
        (e.is_object() && e.contains("gpu") && e["gpu"].is_string() ? ", " + e["gpu"].get<std::string>() : "");
    if (const std::vector<double> t = trial_means(c); !t.empty())
      out.push_back({{"name", name + " frame"},
                     {"unit", "ms"},
                     {"value", 1e3 * middle(t)},
                     {"range", fmt::format("± {:.3g}", 1e3 * (t.back() - t.front()) / 2)},
                     {"extra", extra}});
    for (const char* error : {"free_fall_error", "truth_error", "tunnelled_fraction_max"})
      if (const double v = summary_value(c, error); std::isfinite(v))
        out.push_back({{"name", name + " " + error}, {"unit", "1"}, {"value", v}, {"extra", extra}});
  }
  return out;
}

}  // namespace clothbench
