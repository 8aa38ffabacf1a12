#pragma once
#include <vector>

#include "base/interval.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// Frame times [s] of all timed trials of a run. Intervals: 95 %.
struct FrameTimes {
  std::vector<double> sorted;  ///< ascending
  Interval median;
  Interval rate;  ///< of the median over trials of the frames per second
  /// Nearest-rank quantile; NaN without frames.
  double at(double q) const;
  /// Share of the frames that are longer than one refresh of a display.
  double missed(double rate_hz) const;
  /// True if the interval of the median is wider than 20 % of it: the run is marked and, by its wall time, not ranked.
  bool uncertain() const;
};

/// All times of a run; `contact_…`: of the frames in which something touches the cloth.
struct RunTimes {
  FrameTimes wall, device, contact_wall, contact_device, cpu, rendered;
  double threads = kMissing;  ///< CPU time over wall time of the median frame of a CPU solver, rounded
};

/// Intervals come from a bootstrap over trials and, in each, over blocks of consecutive frames: 400 resamples with a
/// fixed seed. Frames of one block depend on each other, so they are drawn together. One trial has no variation between
/// trials in its interval. Fewer than 6 frames have no interval.
RunTimes times_of(const RunRecord&);

/// The method of the intervals, as a sentence for notes of tables.
extern const char* const kIntervalMethod;

}  // namespace clothbench
