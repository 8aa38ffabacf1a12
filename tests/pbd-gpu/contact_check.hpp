#pragma once
#include <string>

#include "gpu_fixture.hpp"
#include "metrics/registry.hpp"
#include "scenario/load.hpp"

namespace clothbench::pbd_gpu {

/// A whole run of `xpbd`, checked by the harness's contact metrics, which share no code with the solver.
struct ContactRun {
  std::string fault;    ///< why the run failed, what passed through, wrong stages; empty if none of these
  double touching = 0;  ///< largest fraction of the cloth that touched colliders in a frame
};
inline ContactRun contact_run(const Scene& s, const nlohmann::json& given) {
  SolverRun run({&s, &find_solver("xpbd"), complete_settings(xpbd_info(), given)}, {-1, true}, "test");
  const AccuracyPass pass = whole_pass(run, s);
  ContactRun out;
  out.fault = (run.outcome().status == "ok" ? "" : run.outcome().message) + check_stages(s, xpbd_info(), run.plan());
  const auto summary = scalars_of({s, pass});
  for (const StrictBound& b : strict_contact()) {
    const std::string name = b.scalar;
    if (name.starts_with("pop") || name.starts_with("stretch") || !b.defined(s)) continue;
    if (!(summary.at(name) <= 0)) out.fault += name + " " + std::to_string(summary.at(name)) + " ";
  }
  for (const MetricSeries& m : pass.metrics)
    for (const double v : m.values)
      if (m.name == "touching_fraction") out.touching = max_or_nan(out.touching, v);
  return out;
}

}  // namespace clothbench::pbd_gpu
