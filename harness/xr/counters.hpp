#pragma once
#include <functional>
#include <string>
#include <vector>

#include "xr/session.hpp"

namespace clothbench::xr {

/// What the runtime counts by itself (XR_META_performance_metrics): frame times of application and compositor, dropped
/// frames, utilisation. None where it has no such extension.
class Counters {
 public:
  explicit Counters(const Session&);
  /// Calls `take` with name, units and the value now (NaN where it has none) of each.
  void read(const std::function<void(const std::string&, const std::string&, double)>& take) const;

 private:
  const Session& session_;
  QueryMetricsCounter query_ = nullptr;
  struct Counter {
    XrPath path;
    std::string name;
  };
  std::vector<Counter> counters_;
};

}  // namespace clothbench::xr
