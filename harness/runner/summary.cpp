#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "metrics/metric.hpp"
#include "metrics/stability/judge.hpp"
#include "metrics/truth_errors.hpp"
#include "runner/cell.hpp"
#include "runner/contact_summary.hpp"

namespace clothbench {
namespace {

constexpr double kDisplayHz = 72;
constexpr double kBandwidthWindow_s = 5;  // the paper's Fig. 5

double quantile(std::vector<double> v, double q) {
  v.erase(std::remove_if(v.begin(), v.end(), [](double x) { return !std::isfinite(x); }), v.end());
  if (v.empty()) return kMissing;
  std::sort(v.begin(), v.end());
  const double at = q * (static_cast<double>(v.size()) - 1);
  const auto i = static_cast<std::size_t>(at);
  return i + 1 < v.size() ? v[i] + (at - static_cast<double>(i)) * (v[i + 1] - v[i]) : v.back();
}

double median(const std::vector<double>& v) { return quantile(v, 0.5); }
double mean(const std::vector<double>& v) {
  return v.empty() ? kMissing : std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
}

struct Bandwidth {
  double peak = kMissing, mean = kMissing, window_s = kMissing;
};

/// Bytes per second of one trial in windows of 5 s (of the whole trial where that is shorter).
Bandwidth bandwidth(const TimedTrial& trial, const std::vector<double>& stage_bytes) {
  const std::size_t frames = trial.frame_wall_s.size();
  if (frames == 0 || stage_bytes.size() < frames) return {};
  const std::size_t stages = stage_bytes.size() / frames;
  const double total_s = std::accumulate(trial.frame_wall_s.begin(), trial.frame_wall_s.end(), 0.0);
  Bandwidth out;
  out.window_s = std::min(kBandwidthWindow_s, total_s);
  double window_B = 0, window_s = 0, total_B = 0, peak = -1;
  for (std::size_t f = 0; f < frames; ++f) {
    for (std::size_t s = 0; s < stages; ++s) window_B += stage_bytes[f * stages + s];
    window_s += trial.frame_wall_s[f];
    const bool full = window_s >= out.window_s || f + 1 == frames;
    if (!full) continue;
    total_B += window_B;
    // A short rest at the end of the trial is no window of its own.
    if (window_s >= 0.5 * out.window_s && !(window_B / window_s <= peak)) peak = window_B / window_s;
    window_B = window_s = 0;
  }
  out.peak = peak;
  out.mean = total_B / total_s;
  return out;
}

double at_end(const AccuracyPass& pass, const std::string& name) {
  for (const MetricSeries& m : pass.metrics)
    if (m.name == name && !m.values.empty()) return m.values.back();
  return kMissing;
}

/// Greatest value of a series from a time on, NaN if any is; missing if the scene has no such series.
double greatest(const AccuracyPass& pass, const std::string& name, double from_s = 0) {
  for (const MetricSeries& m : pass.metrics) {
    if (m.name != name || m.values.empty()) continue;
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t f = 0; f < m.values.size(); ++f)
      if (pass.time_s[f] >= from_s) most = max_or_nan(most, m.values[f]);
    return most;
  }
  return kMissing;
}

/// Mean of a series from a time on, NaN if any is; missing if the scene has no such series.
double mean_from(const AccuracyPass& pass, const std::string& name, double from_s) {
  for (const MetricSeries& m : pass.metrics) {
    if (m.name != name) continue;
    std::vector<double> late;
    for (std::size_t f = 0; f < m.values.size(); ++f)
      if (pass.time_s[f] >= from_s) late.push_back(m.values[f]);
    return mean(late);
  }
  return kMissing;
}

/// Over the last half second of the scene; missing if the pass does not reach its end.
double settled(const AccuracyPass& pass, const TimeSpan& time, const std::string& name) {
  constexpr double kSettled_s = 0.5;
  if (pass.time_s.size() != static_cast<std::size_t>(time.frames()) + 1) return kMissing;
  // Half a frame earlier, so that rounding leaves no frame out.
  return greatest(pass, name, pass.time_s.back() - kSettled_s - 0.5 * time.dt());
}

/// What the accuracy pass gives: how much of the cloth got where it must not, and how far it was stretched.
void summarise_pass(const AccuracyPass& pass, const TimeSpan& time, std::map<std::string, double>& s) {
  s["free_fall_error"] = at_end(pass, "free_fall_error");
  s["free_fall_error_rms"] = at_end(pass, "free_fall_error_rms");
  s["contact_length_settled_m"] = settled(pass, time, "contact_length_m");
  s["contact_length_max_m"] = greatest(pass, "contact_length_m");
  s["tunnelled_fraction_max"] = greatest(pass, "tunnelled_fraction");
  s["tunnelled_fraction_end"] = at_end(pass, "tunnelled_fraction");
  s["tunnelled_depth_max_m"] = greatest(pass, "tunnelled_depth_m");
  s["depth_max_m"] = greatest(pass, "depth_m");
  s["depth_vertex_max_m"] = greatest(pass, "depth_vertex_m");
  s["depth_p99_m"] = greatest(pass, "depth_p99_m");
  s["depth_mean_m"] = greatest(pass, "depth_mean_m");
  s["penetrating_area_max_m2"] = greatest(pass, "penetrating_area_m2");
  s["stretch_max"] = greatest(pass, "stretch_max");
  s["stretch_max_end"] = at_end(pass, "stretch_max");
  // Over the last second: half a frame later, so that rounding takes no frame in.
  constexpr double kLast_s = 1;
  const bool whole = pass.time_s.size() == static_cast<std::size_t>(time.frames()) + 1;
  const double from_s = whole ? pass.time_s.back() - kLast_s + 0.5 * time.dt() : kMissing;
  s["stretch_max_last_second"] = whole ? greatest(pass, "stretch_max", from_s) : kMissing;
  s["stretch_mean_last_second"] = whole ? mean_from(pass, "stretch_mean_positive", from_s) : kMissing;
}

/// The most clothbench jobs that ran side by side while the cell was loaded and timed; missing if any of it doesn't
/// say.
double jobs_beside(const CellRecord& record) {
  double most = record.header.environment.is_object() ? record.header.environment.value("jobs", kMissing) : kMissing;
  for (const TimedTrial& t : record.trials) most = max_or_nan(most, t.jobs);
  return most;
}

double bytes_per_frame(const std::vector<TimedTrial>& trials, std::vector<double> TimedTrial::*bytes) {
  if (trials.empty() || trials.front().frames() == 0) return kMissing;
  const TimedTrial& t = trials.front();
  const std::size_t stages = (t.*bytes).size() / static_cast<std::size_t>(t.frames());
  double sum = 0;
  for (std::size_t s = 0; s < stages; ++s) sum += (t.*bytes)[s];
  return sum;
}

}  // namespace

std::map<std::string, double> summarise(const CellSpec& spec, const Plan& plan, const CellRecord& record) {
  std::map<std::string, double> s;
  std::vector<double> fps, capped, wall, pipelined, rendered, device, read_peak, read_mean, write_peak, write_mean,
      window;
  for (const TimedTrial& t : record.trials) {
    if (t.frames() == 0) continue;
    fps.push_back(t.frames() / std::accumulate(t.frame_wall_s.begin(), t.frame_wall_s.end(), 0.0));
    double cap = 0;
    for (double w : t.frame_wall_s) cap += std::min(kDisplayHz, 1 / w);
    capped.push_back(cap / t.frames());
    wall.insert(wall.end(), t.frame_wall_s.begin(), t.frame_wall_s.end());
    pipelined.push_back(t.pipelined_wall_s);
    rendered.insert(rendered.end(), t.frame_rendered_s.begin(), t.frame_rendered_s.end());
    device.insert(device.end(), t.frame_device_s.begin(), t.frame_device_s.end());
    const Bandwidth r = bandwidth(t, t.stage_read_B), w = bandwidth(t, t.stage_write_B);
    read_peak.push_back(r.peak);
    read_mean.push_back(r.mean);
    write_peak.push_back(w.peak);
    write_mean.push_back(w.mean);
    window.push_back(r.window_s);
  }
  s["jobs"] = jobs_beside(record);
  s["trials"] = static_cast<double>(record.trials.size());
  s["frames_per_trial"] = record.trials.empty() ? kMissing : record.trials.front().frames();
  s["fps_median"] = median(fps);
  s["fps_mean"] = mean(fps);
  s["fps_spread"] =
      fps.empty()
          ? kMissing
          : (*std::max_element(fps.begin(), fps.end()) - *std::min_element(fps.begin(), fps.end())) / 2 / median(fps);
  s["fps_at_72"] = median(capped);
  s["frame_wall_median_s"] = median(wall);
  s["frame_wall_iqr_s"] = quantile(wall, 0.75) - quantile(wall, 0.25);
  s["frame_pipelined_median_s"] = median(pipelined);
  if (!rendered.empty()) {
    s["frame_rendered_median_s"] = median(rendered);
    s["fps_rendered_median"] = 1 / median(rendered);
  }
  s["frame_device_median_s"] = median(device);
  summarise_pass(record.accuracy, spec.scene->time, s);
  s.merge(summarise_contact(*spec.scene, record.accuracy));
  s.merge(summarise_truth(*spec.scene, record.accuracy));
  s.emplace("truth_quantity_error_max", kMissing);  // scenes may expect it
  s.merge(summarise_stability(*spec.scene, record.accuracy, record.outcome));
  for (const auto& [name, value] : spec.scene_values) s[name] = value;
  s["read_B_per_frame"] = bytes_per_frame(record.trials, &TimedTrial::stage_read_B);
  s["write_B_per_frame"] = bytes_per_frame(record.trials, &TimedTrial::stage_write_B);
  s["bandwidth_read_peak_B_per_s"] = median(read_peak);
  s["bandwidth_read_mean_B_per_s"] = median(read_mean);
  s["bandwidth_write_peak_B_per_s"] = median(write_peak);
  s["bandwidth_write_mean_B_per_s"] = median(write_mean);
  s["bandwidth_window_s"] = median(window);
  double memory = 0, dispatches = 0;
  for (const BufferPlan& b : plan.buffers) memory += b.device_local ? static_cast<double>(b.bytes) : 0.0;
  for (const StagePlan& p : plan.stages) dispatches += p.dispatches;
  s["device_memory_B"] = spec.entry->info.on_gpu ? memory : kMissing;
  s["dispatches"] = spec.entry->info.on_gpu ? dispatches : kMissing;
  s["load_s"] = record.header.load_s;
  const std::size_t stages = plan.stages.size();
  for (std::size_t k = 0; k < stages; ++k) {
    std::vector<double> t;
    for (const TimedTrial& trial : record.trials)
      for (std::size_t f = 0; f < trial.frame_wall_s.size(); ++f) t.push_back(trial.stage_device_s[f * stages + k]);
    s["stage_device_median_s." + plan.stages[k].name] = median(t);
  }
  return s;
}

}  // namespace clothbench
