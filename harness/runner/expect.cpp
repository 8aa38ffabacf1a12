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

double value_of(const std::map<std::string, double>& summary, const std::string& name) {
  const auto at = summary.find(name);
  return at == summary.end() ? kMissing : at->second;
}

/// Bounds that the scene's file states and that follow from the scene itself: the bounds of its exact solution, and
/// none of the outcome classes that its stability block judges.
std::vector<Expectation> expectations(const Scene& scene, const std::map<std::string, double>& summary) {
  std::vector<Expectation> all = scene.expect;
  if (!scene.reference_case.empty())
    for (const char* scalar : kExactlyBounded) all.push_back({scalar, {}, value_of(summary, scalar + kBound)});
  if (!scene.stability.name.empty()) all.push_back({"stability_grade", {}, 0});
  return all;
}

std::string expected_outcome(const Scene& scene) {
  const bool implied = !scene.reference_case.empty() || !scene.stability.name.empty();
  return scene.expected_outcome.empty() && implied ? "ok" : scene.expected_outcome;
}

/// The fault of a value, or nothing.
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
  const std::string expected = expected_outcome(scene);
  const std::vector<Expectation> bounds = expectations(scene, summary);
  const bool checked = summary.contains(kMotionCheck + "finite");
  if (expected.empty() && bounds.empty() && !checked) return v;
  const bool known = measured(scene, outcome, pass);
  const auto note = [&](const std::string& name, const std::string& wrong) {
    v.scalars[kExpect + name] = !known ? kMissing : wrong.empty() ? 1 : 0;
    if (!wrong.empty() && known) v.text += (v.text.empty() ? "fail: " : "; ") + wrong;
  };
  if (!expected.empty())
    note("outcome", outcome.status == expected ? "" : "outcome " + outcome.status + ", expected " + expected);
  // The motion is judged as far as it goes; the scene's own bounds need all of it.
  const std::string wrong_motion = fault_of_motion(summary);
  if (checked) v.scalars[kExpect + "motion"] = wrong_motion.empty() ? 1 : 0;
  if (!wrong_motion.empty()) v.text += (v.text.empty() ? "fail: " : "; ") + wrong_motion;
  for (const Expectation& e : bounds) note(e.name, fault(e, value_of(summary, e.name)));
  if (!known && wrong_motion.empty())
    v.text = "not measured";
  else if (v.text.empty())
    v.text = "pass";
  return v;
}

}  // namespace clothbench
