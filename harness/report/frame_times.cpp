#include <array>
#include <numeric>
#include <random>
#include <tuple>

#include "report/run_table.hpp"

namespace clothbench {
namespace {

constexpr std::size_t kResamples = 400, kBlock = 16, kMinBlocks = 8, kMinFrames = 6;
constexpr double kWide = 0.2;
constexpr double kMeasurable_s = 2e-5;  // in shorter frames, reading the clock dominates the CPU time

using Series = std::vector<double>;

Interval percentiles(Series estimates) {
  std::sort(estimates.begin(), estimates.end());
  return {nearest_rank(estimates, 0.025), nearest_rank(estimates, 0.975)};
}

/// Blocks of consecutive frames of a trial; the last block also gets the remainder.
std::vector<Series> blocks_of(const Series& trial) {
  const std::size_t length = std::clamp<std::size_t>(trial.size() / kMinBlocks, 1, kBlock);
  std::vector<Series> out(trial.size() / length);
  for (std::size_t f = 0; f < trial.size(); ++f) out[std::min(f / length, out.size() - 1)].push_back(trial[f]);
  return out;
}

/// 95 % intervals of the median frame time and of the median over trials of the frame rate [1/s], by a bootstrap over
/// trials and blocks of their frames. No trial is empty.
std::pair<Interval, Interval> intervals(const std::vector<Series>& trials) {
  std::vector<std::vector<Series>> blocks;
  for (const Series& t : trials) blocks.push_back(blocks_of(t));
  std::mt19937_64 random;  // default seed: equal numbers on every machine
  Series medians, rates;
  for (std::size_t n = 0; n < kResamples; ++n) {
    Series drawn, rates_drawn;
    for (std::size_t t = 0; t < blocks.size(); ++t) {
      const std::vector<Series>& trial = blocks[random() % blocks.size()];
      const std::size_t before = drawn.size();
      double sum = 0;
      for (std::size_t k = 0; k < trial.size(); ++k) {
        const Series& block = trial[random() % trial.size()];
        drawn.insert(drawn.end(), block.begin(), block.end());
        sum += std::accumulate(block.begin(), block.end(), 0.0);
      }
      rates_drawn.push_back(static_cast<double>(drawn.size() - before) / sum);
    }
    rates.push_back(quantile(std::move(rates_drawn), 0.5));
    const auto half = drawn.begin() + static_cast<std::ptrdiff_t>((drawn.size() - 1) / 2);
    std::nth_element(drawn.begin(), half, drawn.end());
    medians.push_back(*half);
  }
  return {percentiles(std::move(medians)), percentiles(std::move(rates))};
}

/// For each frame of the scene, frame 0 included, whether the cloth touches something; empty if no metric measured it.
std::vector<bool> frames_with_contact(const RunRecord& c) {
  constexpr std::array kTold = {"touching_fraction", "contact_length_m", "depth_m", "self_contact_length_m"};
  std::vector<bool> out;
  for (const MetricSeries& m : c.accuracy.metrics) {
    if (!contains(kTold, m.name)) continue;
    out.resize(std::max(out.size(), m.values.size()));
    for (std::size_t f = 0; f < m.values.size(); ++f) out[f] = out[f] || m.values[f] > 0;
  }
  return out;
}

/// The finite times of all trials; if `contact` is not empty, only times of frames with contact.
FrameTimes times_by(Series TimedTrial::*clock, const RunRecord& c, const std::vector<bool>& contact = {}) {
  FrameTimes out;
  std::vector<Series> trials;
  for (const TimedTrial& t : c.trials) {
    Series kept;
    for (std::size_t f = 0; f < (t.*clock).size(); ++f)
      if (std::isfinite((t.*clock)[f]) && (contact.empty() || (f + 1 < contact.size() && contact[f + 1])))
        kept.push_back((t.*clock)[f]);
    out.sorted.insert(out.sorted.end(), kept.begin(), kept.end());
    if (!kept.empty()) trials.push_back(std::move(kept));
  }
  std::sort(out.sorted.begin(), out.sorted.end());
  if (out.sorted.size() >= kMinFrames) std::tie(out.median, out.rate) = intervals(trials);
  return out;
}

}  // namespace

double FrameTimes::at(double q) const { return nearest_rank(sorted, q); }

double FrameTimes::missed(double rate_hz) const {
  if (sorted.empty()) return kMissing;
  const auto late = sorted.end() - std::upper_bound(sorted.begin(), sorted.end(), 1 / rate_hz);
  return static_cast<double>(late) / static_cast<double>(sorted.size());
}

bool FrameTimes::uncertain() const {
  return median.high - median.low > kWide * at(0.5) || rate.high - rate.low > kWide * (rate.high + rate.low) / 2;
}

RunTimes times_of(const RunRecord& c) {
  RunTimes out;
  out.wall = times_by(&TimedTrial::frame_wall_s, c);
  out.device = times_by(&TimedTrial::frame_device_s, c);
  out.cpu = times_by(&TimedTrial::frame_cpu_s, c);
  out.rendered = times_by(&TimedTrial::frame_rendered_s, c);
  if (out.cpu.at(0.5) > kMeasurable_s) out.threads = std::max(1.0, std::round(out.cpu.at(0.5) / out.wall.at(0.5)));
  if (const std::vector<bool> contact = frames_with_contact(c); !contact.empty()) {
    out.contact_wall = times_by(&TimedTrial::frame_wall_s, c, contact);
    out.contact_device = times_by(&TimedTrial::frame_device_s, c, contact);
  }
  return out;
}

std::pair<FrameTimes, FrameTimes> common_times(const RunRecord& a, const RunRecord& b) {
  const std::vector<bool> of_a = frames_with_contact(a), of_b = frames_with_contact(b);
  std::size_t frames = SIZE_MAX - 1;
  for (const RunRecord* c : {&a, &b})
    for (const TimedTrial& t : c->trials) frames = std::min(frames, t.frame_wall_s.size());
  std::vector<bool> timed(1 + frames, true), touched = timed;
  for (std::size_t f = 0; f < timed.size(); ++f) touched[f] = f < of_a.size() && f < of_b.size() && of_a[f] && of_b[f];
  const std::vector<bool>& which =
      std::find(touched.begin() + 1, touched.end(), true) == touched.end() ? timed : touched;
  return {times_by(&TimedTrial::frame_wall_s, a, which), times_by(&TimedTrial::frame_wall_s, b, which)};
}

}  // namespace clothbench
