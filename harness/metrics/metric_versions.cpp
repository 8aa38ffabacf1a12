#include <algorithm>

#include "metrics/metric.hpp"

namespace clothbench {
namespace {

struct Origin {
  const char* summary_name;  ///< a '*' at its end stands for any text
  std::vector<std::string> metrics;
};

bool fits(const std::string& pattern, const std::string& name) {
  if (pattern.back() != '*') return pattern == name;
  return name.starts_with(pattern.substr(0, pattern.size() - 1));
}

/// What runner/summary.cpp, runner/contact_summary.cpp and truth_errors.cpp compute from more than the metric of the
/// same stem. The first row that fits counts.
const std::vector<Origin>& origins() {
  static const std::vector<Origin> rows = {
      {"contact_violated_longest_s", {"contact_length_m", "tunnelled_fraction", "wrong_side_samples"}},
      {"untangle_s", {"contact_length_m", "tunnelled_fraction", "wrong_side_samples"}},
      {"depth_time_mean_m", {"depth_mean_m", "penetrating_area_m2"}},
      {"pop_displacement_m", {"touching_fraction"}},
      {"pop_speed_*", {"touching_fraction", "speed_max"}},
      {"slip_*", {"slip_m"}},
      {"grip_error_*", {"grip_error_m"}},
      {"grip_edge_ratio_*", {"stretch_max"}},
      {"strain_mean_released", {"stretch_mean_positive"}},
      {"stretch_max*", {"stretch_max"}},
      {"stretch_mean_last_second", {"stretch_mean_positive"}},
      {"truth_e2", {"truth_error_e2"}},
      {"truth_max", {"truth_error_max"}},
      {"truth_error", {"truth_error_e2", "truth_quantity_error"}},
      {"truth_quantity_error*", {"truth_quantity_error"}},
      {"energy_gain", {"energy_rise"}},
      {"energy_drift", {"energy_rise"}},
      {"stability_grade", {"stability_classes"}},
      {"stability_class", {"stability_classes"}},
      {"stability_frame", {"stability_classes"}},
  };
  return rows;
}

/// "depth_vertex" of "depth_vertex_m": the name without its unit.
std::string stem(const std::string& name) {
  for (const char* unit : {"_m2", "_rad", "_m", "_J"})
    if (name.ends_with(unit)) return name.substr(0, name.size() - std::string(unit).size());
  return name;
}

}  // namespace

int metric_version(const std::string& name) {
  for (const Metric& m : metrics())
    if (m.name == name) return m.version;
  return 0;
}

std::vector<std::string> metrics_behind(const std::string& summary_name) {
  constexpr const char* kExpect = "expect.";
  if (summary_name.starts_with(kExpect)) return metrics_behind(summary_name.substr(std::string(kExpect).size()));
  for (const Origin& o : origins())
    if (fits(o.summary_name, summary_name)) return o.metrics;
  // Else the metric itself, or one that is told by its greatest, last, settled or mean value.
  std::string base = stem(summary_name);
  if (metric_version(summary_name) > 0) return {summary_name};
  for (const char* of : {"_max", "_end", "_settled", "_mean"})
    if (base.ends_with(of)) base = base.substr(0, base.size() - std::string(of).size());
  for (const Metric& m : metrics())
    if (stem(m.name) == base) return {m.name};
  return {};
}

}  // namespace clothbench
