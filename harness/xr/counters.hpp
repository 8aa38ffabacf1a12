#pragma once
#include <functional>
#include <string>
#include <vector>

#include "xr/session.hpp"

namespace clothbench::xr {

/// Counters of the runtime (XR_META_performance_metrics): frame times of application and compositor, dropped frames,
/// utilisation. None if the runtime does not have this extension.
class Counters {
 public:
  explicit Counters(const Session&);
  /// Calls `take` with name, units and current value (NaN if it has none) of each counter.
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
