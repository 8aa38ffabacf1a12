#include "xr/frame_log.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/interval.hpp"
#include "runner/environment.hpp"
#include "runner/solver_run.hpp"

namespace clothbench::xr {
namespace {

struct Column {
  const char *name, *units, *long_name;
  double FrameRow::*value;
};

constexpr Column kColumns[] = {
    {"predicted_display_s", "s", "predicted display time by the runtime's clock, relative to the first frame",
     &FrameRow::predicted_display_s},
    {"predicted_period_s", "s", "refresh period of the display, predicted by the runtime",
     &FrameRow::predicted_period_s},
    {"paint_device_s", "s", "device time of both eye views of the previous frame, first to last timestamp",
     &FrameRow::paint_device_s},
    {"frame_s", "s", "wall time from the return of xrWaitFrame to the return of xrEndFrame", &FrameRow::frame_s},
    {"left_seen", "1", "1 if the left hand was tracked", &FrameRow::left_seen},
    {"right_seen", "1", "1 if the right hand was tracked", &FrameRow::right_seen},
};

}  // namespace

void FrameLog::add_step(const FrameCost& cost, double step_s) {
  const double now = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  if (trial_.frames() == 0) trial_.jobs = jobs_now();
  if (trial_.frames() == 0) trial_.start_unix_s = now - step_s;
  trial_.end_unix_s = now;
  add_frame(trial_, cost, step_s, cost.stage_read_B.size());
}

std::vector<double> FrameLog::periods() const {
  std::vector<double> out(rows_.size(), kMissing);
  for (std::size_t k = 1; k < rows_.size(); ++k)
    out[k] =
        std::round((rows_[k].predicted_display_s - rows_[k - 1].predicted_display_s) / rows_[k].predicted_period_s);
  return out;
}

std::map<std::string, double> FrameLog::summary() const {
  std::map<std::string, double> s;
  s["xr_frames"] = static_cast<double>(rows_.size());
  std::vector<double> interval;
  for (std::size_t k = 1; k < rows_.size(); ++k)
    interval.push_back(rows_[k].predicted_display_s - rows_[k - 1].predicted_display_s);
  if (interval.empty()) return s;
  s["xr_fps_median"] = 1 / quantile(interval, 0.5);
  s["xr_fps_worst"] = 1 / quantile(interval, 1);
  const std::vector<double> n = periods();
  const auto late = std::count_if(n.begin(), n.end(), [](double p) { return p > 1; });
  s["xr_late_frames"] = static_cast<double>(late) / static_cast<double>(interval.size());
  std::vector<double> painted;
  for (const FrameRow& r : rows_) painted.push_back(r.paint_device_s);
  s["xr_paint_device_median_s"] = quantile(painted, 0.5);
  return s;
}

StoredGroup FrameLog::group() const {
  StoredGroup g;
  g.path = "xr";
  const auto add = [&](const char* name, const char* units, const char* long_name, std::vector<double> values) {
    g.arrays.push_back({name, units, long_name, {"frame"}, {rows_.size()}, false, std::move(values)});
  };
  for (const Column& c : kColumns) {
    std::vector<double> values;
    for (const FrameRow& r : rows_) values.push_back(r.*c.value);
    add(c.name, c.units, c.long_name, std::move(values));
  }
  add("periods", "1", "refresh periods since the previous frame", periods());
  return g;
}

}  // namespace clothbench::xr
