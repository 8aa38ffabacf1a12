#include <algorithm>
#include <cmath>

#include "metrics/stability/judge.hpp"

namespace clothbench {
namespace {

constexpr unsigned kDegrading = (1u << 3) | (1u << 6);

const std::vector<double>* series(const AccuracyPass& pass, const std::string& name) {
  for (const MetricSeries& m : pass.metrics)
    if (m.name == name) return &m.values;
  return nullptr;
}

/// Least class of a set.
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

std::map<std::string, double> summarise_stability(const Scene& scene, const AccuracyPass& pass,
                                                  const Outcome& outcome) {
  std::map<std::string, double> out;
  if (scene.stability.name.empty()) return out;
  StabilityVerdict v = stability_verdict(pass);
  const bool judged = outcome.status != "unsupported";
  // A run that ended early for another reason than what its frames show has failed all the same: F8.
  if (judged && outcome.status != "ok" && v.grade != StabilityVerdict::Grade::Failed)
    v = {StabilityVerdict::Grade::Failed, outcome.klass == "ok" ? "F8" : outcome.klass, outcome.failed_frame};
  out["stability_grade"] = judged ? static_cast<double>(v.grade) : kMissing;
  out["stability_class"] = judged && v.klass != "ok" ? v.klass[1] - '0' : kMissing;
  out["stability_frame"] = judged && v.frame >= 0 ? v.frame : kMissing;
  for (const char* name :
       {"stability_speed", "stability_energy_gain", "stability_strain_excess", "stability_strain_p99",
        "stability_bad_geometry", "stability_depth", "stability_unrest", "stability_fall_error"}) {
    double most = kMissing;
    if (const std::vector<double>* values = series(pass, name))
      for (double value : *values)
        if (!std::isnan(value) && !(value <= most)) most = value;  // frames that do not count are NaN
    out[std::string(name) + "_max"] = most;
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
