// Outcome classes of a run; StabilityJudge evaluates the frames.
#include "metrics/registry.hpp"
#include "metrics/stability/judge.hpp"

namespace clothbench {
namespace {

bool is_judged(const Scene& s) { return !s.stability.name.empty(); }
bool with_judge(const RunView& r) { return is_judged(r.scene); }

/// 0 stable, 1 degraded, 2 failed (also if the run ends early without a sign in its frames); none if unsupported.
double grade(const RunView& r) {
  using enum StabilityVerdict::Grade;
  if (r.outcome.status == "unsupported") return kMissing;
  return static_cast<double>(r.outcome.status == "ok" ? stability_verdict(r.pass).grade : Failed);
}

}  // namespace

MetricGroup stability_metrics() {
  constexpr Needs kJudged{"a stability block", is_judged};
  return {{{"stability_classes", "1", "outcome classes of the frame: sum of 2^k over F0 to F2", kJudged,
            [](const MetricFrame& f) { return static_cast<double>(f.stability->classes); }}},
          {{"stability_grade", own({"stability_classes"}, "0 stable, 1 degraded, 2 failed", grade, "1"), Expect::No,
            nullptr, with_judge}}};
}

}  // namespace clothbench
