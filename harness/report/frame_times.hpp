#pragma once
#include <vector>

#include "clothbench/record.hpp"

namespace clothbench {

/// A 95 % interval; NaN where it is not known.
struct Interval95 {
  double low = kMissing, high = kMissing;
};

/// Frame times [s] of all timed trials of a run, ascending, and the interval of their median.
struct FrameTimes {
  std::vector<double> sorted;
  Interval95 median;
  /// Nearest-rank quantile; NaN without frames.
  double at(double q) const;
  /// Share of the frames that are longer than one refresh of a display.
  double missed(double rate_hz) const;
};

/// All times of a run, once without and once with the frames in which nothing touches the cloth.
struct RunTimes {
  FrameTimes wall, device, contact_wall, contact_device;
  Interval95 rate;            ///< of the median over trials of the frames per second
  double threads = kMissing;  ///< CPU time over wall time of the median frame of a CPU solver, rounded
  /// True if the interval of the median wall time is wider than 20 % of it: the run is marked and not ranked.
  bool uncertain() const;
};

/// Intervals come from a bootstrap over trials and, in each, over blocks of consecutive frames: 400 resamples with a
/// fixed seed. Frames of one block depend on each other, so they are drawn together. One trial has no variation between
/// trials in its interval. Fewer than 6 frames have no interval.
RunTimes times_of(const RunRecord&);

/// Whether the cloth touches something in each frame of the scene, frame 0 included; empty if no metric states it.
std::vector<bool> frames_with_contact(const RunRecord&);

/// The method of the intervals, as a sentence for notes of tables.
extern const char* const kIntervalMethod;

}  // namespace clothbench
