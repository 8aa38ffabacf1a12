// Outcome classes of a run and the quantities that decide them; StabilityJudge evaluates the frames.
#include <cmath>

#include "metrics/registry.hpp"
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
  return {{series}, "maximum over the frames that count", [name = std::string(series)](const RunView& r) {
            double most = kMissing;
            for (const MetricSeries& m : r.pass.metrics)
              for (std::size_t f = 0; m.name == name && f < m.values.size(); ++f)
                if (!std::isnan(m.values[f]) && !(m.values[f] <= most)) most = m.values[f];
            return most;
          }};
}

/// 0 stable, 1 degraded, 2 failed; none for a scene that the solver does not run. A run that ended early for a reason
/// that its frames do not show has failed too.
double grade(const RunView& r) {
  using enum StabilityVerdict::Grade;
  if (r.outcome.status == "unsupported") return kMissing;
  return static_cast<double>(r.outcome.status == "ok" ? stability_verdict(r.pass).grade : Failed);
}

struct Judged {
  const char *name, *doc;
  double StabilityFrame::*field;
};

}  // namespace

MetricGroup stability_metrics() {
  using S = StabilityFrame;
  constexpr Needs kJudged{"a stability block", is_judged};
  MetricGroup g;
  g.series.push_back({"stability_classes", "1", "outcome classes of the frame: sum of 2^k over F0 to F2", kJudged,
                      [](const MetricFrame& f) { return static_cast<double>(f.stability->classes); }});
  const auto scalar = [&](const std::string& name, Reduction from) {
    g.scalars.push_back({name, std::move(from), Expect::No, nullptr, with_judge});
  };
  scalar("stability_grade", own({"stability_classes"}, "0 stable, 1 degraded, 2 failed", grade, "1"));
  for (const Judged& j :
       {Judged{"stability_speed", "maximum vertex speed, divided by the maximum that physics allows", &S::speed},
        {"stability_energy_gain", "energy gained, divided by M g L", &S::energy_gain},
        {"stability_strain_excess", "maximum strain beyond the exact solution or its bound", &S::strain_excess}}) {
    g.series.push_back({j.name, "1", j.doc, kJudged, judged_field(j.field)});
    scalar(std::string(j.name) + "_max", greatest_known(j.name));
  }
  return g;
}

}  // namespace clothbench
