#pragma once
#include <map>
#include <string>
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"

namespace clothbench::xr {

/// One frame of a live session. Times are by this machine's clock unless stated otherwise; NaN: not available.
struct FrameRow {
  double predicted_display_s = kMissing;  ///< by the runtime's clock, relative to that of the first frame
  double predicted_period_s = kMissing;   ///< by the runtime
  double wait_s = kMissing;               ///< in xrWaitFrame, which paces the frames
  double begin_s = kMissing;              ///< in xrBeginFrame
  double input_s = kMissing;              ///< locating hands
  double settle_s = kMissing;             ///< waiting for the pictures of the previous frame
  double step_s = kMissing;               ///< of the solver, until its device has finished
  double step_device_s = kMissing;        ///< of the solver on the device, first to last timestamp
  double paint_s = kMissing;              ///< acquiring images, recording and submitting
  double paint_device_s = kMissing;       ///< both eyes on the device, first to last timestamp
  double end_s = kMissing;                ///< in xrEndFrame
  double frame_s = kMissing;              ///< from xrWaitFrame's return to xrEndFrame's
  double shown = kMissing;                ///< 1 if the runtime requested pictures
  double left_seen = kMissing,
         right_seen = kMissing;  ///< 1 if the hand was tracked, 0 if its last tracked pose was kept
};

/// Log of a session.
class FrameLog {
 public:
  void add(const FrameRow& row) { rows_.push_back(row); }
  /// Adds a counter's value for this frame; the runtime gives the name (XR_META_performance_metrics).
  void add_counter(const std::string& name, const std::string& units, double value);
  const std::vector<FrameRow>& rows() const { return rows_; }

  /// The steps are a timed trial as of any run, so that what a headset's tools sampled meanwhile finds its time.
  void add_step(const FrameCost&, double step_s);
  const TimedTrial& trial() const { return trial_; }

  /// For each frame, the number of refresh periods since the previous frame; NaN for the first. 1 is the display's
  /// rate, 2 half of it, 3 a third.
  std::vector<double> periods() const;
  /// "xr_..." scalars: median, mean and worst frame rate; shares of frames after 1, 2, 3 and more periods; times.
  std::map<std::string, double> summary() const;
  /// Group "xr" of a result file, one row per frame.
  StoredGroup group() const;

 private:
  struct Counter {
    std::string units;
    std::vector<double> values;
  };
  std::vector<FrameRow> rows_;
  TimedTrial trial_;
  std::map<std::string, Counter> counters_;
};

}  // namespace clothbench::xr
