#include "report/frame_times.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "report/run_table.hpp"

namespace clothbench {
namespace {

constexpr std::size_t kResamples = 400, kBlock = 16, kMinBlocks = 8, kMinFrames = 6;
constexpr double kWide = 0.2;
constexpr double kMeasurable_s = 2e-5;  // in shorter frames, reading the clock takes most of the CPU time

using Series = std::vector<double>;

Interval95 percentiles(Series estimates) {
  std::sort(estimates.begin(), estimates.end());
  return {quantile(estimates, 0.025), quantile(estimates, 0.975)};
}

/// Bootstrap over trials and blocks of their frames.
class Bootstrap {
 public:
  explicit Bootstrap(const std::vector<Series>& trials) {
    for (const Series& t : trials) {
      if (t.empty()) continue;
      const std::size_t length = std::clamp<std::size_t>(t.size() / kMinBlocks, 1, kBlock);
      const std::size_t count = std::max<std::size_t>(1, t.size() / length), first = sum_.size();
      sum_.resize(first + count);
      frames_.resize(first + count);
      for (std::size_t f = 0; f < t.size(); ++f) {
        const std::size_t block = first + std::min(f / length, count - 1);  // the rest joins the last block
        pooled_.emplace_back(t[f], block);
        sum_[block] += t[f];
        frames_[block] += 1;
      }
      trials_.emplace_back(first, count);
    }
    std::sort(pooled_.begin(), pooled_.end());
  }

  /// 95 % intervals of the median time and of the median over trials of the rate [1/s].
  std::pair<Interval95, Interval95> intervals() const {
    if (pooled_.size() < kMinFrames) return {};
    std::mt19937_64 random;                        // the same numbers on every machine
    std::vector<std::size_t> weight(sum_.size());  // of the blocks
    Series medians, rates, drawn;
    for (std::size_t n = 0; n < kResamples; ++n) {
      std::fill(weight.begin(), weight.end(), 0);
      drawn.clear();
      for (std::size_t t = 0; t < trials_.size(); ++t) {
        const auto [first, count] = trials_[random() % trials_.size()];
        double sum = 0, frames = 0;
        for (std::size_t k = 0; k < count; ++k) {
          const std::size_t block = first + random() % count;
          ++weight[block];
          sum += sum_[block];
          frames += frames_[block];
        }
        drawn.push_back(frames / sum);
      }
      std::sort(drawn.begin(), drawn.end());
      rates.push_back(middle(drawn));
      medians.push_back(median(weight));
    }
    return {percentiles(std::move(medians)), percentiles(std::move(rates))};
  }

  Series times() const {
    Series out;
    for (const auto& [time, unused] : pooled_) out.push_back(time);
    return out;
  }

 private:
  double median(const std::vector<std::size_t>& weight) const {
    std::size_t all = 0, below = 0;
    for (const auto& [unused, block] : pooled_) all += weight[block];
    for (const auto& [time, block] : pooled_)
      if (below += weight[block]; 2 * below >= all) return time;
    return kMissing;
  }

  std::vector<std::pair<double, std::size_t>> pooled_;       ///< (time, block), ascending
  Series sum_, frames_;                                      ///< by block
  std::vector<std::pair<std::size_t, std::size_t>> trials_;  ///< first block and their number
};

/// Whether the cloth touches something in each frame of the scene, frame 0 included; empty if no metric states it.
std::vector<bool> frames_with_contact(const RunRecord& c) {
  std::vector<bool> out;
  for (const MetricSeries& m : c.accuracy.metrics) {
    if (m.name != "touching_fraction" && m.name != "contact_length_m" && m.name != "depth_m" &&
        m.name != "self_contact_length_m")
      continue;
    out.resize(std::max(out.size(), m.values.size()));
    for (std::size_t f = 0; f < m.values.size(); ++f) out[f] = out[f] || m.values[f] > 0;
  }
  return out;
}

/// The finite times of all trials. If `contact` is not empty, frames without contact are left out.
FrameTimes times_by(Series TimedTrial::*clock, const RunRecord& c, const std::vector<bool>& contact = {}) {
  std::vector<Series> trials;
  for (const TimedTrial& t : c.trials) {
    Series kept;
    for (std::size_t f = 0; f < (t.*clock).size(); ++f)
      if (std::isfinite((t.*clock)[f]) && (contact.empty() || (f + 1 < contact.size() && contact[f + 1])))
        kept.push_back((t.*clock)[f]);
    trials.push_back(std::move(kept));
  }
  const Bootstrap b(trials);
  const auto [median, rate] = b.intervals();
  return {b.times(), median, rate};
}

}  // namespace

const char* const kIntervalMethod =
    "In brackets: 95 % interval of the median, by a bootstrap over trials and blocks of at most 16 consecutive frames "
    "(400 resamples); one trial has no variation between trials in it. ~: the interval is wider than 20 % of the "
    "median, so the run is not ranked.";

double FrameTimes::at(double q) const { return quantile(sorted, q); }

double FrameTimes::missed(double rate_hz) const {
  if (sorted.empty()) return kMissing;
  const auto late = sorted.end() - std::upper_bound(sorted.begin(), sorted.end(), 1 / rate_hz);
  return static_cast<double>(late) / static_cast<double>(sorted.size());
}

bool FrameTimes::uncertain() const { return median.high - median.low > kWide * at(0.5); }

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

}  // namespace clothbench
