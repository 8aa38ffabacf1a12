#include "report/withheld.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/words.hpp"
#include "metrics/registry.hpp"
#include "report/grid.hpp"

namespace clothbench {
namespace {

void take_out(RunRecord& c, const std::string& name, const std::string& why) {
  c.summary[name] = kMissing;
  c.withheld[name] = why;
}

bool was_timed(const RunRecord& c) { return std::isfinite(summary_value(c, "frame_wall_median_s")); }

/// The newest version of each metric among the runs.
std::map<std::string, int> newest_versions(const std::vector<RunRecord>& runs) {
  std::map<std::string, int> out;
  for (const RunRecord& c : runs)
    for (const MetricSeries& m : c.accuracy.metrics) out[m.name] = std::max(out[m.name], m.version);
  return out;
}

/// "fail: a 2 > 1; b 3 > 2" without the bounds of these names; "not measured" if no other bound is broken.
std::string verdict_without(const std::string& text, const std::set<std::string>& names) {
  const std::string broken = "fail: ", between = "; ";
  if (!text.starts_with(broken)) return text == "pass" ? "not measured" : text;
  std::string out;
  for (std::size_t at = broken.size(), end = 0; at <= text.size(); at = end + between.size()) {
    end = std::min(text.find(between, at), text.size());
    const std::string part = text.substr(at, end - at);
    if (!names.contains(part.substr(0, part.find(' ')))) out += (out.empty() ? "" : between) + part;
  }
  return out.empty() ? "not measured" : broken + out;
}

void withhold_versions(RunRecord& c, const std::map<std::string, int>& newest) {
  std::map<std::string, std::string> why;  // by metric
  for (const MetricSeries& m : c.accuracy.metrics)
    if (m.version < newest.at(m.name))
      why[m.name] = fmt::format("{} was measured by version {} of its definition; the newest here is {}", m.name,
                                m.version, newest.at(m.name));
  if (why.empty()) return;
  std::erase_if(c.accuracy.metrics, [&](const MetricSeries& m) { return why.contains(m.name); });
  std::set<std::string> bounds;
  for (const auto& [name, value] : std::map(c.summary)) {
    for (const std::string& metric : metrics_behind(name)) {
      if (!why.contains(metric)) continue;
      take_out(c, name, why.at(metric));
      if (name.starts_with(kExpect)) bounds.insert(name.substr(kExpect.size()));
      break;
    }
  }
  if (!bounds.empty()) c.outcome.expect = verdict_without(c.outcome.expect, bounds);
}

}  // namespace

bool is_time(const std::string& name) {
  static const std::set<std::string> names = {"load_s", "untimed_s"};
  if (names.contains(name)) return true;
  for (const char* start : {"fps_", "frame_", "bandwidth_", "stage_device_"})
    if (name.starts_with(start)) return true;
  return false;
}

double jobs_of(const RunRecord& c) {
  if (const double stored = summary_value(c, "jobs"); std::isfinite(stored)) return stored;
  const nlohmann::json jobs = environment_of(c, "jobs");
  return jobs.is_number() ? jobs.get<double>() : kMissing;
}

void withhold_times(std::vector<RunRecord>& runs) {
  double most = 1;
  for (const RunRecord& c : runs)
    if (const double jobs = jobs_of(c); jobs > most) most = jobs;
  const std::string why = fmt::format("not timed alone: up to {:.0f} jobs ran side by side", most);
  for (RunRecord& c : runs) {
    if (!(jobs_of(c) > 1)) continue;
    for (const auto& [name, value] : std::map(c.summary))
      if (is_time(name) && std::isfinite(value)) take_out(c, name, why);
    c.header.load_s = kMissing;
    c.trials.clear();
  }
}

void withhold_old_versions(std::vector<RunRecord>& runs) {
  const std::map<std::string, int> newest = newest_versions(runs);
  for (RunRecord& c : runs) withhold_versions(c, newest);
}

void withhold(std::vector<RunRecord>& runs) {
  withhold_times(runs);
  withhold_old_versions(runs);
}

std::string withheld_note(const std::vector<const RunRecord*>& runs, const std::vector<std::string>& names) {
  std::set<std::string> reasons;
  for (const RunRecord* c : runs)
    for (const std::string& name : names)
      if (const auto at = c->withheld.find(name); at != c->withheld.end()) reasons.insert(at->second);
  return reasons.empty() ? "" : "Not printed (–): " + joined(reasons, "; ") + ".";
}

std::string with_withheld(const std::string& note, const std::vector<const RunRecord*>& runs,
                          const std::vector<std::string>& names) {
  const std::string more = withheld_note(runs, names);
  return note + (note.empty() || more.empty() ? "" : " ") + more;
}

std::string withheld_of(const RunRecord& c, const std::vector<std::string>& names) {
  std::set<std::string> reasons;
  for (const std::string& name : names)
    if (const auto at = c.withheld.find(name); at != c.withheld.end()) reasons.insert(at->second);
  return joined(reasons, "; ");
}

std::vector<std::string> withheld_lines(const std::vector<RunRecord>& runs) {
  std::map<std::string, std::size_t> reasons;
  std::size_t silent = 0;
  for (const RunRecord& c : runs) {
    std::set<std::string> of;
    for (const auto& [unused, why] : c.withheld) of.insert(why);
    for (const std::string& why : of) ++reasons[why];
    silent += was_timed(c) && !std::isfinite(jobs_of(c));
  }
  std::vector<std::string> out;
  for (const auto& [why, count] : reasons)
    out.push_back(fmt::format("Not printed (–), {} run{}: {}.", count, count == 1 ? "" : "s", why));
  if (silent > 0)
    out.push_back(fmt::format("{} of the timed runs {} from files that do not state whether other jobs ran beside {}.",
                              silent, silent == 1 ? "is" : "are", silent == 1 ? "it" : "them"));
  return out;
}

}  // namespace clothbench
