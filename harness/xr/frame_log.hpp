#pragma once
#include <map>
#include <string>
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"

namespace clothbench::xr {

/// One frame of a live session. NaN: not available.
struct FrameRow {
  double predicted_display_s = kMissing;  ///< predicted by the runtime, relative to the first frame
  double predicted_period_s = kMissing;   ///< predicted by the runtime
  double paint_device_s = kMissing;       ///< device time for both eyes of the previous frame, first to last timestamp
  double frame_s = kMissing;              ///< from the return of xrWaitFrame to the return of xrEndFrame
  double left_seen = kMissing,
         right_seen = kMissing;  ///< 1 if the hand was tracked, 0 if its last tracked pose was kept
};

/// Log of a session.
class FrameLog {
 public:
  void add(const FrameRow& row) { rows_.push_back(row); }
  const std::vector<FrameRow>& rows() const { return rows_; }

  /// Adds a solver step. Steps form a timed trial, as in any run, so that device samples can be matched to its times.
  void add_step(const FrameCost&, double step_s);
  const TimedTrial& trial() const { return trial_; }

  /// For each frame, the number of refresh periods since the previous frame; NaN for the first. 1 is the display's
  /// rate, 2 is half of it, 3 a third.
  std::vector<double> periods() const;
  /// "xr_..." scalars: median and minimum frame rate; fraction of frames more than one period after the previous one.
  std::map<std::string, double> summary() const;
  /// Group "xr" of a result file, one row per frame.
  StoredGroup group() const;

 private:
  std::vector<FrameRow> rows_;
  TimedTrial trial_;
};

}  // namespace clothbench::xr
