#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "check/compare.hpp"
#include "clothbench/error.hpp"
#include "report/run_table.hpp"

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
  for (const RunRecord* r : processes) {
    std::vector<double> trials;
    for (const TimedTrial& t : r->trials)
      if (t.frames() > 0) trials.push_back(mean(t.frame_wall_s));
    if (!trials.empty()) out.push_back(median(std::move(trials)));
  }
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
  return changes >= m * n / (m + n);
}

}  // namespace clothbench
