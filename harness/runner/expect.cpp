#include "runner/expect.hpp"

#include <fmt/format.h>

#include <cmath>

#include "metrics/collider_contact.hpp"
#include "metrics/registry.hpp"

namespace clothbench {
namespace {

bool measured(const Scene& scene, const Outcome& outcome, const AccuracyPass& pass) {
  if (outcome.status == "unsupported" || outcome.status == "over_budget" || outcome.status == "error") return false;
  if (!kWithContactMetrics && !scene.colliders.empty()) return false;
  return outcome.status != "ok" || pass.time_s.size() == static_cast<std::size_t>(scene.time.frames()) + 1;
}

/// What is wrong with a value, or nothing.
std::string fault(const Expectation& e, double value) {
  if (!std::isfinite(value)) return e.name + " has no value";
  if (e.at_most && !(value <= *e.at_most)) return fmt::format("{} {:.4g} > {:.4g}", e.name, value, *e.at_most);
  if (e.at_least && !(value >= *e.at_least)) return fmt::format("{} {:.4g} < {:.4g}", e.name, value, *e.at_least);
  return "";
}

/// The checks that hold for every scene; a NaN fails.
std::string fault_of_motion(const std::map<std::string, double>& summary) {
  std::string wrong;
  for (const motion_check::Statistic& s : motion_check::statistics()) {
    const auto at = summary.find(kMotionCheck + s.name);
    if (at == summary.end() || at->second <= 1) continue;
    wrong += (wrong.empty() ? "" : "; ") +
             fmt::format("{} ({}) {:.3g} times its tolerance", s.name, motion_check::name_of(s.check), at->second);
  }
  return wrong;
}

}  // namespace

Verdict judge(const Scene& scene, const Outcome& outcome, const AccuracyPass& pass,
              const std::map<std::string, double>& summary) {
  Verdict v;
  const bool known = measured(scene, outcome, pass);
  const auto note = [&](const std::string& name, const std::string& wrong) {
    v.scalars[kExpect + name] = !known ? kMissing : wrong.empty() ? 1 : 0;
    if (!wrong.empty()) v.text += (v.text.empty() ? "fail: " : "; ") + wrong;
  };
  if (!scene.expected_outcome.empty())
    note("outcome", outcome.status == scene.expected_outcome
                        ? ""
                        : "outcome " + outcome.status + ", expected " + scene.expected_outcome);
  const std::string wrong_motion = fault_of_motion(summary);
  if (summary.contains(kMotionCheck + "finite")) v.scalars[kExpect + "motion"] = wrong_motion.empty() ? 1 : 0;
  if (!wrong_motion.empty()) v.text += (v.text.empty() ? "fail: " : "; ") + wrong_motion;
  for (const Expectation& e : scene.expect) {
    const auto at = summary.find(e.name);
    note(e.name, fault(e, at == summary.end() ? kMissing : at->second));
  }
  if (!known && wrong_motion.empty())
    v.text = "not measured";
  else if (v.text.empty())
    v.text = "pass";
  return v;
}

}  // namespace clothbench
