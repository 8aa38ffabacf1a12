#include <fmt/format.h>

#include <map>

#include "clothbench/feature.hpp"
#include "metrics/registry.hpp"
#include "report/run_table.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

/// True if the solver declares that it ignores attachments and every kind of collider: met bounds then prove nothing.
bool touches_nothing(const RunRecord& c) {
  const json features = environment_of(c, "solver_features");
  if (!features.is_object() || !features.contains("ignores")) return false;
  const json& ignored = features["ignores"];
  bool all = contains(ignored, name_of(Feature::MovingPins));
  kColliderFeatures.for_each([&](Feature f) { all = all && contains(ignored, name_of(f)); });
  return all;
}

/// The run's criteria by name: 1 met, 0 violated, NaN not measured.
std::map<std::string, double> bounds(const RunRecord& c) {
  std::map<std::string, double> out;
  for (const auto& [name, v] : c.summary)
    if (name.starts_with(kExpect)) out[name.substr(kExpect.size())] = v;
  return out;
}

}  // namespace

std::vector<std::string> violated_bounds(const RunRecord& c) {
  std::vector<std::string> out;
  for (const auto& [name, met] : bounds(c))
    if (met == 0) out.push_back(name);
  return out;
}

std::string verdict(const RunRecord& c) {
  if (c.outcome.status != "ok") return ending(c.outcome);
  if (c.outcome.expect.starts_with("fail")) return "fail";
  const std::map<std::string, double> all = bounds(c);
  if (all.empty()) return kNoVerdict;
  if (!violated_bounds(c).empty()) return "fail";
  if (std::any_of(all.begin(), all.end(), [](const auto& b) { return std::isnan(b.second); })) return "not measured";
  return has_contact(c) && touches_nothing(c) ? "ignored" : "pass";
}

std::size_t bounds_of(const RunRecord& c) {
  const std::map<std::string, double> all = bounds(c);
  std::size_t found = all.size() - all.count("outcome");
  const json scenario = scenario_of(c);
  if (const json expect = scenario.value("expect", json()); expect.is_object())
    found = std::max(found, expect.size() - expect.count("outcome"));
  // A run that is not ok has at least one bound, the motion check of every cloth, which it did not pass.
  return found == 0 && c.outcome.status != "ok" && scenario.contains("cloth") ? 1 : found;
}

std::string VerdictCounts::text() const {
  std::string out = fmt::format("{} of {} runs passed", passed, runs);
  for (const auto& [count, what] : {std::pair{failed(), "failed"},
                                    {ignored, "ignored contact"},
                                    {unsupported, "unsupported"},
                                    {not_measured, "not measured"}})
    if (count > 0) out += fmt::format(", {} {}", count, what);
  return out;
}

void VerdictCounts::add(const RunRecord& c) {
  if (c.outcome.status == "missing" || bounds_of(c) == 0) return;
  ++runs;
  const std::string v = verdict(c);
  passed += v == "pass";
  ignored += v == "ignored";
  unsupported += v == "unsupported";
  not_measured += v == "not measured" || v == kNoVerdict || v == "over_budget";
}

VerdictCounts count_verdicts(const std::vector<RunRecord>& runs) {
  VerdictCounts out;
  for (const RunRecord& c : runs) out.add(c);
  return out;
}

}  // namespace clothbench
