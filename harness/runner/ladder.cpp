#include <fmt/format.h>

#include <algorithm>

#include "runner/study_runner.hpp"

namespace clothbench {

std::string LadderBudget::refused(const RunSpec& spec) const {
  const auto at = by_solver_.find(spec.entry->info.name);
  if (spec.work == 0 || at == by_solver_.end()) return "";
  const Climbed& c = at->second;
  if (c.timed_out_work > 0 && spec.work > c.timed_out_work)
    return fmt::format("not run: {} times the work of a setting that timed out", spec.work / c.timed_out_work);
  const double expected_s = c.last_s * spec.work / c.last_work;
  if (limit_s_ > 0 && c.seconds + expected_s > limit_s_)
    return fmt::format(
        "not run: it would take about {:.2g} s, but only {:.2g} of the {:g} s of its solver's ladder are left",
        expected_s, std::max(0.0, limit_s_ - c.seconds), limit_s_);
  return "";
}

void LadderBudget::spent(const RunSpec& spec, double seconds, const std::string& status) {
  if (spec.work == 0) return;
  Climbed& c = by_solver_[spec.entry->info.name];
  c.seconds += seconds;
  c.last_s = seconds;
  c.last_work = spec.work;
  if (status == "timed_out" && (c.timed_out_work == 0 || spec.work < c.timed_out_work)) c.timed_out_work = spec.work;
}

double LadderBudget::run_limit_s(const RunSpec& spec, double run_limit_s) const {
  if (spec.work == 0 || limit_s_ == 0) return run_limit_s;
  const auto at = by_solver_.find(spec.entry->info.name);
  const double left_s = limit_s_ - (at == by_solver_.end() ? 0 : at->second.seconds);
  const double own_s = std::max(left_s, limit_s_ / 2);
  return run_limit_s > 0 ? std::min(run_limit_s, own_s) : own_s;
}

}  // namespace clothbench
