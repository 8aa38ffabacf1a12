#include "metrics/stability/judge.hpp"

namespace clothbench {
namespace {

constexpr unsigned kDegrading = (1u << 3) | (1u << 6);

const std::vector<double>* series(const AccuracyPass& pass, const std::string& name) {
  for (const MetricSeries& m : pass.metrics)
    if (m.name == name) return &m.values;
  return nullptr;
}

/// Lowest class of a set.
int least(unsigned classes) {
  int k = 0;
  while ((classes & (1u << k)) == 0) ++k;
  return k;
}

}  // namespace

StabilityVerdict stability_verdict(const AccuracyPass& pass) {
  StabilityVerdict out;
  const std::vector<double>* classes = series(pass, "stability_classes");
  if (classes == nullptr) return out;
  for (const bool fatal : {true, false})
    for (std::size_t f = 0; f < classes->size(); ++f) {
      const auto set = static_cast<unsigned>((*classes)[f]) & (fatal ? ~kDegrading : kDegrading);
      if (set == 0) continue;
      out.grade = fatal ? StabilityVerdict::Grade::Failed : StabilityVerdict::Grade::Degraded;
      out.klass = "F" + std::to_string(least(set));
      out.frame = static_cast<int>(f);
      return out;
    }
  return out;
}

const char* name_of(StabilityVerdict::Grade g) {
  switch (g) {
    case StabilityVerdict::Grade::Stable:
      return "stable";
    case StabilityVerdict::Grade::Degraded:
      return "degraded";
    case StabilityVerdict::Grade::Failed:
      return "failed";
  }
  return "";
}

std::string class_name(int k) {
  static constexpr const char* kNames[] = {"not finite", "speed",  "energy gain", "strain",          "geometry",
                                           "contact",    "unrest", "stagnation",  "budget or device"};
  return "F" + std::to_string(k) + " " + kNames[k];
}

}  // namespace clothbench
