#pragma once
#include <map>
#include <string>
#include <vector>

#include "clothbench/record.hpp"

namespace clothbench::xr {

/// One frame of a live session; times by this machine's clock, unless said otherwise. NaN where there is none.
struct FrameRow {
  double predicted_display_s = kMissing;  ///< by the runtime's clock, from the first frame's on
  double predicted_period_s = kMissing;   ///< by the runtime
  double wait_s = kMissing;               ///< in xrWaitFrame, which paces
  double begin_s = kMissing;              ///< in xrBeginFrame
  double input_s = kMissing;              ///< locating hands
  double settle_s = kMissing;             ///< waiting for the pictures of the frame before
  double step_s = kMissing;               ///< of the solver, until its device has finished
  double step_device_s = kMissing;        ///< of that, first to last timestamp
  double paint_s = kMissing;              ///< acquiring images, recording and submitting
  double paint_device_s = kMissing;       ///< both eyes on the device, first to last timestamp
  double end_s = kMissing;                ///< in xrEndFrame
  double frame_s = kMissing;              ///< from xrWaitFrame's return to xrEndFrame's
  double shown = kMissing;                ///< 1 if the runtime asked for pictures
  double left_seen = kMissing,
         right_seen = kMissing;  ///< 1 if the hand was tracked, 0 if it stood where it was last seen
};

/// What a session logs.
class FrameLog {
 public:
  void add(const FrameRow& row) { rows_.push_back(row); }
  /// A value of this frame under a name of the runtime's own (XR_META_performance_metrics).
  void add_counter(const std::string& name, const std::string& units, double value);
  const std::vector<FrameRow>& rows() const { return rows_; }

  /// Refresh periods from the frame before to each; NaN for the first. 1 is the display's rate, 2 a half of it, 3 a
  /// third.
  std::vector<double> periods() const;
  /// "xr_..." scalars: frame rate by its median, mean and worst, share of frames after 1, 2, 3 and more periods, times.
  std::map<std::string, double> summary() const;
  /// Group "xr" of a result file, a row a frame.
  StoredGroup group() const;

 private:
  struct Counter {
    std::string units;
    std::vector<double> values;
  };
  std::vector<FrameRow> rows_;
  std::map<std::string, Counter> counters_;
};

}  // namespace clothbench::xr
