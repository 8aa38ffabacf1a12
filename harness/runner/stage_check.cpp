#include "runner/stage_check.hpp"

#include <fmt/format.h>

#include <cmath>

namespace clothbench {

constexpr FeatureSet kData = features_of(FeatureOf::Data);

std::string check_stages(const Scene& scene, const SolverInfo& info, const Plan& plan) {
  std::string fault;
  const FeatureSet implied = scene.needs - info.ignores - kData;
  FeatureSet served;
  for (const StagePlan& stage : plan.stages) {
    served |= stage.serves;
    (stage.serves - kData - implied).for_each([&](Feature f) {
      fault += "stage " + stage.name + " serves " + std::string(name_of(f)) + ", which the scene does not need; ";
    });
  }
  (implied - served).for_each([&](Feature f) { fault += "no stage serves " + std::string(name_of(f)) + "; "; });
  if (!plan.contact_margins_m.empty() && plan.contact_margins_m.size() != scene.colliders.size())
    fault += fmt::format("{} contact margins of {} colliders; ", plan.contact_margins_m.size(), scene.colliders.size());
  for (const double m : plan.contact_margins_m)
    if (!(m >= 0 || std::isnan(m)) || std::isinf(m)) fault += fmt::format("a contact margin of {} m; ", m);
  if (plan.stages.empty()) fault += "no stage at all; ";
  return fault.empty() ? fault : fault.substr(0, fault.size() - 2);
}

}  // namespace clothbench
