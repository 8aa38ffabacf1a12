// Whether a motion is possible, from its stored positions (motion_check/README.md).
#include "metrics/motion_check/motion_check.hpp"

#include "metrics/registry.hpp"

namespace clothbench {

MetricGroup motion_check_metrics() {
  MetricGroup g;
  for (const motion_check::Statistic& s : motion_check::statistics()) {
    const auto ratio = [&s](const RunView& r) {
      const motion_check::Finding* f = r.finding(s.name);
      return f == nullptr ? kMissing : f->ratio;
    };
    g.scalars.push_back(
        {.name = kMotionCheck + s.name,
         .from = own({}, std::string(s.what) + ", divided by its tolerance; maximum over the frames", ratio, "1"),
         .present = [&s](const RunView& r) { return r.finding(s.name) != nullptr; }});
  }
  const auto frame = [](const RunView& r) {
    const motion_check::Finding* f = motion_check::worst(r.findings());
    return f == nullptr ? kMissing : f->frame;
  };
  g.scalars.push_back({.name = kMotionCheck + "frame",
                       .from = own({}, "frame with the largest ratio of all statistics", frame, "1"),
                       .present = [](const RunView& r) { return !r.findings().empty(); },
                       .better = Better::Neither});
  return g;
}

}  // namespace clothbench
