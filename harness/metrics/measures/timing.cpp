// Scalars from the clock and the plan of a run: times, rates, bytes, memory.
#include <algorithm>
#include <numeric>

#include "base/interval.hpp"
#include "metrics/registry.hpp"

namespace clothbench {
namespace {

constexpr double kDisplayHz = 72;
constexpr double kBandwidthWindow_s = 5;  // the paper's Fig. 5

double median(const std::vector<double>& v) { return quantile(v, 0.5); }
using Values = std::vector<double>;

/// One number per trial that has frames.
template <class Of>
Values of_trials(const RunView& r, Of of) {
  Values out;
  for (const TimedTrial& t : r.run->trials)
    if (t.frames() > 0) out.push_back(of(t));
  return out;
}

/// One series over the frames of all trials, joined.
Values of_frames(const RunView& r, Values TimedTrial::*list) {
  Values out;
  for (const TimedTrial& t : r.run->trials)
    if (t.frames() > 0) out.insert(out.end(), (t.*list).begin(), (t.*list).end());
  return out;
}

Values rates(const RunView& r) {
  return of_trials(r, [](const TimedTrial& t) {
    return t.frames() / std::accumulate(t.frame_wall_s.begin(), t.frame_wall_s.end(), 0.0);
  });
}

double capped_rate(const TimedTrial& t) {
  double cap = 0;
  for (double w : t.frame_wall_s) cap += std::min(kDisplayHz, 1 / w);
  return cap / t.frames();
}

struct Bandwidth {
  double peak = kMissing, window_s = kMissing;
};

/// Bytes per second of one trial in windows of 5 s (a shorter trial is one window).
Bandwidth bandwidth(const TimedTrial& trial, const std::vector<double>& stage_bytes) {
  const std::size_t frames = trial.frame_wall_s.size();
  if (frames == 0 || stage_bytes.size() < frames) return {};
  const std::size_t stages = stage_bytes.size() / frames;
  const double total_s = std::accumulate(trial.frame_wall_s.begin(), trial.frame_wall_s.end(), 0.0);
  Bandwidth out;
  out.window_s = std::min(kBandwidthWindow_s, total_s);
  double window_B = 0, window_s = 0, peak = -1;
  for (std::size_t f = 0; f < frames; ++f) {
    for (std::size_t s = 0; s < stages; ++s) window_B += stage_bytes[f * stages + s];
    window_s += trial.frame_wall_s[f];
    const bool full = window_s >= out.window_s || f + 1 == frames;
    if (!full) continue;
    // A short remainder at the end of the trial is not a separate window.
    if (window_s >= 0.5 * out.window_s && !(window_B / window_s <= peak)) peak = window_B / window_s;
    window_B = window_s = 0;
  }
  out.peak = peak;
  return out;
}

/// Maximum number of concurrent clothbench processes while the run was loaded and timed; NaN if unknown for a part.
double jobs_beside(const RunView& r) {
  const RunRecord& record = *r.run;
  double most = record.header.environment.is_object() ? record.header.environment.value("jobs", kMissing) : kMissing;
  for (const TimedTrial& t : record.trials) most = max_or_nan(most, t.jobs);
  return most;
}

/// Mean over the frames of the first trial.
double bytes_per_frame(const RunRecord& run, std::vector<double> TimedTrial::*bytes) {
  if (run.trials.empty() || run.trials.front().frames() == 0) return kMissing;
  const TimedTrial& t = run.trials.front();
  return std::accumulate((t.*bytes).begin(), (t.*bytes).end(), 0.0) / t.frames();
}

// Memory and dispatches are unknown, not 0, for a GPU solver that states none, such as a plugin.
double device_memory(const RunView& r) {
  double memory = 0;
  for (const BufferPlan& b : r.plan->buffers) memory += b.device_local ? static_cast<double>(b.bytes) : 0.0;
  return r.on_gpu && memory > 0 ? memory : kMissing;
}

double dispatches(const RunView& r) {
  double sum = 0;
  for (const StagePlan& p : r.plan->stages) sum += p.dispatches;
  return r.on_gpu && sum > 0 ? sum : kMissing;
}

bool timed(const RunView& r) { return r.run != nullptr; }
bool on_host(const RunView& r) { return timed(r) && !of_frames(r, &TimedTrial::frame_cpu_s).empty(); }
bool rendered(const RunView& r) { return timed(r) && !of_frames(r, &TimedTrial::frame_rendered_s).empty(); }

Scalar reported(Better better, const char* name, const char* units, const char* doc,
                std::function<double(const RunView&)> value) {
  return {.name = name,
          .from = own({}, doc, std::move(value), units),
          .present = timed,
          .better = better,
          .of_machine = true};
}

/// A value that follows from the solver's buffers and kernels, whatever the machine.
Scalar of_solver(const char* name, const char* units, const char* doc, std::function<double(const RunView&)> value,
                 const Gate* gate = nullptr) {
  return {.name = name, .from = own({}, doc, std::move(value), units), .gate = gate, .present = timed};
}

/// A value stored by the code that runs a study or reads the device.
Scalar reading(const char* name, const char* units, const char* doc, Better better = Better::Neither) {
  return {.name = name, .from = own({}, doc, nullptr, units), .better = better, .of_machine = true};
}

Scalar median_frame(const char* name, const char* doc, Values TimedTrial::*list, bool (*present)(const RunView&)) {
  Scalar s = reported(Better::Less, name, "s", doc, [list](const RunView& r) { return median(of_frames(r, list)); });
  s.present = present;
  return s;
}

Scalar bandwidth_scalar(const char* name, const char* units, const char* doc, Values TimedTrial::*bytes,
                        double Bandwidth::*value) {
  const auto of = [=](const TimedTrial& t) { return bandwidth(t, t.*bytes).*value; };
  return reported(Better::Neither, name, units, doc, [of](const RunView& r) { return median(of_trials(r, of)); });
}

}  // namespace

MetricGroup timing_metrics() {
  using T = TimedTrial;
  using B = Bandwidth;
  using enum Better;
  static constexpr Gate kCount{0, SlackUnit::One, 0, false, "a count, the same in every run on one device"};
  return {
      {},
      {
          reported(Neither, "jobs", "1",
                   "maximum number of clothbench processes on the machine while the run was loaded and timed",
                   jobs_beside),
          reported(Neither, "trials", "1", "timed trials",
                   [](const RunView& r) { return static_cast<double>(r.run->trials.size()); }),
          reported(More, "fps_median", "s-1", "frames per second, median of the trials",
                   [](const RunView& r) { return median(rates(r)); }),
          reported(More, "fps_at_72", "s-1", "mean over frames of min(72, 1/t), median of the trials",
                   [](const RunView& r) { return median(of_trials(r, capped_rate)); }),
          median_frame("frame_wall_median_s", "wall time of a frame, median of all timed frames", &T::frame_wall_s,
                       timed),
          median_frame("frame_cpu_median_s",
                       "CPU time of a frame of a solver on the host, summed over its threads, median", &T::frame_cpu_s,
                       on_host),
          reported(
              Less, "frame_pipelined_median_s", "s",
              "mean wall time of a frame with two frames in flight, median of the trials",
              [](const RunView& r) { return median(of_trials(r, [](const T& t) { return t.pipelined_wall_s; })); }),
          median_frame("frame_rendered_median_s", "wall time of a frame with both eye views rendered, median",
                       &T::frame_rendered_s, rendered),
          median_frame("frame_device_median_s", "time of a frame on the GPU, median", &T::frame_device_s, timed),
          of_solver("read_B_per_frame", "B", "bytes that shaders read per frame, mean",
                    [](const RunView& r) { return bytes_per_frame(*r.run, &T::stage_read_B); }),
          of_solver("write_B_per_frame", "B", "bytes that shaders write per frame, mean",
                    [](const RunView& r) { return bytes_per_frame(*r.run, &T::stage_write_B); }),
          bandwidth_scalar("bandwidth_read_peak_B_per_s", "B s-1",
                           "bytes read divided by wall time, maximum over the windows", &T::stage_read_B, &B::peak),
          bandwidth_scalar("bandwidth_write_peak_B_per_s", "B s-1",
                           "bytes written divided by wall time, maximum over the windows", &T::stage_write_B, &B::peak),
          bandwidth_scalar("bandwidth_window_s", "s", "length of those windows", &T::stage_read_B, &B::window_s),
          of_solver("device_memory_B", "B", "buffers in device-local memory", device_memory),
          of_solver("dispatches", "1", "dispatches per frame", dispatches, &kCount),
          reported(Less, "load_s", "s", "wall time of loading", [](const RunView& r) { return r.run->header.load_s; }),
          reading("untimed_s", "s", "wall time of loading and of the untimed pass", Less),
          reading("cpu_clock_*", "Hz", "maximum clock of a CPU core, before and after"),
          reading("gpu_clock_*", "Hz", "clock of the GPU, before and after"),
          reading("temperature_*", "degC", "hottest sensor, before and after"),
          reading("sampled_*", "1", "readings of the device during the trials by another program"),
      }};
}

}  // namespace clothbench
