// Outcome classes of a run and the quantities that decide them; StabilityJudge evaluates the frames.
#include <cmath>

#include "metrics/reduction.hpp"
#include "metrics/stability/judge.hpp"

namespace clothbench {
namespace {

bool is_judged(const Scene& s) { return !s.stability.name.empty(); }
bool with_judge(const RunView& r) { return is_judged(r.scene); }

auto judged_field(double StabilityFrame::*field) {
  return [field](const MetricFrame& f) { return f.stability->*field; };
}

/// Greatest over the frames that count; NaN frames do not.
Reduction greatest_known(const char* series) {
  return {{series}, "greatest of the frames that count", [name = std::string(series)](const RunView& r) {
            double most = kMissing;
            for (const MetricSeries& m : r.pass.metrics)
              for (std::size_t f = 0; m.name == name && f < m.values.size(); ++f)
                if (!std::isnan(m.values[f]) && !(m.values[f] <= most)) most = m.values[f];
            return most;
          }};
}

/// Verdict from the frames. A run that ended early for a reason that its frames do not show has failed too: F8.
StabilityVerdict verdict_of(const RunView& r) {
  const StabilityVerdict v = stability_verdict(r.pass);
  const Outcome& o = r.outcome;
  if (o.status == "ok" || v.grade == StabilityVerdict::Grade::Failed) return v;
  return {StabilityVerdict::Grade::Failed, o.klass == "ok" ? "F8" : o.klass, o.failed_frame};
}

/// A value of the verdict; none for a scene that the solver does not run.
Reduction of_verdict(const char* doc, double (*value)(const StabilityVerdict&)) {
  return {{"stability_classes"},
          doc,
          [value](const RunView& r) { return r.outcome.status == "unsupported" ? kMissing : value(verdict_of(r)); },
          "1"};
}

struct Judged {
  const char *name, *doc;
  double StabilityFrame::*field;
  const Gate* gate = nullptr;
};

}  // namespace

MetricGroup stability_metrics() {
  using S = StabilityFrame;
  constexpr Needs kJudged{"a stability block", is_judged};
  MetricGroup g;
  g.series.push_back({"stability_classes", "1", "outcome classes of the frame: sum of 2^k over F0 to F7", kJudged,
                      [](const MetricFrame& f) { return static_cast<double>(f.stability->classes); }});
  using V = StabilityVerdict;
  const auto scalar = [&](const std::string& name, Reduction from, const Gate* gate = nullptr) {
    g.scalars.push_back({name, std::move(from), Expect::No, gate, 0, with_judge});
  };
  scalar("stability_grade",
         of_verdict("0 stable, 1 degraded, 2 failed", [](const V& v) { return static_cast<double>(v.grade); }));
  scalar("stability_class", of_verdict("number of the outcome class F0 to F8",
                                       [](const V& v) { return v.klass != "ok" ? v.klass[1] - '0' : kMissing; }));
  scalar("stability_frame",
         of_verdict("first frame of that class", [](const V& v) { return v.frame >= 0 ? v.frame : kMissing; }));
  for (const Judged& j :
       {Judged{"stability_speed", "greatest vertex speed over the greatest that physics allows", &S::speed},
        {"stability_energy_gain", "energy gained over M g L", &S::energy_gain},
        {"stability_strain_excess", "greatest strain beyond the truth", &S::strain_excess},
        {"stability_strain_p99", "99th percentile of strain beyond the truth", &S::strain_p99},
        {"stability_bad_geometry", "share of triangles squashed or blown up, or of folds over 170 degrees",
         &S::bad_geometry},
        {"stability_depth", "depth in a collider over its limit; infinite once it has passed through", &S::depth},
        {"stability_unrest", "RMS speed over sqrt(g L), once settled", &S::unrest},
        {"stability_fall_error", "error of the centre of mass's fall over g T^2 / 2", &S::fall_error, &kErrorGate}}) {
    g.series.push_back({j.name, "1", j.doc, kJudged, judged_field(j.field)});
    scalar(std::string(j.name) + "_max", greatest_known(j.name), j.gate);
  }
  return g;
}

}  // namespace clothbench
