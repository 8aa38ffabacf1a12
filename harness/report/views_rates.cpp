// Tables of frame rates and times.
#include <fmt/format.h>

#include <cmath>
#include <set>

#include "report/verdict.hpp"
#include "report/view.hpp"

namespace clothbench {
namespace {

constexpr const char* kBytes =
    "loads and stores of the shaders, computed from the scene and the kernels' loops; tests compare them "
    "with instrumented kernels. ≥: a lower bound, where the bytes read depend on the shape of the cloth, "
    "as in contact. Retries of atomics are not counted.";

/// At most four digits; larger values in thousands or millions.
std::string fps(double v) {
  if (!std::isfinite(v)) return "–";
  if (v >= 999500) return significant(1e-6 * v, 3) + "M";
  return v >= 9999.5 ? significant(1e-3 * v, 3) + "k" : fmt::format("{:.{}f}", v, v >= 1000 ? 0 : 1);
}

std::string capped(const Row& r) {
  const double v = r.value("fps_at_72");
  return r.published < 0 ? fps(v) : fmt::format("{:g}", v);
}

std::string with_half_range(const Row& r) {
  const double v = r.value("fps_median"), spread = r.value("fps_spread");
  if (!std::isfinite(v)) return "–";
  return fps(v) + " ± " +
         (std::isfinite(spread) ? fmt::format("{:.{}f} %", 100 * spread, spread >= 0.0995 ? 0 : 1) : "–");
}

/// "≥ 12.3 / 4.50" of the bytes read and written, times `scale`; ≥ where the bytes read are a lower bound.
std::string bytes(const Row& r, const char* read, const char* written, double scale) {
  const double in = scale * r.value(read), out = scale * r.value(written);
  if (!std::isfinite(in) && !std::isfinite(out)) return "–";
  const bool bound = std::isfinite(in) && std::any_of(r.run->header.stages.begin(), r.run->header.stages.end(),
                                                      [](const StageRecord& s) { return s.bytes == "at least"; });
  return (bound ? "≥ " : "") + significant(in, 3) + " / " + significant(out, 3);
}

/// "windows of 5 s, or of the whole trial where it is shorter (here 0.3 to 2 s)".
std::string windows(const Group& runs) {
  double least = kMissing, most = kMissing;
  for (const Row* r : runs) {
    const double w = r->value("bandwidth_window_s");
    if (!std::isfinite(r->value("bandwidth_read_peak_B_per_s")) || !std::isfinite(w)) continue;
    if (!(least <= w)) least = w;
    if (!(most >= w)) most = w;
  }
  return std::isfinite(most) ? fmt::format(
                                   "Over windows of 5 s, or of the whole trial where it is shorter (here {:.2g} "
                                   "to {:.2g}\u00a0s).",
                                   least, most)
                             : "";
}

/// What wraps the engine of a published row.
std::string peers(const Group& runs) {
  const nlohmann::json published = published_table3();
  std::string out;
  std::set<std::string> named;
  for (const Row* r : runs)
    for (const nlohmann::json& column : published.at("columns"))
      if (const std::string engine = engine_of(*r->run); !engine.empty() && column.value("engine", "") == engine)
        if (named.insert(r->label()).second) out += fmt::format(" {}: {}", r->label(), column.value("peer", ""));
  return out.empty() ? "" : out.substr(1);
}

/// One value of each run of a family: a row per solver, a column per resolution.
View rates(const std::string& title, const std::string& note, std::function<std::string(const Row&)> text,
           bool timed = true) {
  View v{"rates", title, note, [](const Row& r) { return r.part == Part::Rates && r.published < 0; }};
  v.keys = {solver_key(), sides_key()};
  const auto cell = [=](const Group& g) -> std::string {
    const Row& r = *g.front();
    const std::string value = r.status() == "ok" ? text(r) : "";
    return value.empty() || value == "–" || !timed ? value : value + r.frames_mark();
  };
  const auto ended = [](const Group& g) { return g.front()->status() == "ok" ? "" : ending(g.front()->run->outcome); };
  v.across = {key("", [](const Row& r) { return r.resolution.label(); }),
              cell,
              [](const Row& r) { return r.resolution.size(); },
              {},
              ended};
  v.each = [title](const Row& r) { return r.paper_table == 3 ? title : title + " (" + r.family + ")"; };
  v.timed = timed;
  return v;
}

View milliseconds(const char* title, const char* note, const char* name) {
  return rates(title, note, [name](const Row& r) { return significant(1e3 * r.value(name), 3); });
}

View table3() {
  View v = rates("Frames per second, capped at 72",
                 "Median of the trials' means over frames of min(72, 1/t), without rendering.", capped);
  v.where = [](const Row& r) { return r.part == Part::Rates; };
  v.each = [](const Row& r) {
    return r.paper_table == 3 ? "Table 3: frames per second, capped at 72"
                              : "Frames per second, capped at 72 (" + r.family + ")";
  };
  v.more = [](const Group& runs) -> std::string {
    if (runs.front()->paper_table != 3) return "";
    return "Published: Quest 3, with rendering, rounded to whole frames. 11 of the 15 published values are the "
           "display's 72, so this table does not distinguish solvers; the next one does. " +
           peers(runs);
  };
  return v;
}

/// All timed frames of a run, ascending [s].
std::vector<double> frames(const Row& r, std::vector<double> TimedTrial::*series) {
  std::vector<double> out;
  for (const TimedTrial& t : r.run->trials)
    for (const double s : t.*series)
      if (std::isfinite(s)) out.push_back(s);
  std::sort(out.begin(), out.end());
  return out;
}

ViewColumn quantiles(const std::string& head, std::vector<double> TimedTrial::*series) {
  return column(head, [series](const Row& r) -> std::string {
    const std::vector<double> all = frames(r, series);
    if (all.empty()) return "";
    std::string out;
    for (const double q : {0.5, 0.95, 0.99, 1.0})
      out += (out.empty() ? "" : " / ") + significant(1e3 * quantile(all, q), 3);
    return out;
  });
}

/// Percentage of frames that took longer than one refresh of a display.
ViewColumn missed(double rate_hz) {
  return column(fmt::format("missed at {:g} Hz [%]", rate_hz), [rate_hz](const Row& r) -> std::string {
    const std::vector<double> all = frames(r, &TimedTrial::frame_wall_s);
    if (all.empty()) return "";
    const auto late = all.end() - std::upper_bound(all.begin(), all.end(), 1 / rate_hz);
    return significant(100 * static_cast<double>(late) / static_cast<double>(all.size()), 3);
  });
}

View time_of_a_frame() {
  View v{
      "time", "Time per frame: median, 95th and 99th percentile, maximum",
      "Over all frames of all trials, nearest rank, without rendering. Missed: frames whose wall time is longer than "
      "one refresh of the display. Real-time factor: simulated time over the median wall time.",
      [](const Row& r) { return !r.run->trials.empty(); }};
  v.keys = {scene_key(), solver_key(), sides_key()};
  v.columns = {
      column("trials × frames", [](const Row& r) { return fmt::format("{} × {}", r.run->trials.size(), r.frames()); }),
      quantiles("wall p50 / p95 / p99 / max [ms]", &TimedTrial::frame_wall_s),
      missed(72),
      missed(90),
      quantiles("GPU p50 / p95 / p99 / max [ms]", &TimedTrial::frame_device_s),
      column("real-time factor", [](const Row& r) {
        return significant(1 / (r.frame_rate_hz() * quantile(frames(r, &TimedTrial::frame_wall_s), 0.5)), 3);
      })};
  v.in_full = true;
  v.timed = true;
  return v;
}

}  // namespace

View cost_view() {
  View v{"contact", "Cost", std::string("Bytes: ") + kBytes + " Memory: device-local buffers. –: a CPU solver.",
         [](const Row& r) { return r.part == Part::Contact; }};
  v.keys = {scene_key(), solver_key(), sides_key()};
  v.columns = {column("kB per frame, read / written",
                      [](const Row& r) { return bytes(r, "read_B_per_frame", "write_B_per_frame", 1e-3); }),
               column("memory [kB]", [](const Row& r) { return significant(1e-3 * r.value("device_memory_B"), 4); }),
               column("dispatches", [](const Row& r) { return significant(r.value("dispatches"), 1); }),
               column("load [ms]", [](const Row& r) { return significant(1e3 * r.value("load_s"), 3); })};
  v.timed = true;
  v.in_full = true;
  return v;
}

std::vector<View> rate_views() {
  std::vector<View> out = {
      table3(),
      rates("Frames per second, uncapped", "Median of the trials ± half their range.", with_half_range),
      milliseconds("Wall time per frame [ms]", "Median over all timed frames.", "frame_wall_median_s"),
      milliseconds("CPU time per frame [ms]",
                   "Median over the same frames; the sum over a solver's threads. –: a GPU solver.",
                   "frame_cpu_median_s"),
      milliseconds("Frame time with rendering, stereo [ms]",
                   "Median wall time of a frame and the images for both eyes, one after the other; the result file has "
                   "the size of the images. A GPU solver's buffer is drawn in place; a CPU solver's positions are "
                   "uploaded. The paper's FPS include rendering.",
                   "frame_rendered_median_s"),
      milliseconds("Wall time per frame, pipelined [ms]",
                   "Two frames in flight; median of the trials' means. –: the solver waits for each frame.",
                   "frame_pipelined_median_s"),
      milliseconds("GPU time per frame [ms]",
                   "Median; first to last timestamp of the frame's one submission. –: a CPU solver.",
                   "frame_device_median_s"),
      rates(
          "Free-fall error over gT²/2 at T = 0.5 s",
          "Maximum distance of a vertex from the closed form of the solver's own integrator.",
          [](const Row& r) {
            const double e = r.value("free_fall_error");
            return std::isfinite(e) ? fmt::format("{:.1e}", e) : std::string("–");
          },
          false),
      rates(
          "Stretch of structural edges in the last second, mean / maximum [%]",
          "Mean and maximum over edges and frames. Edges shorter than at rest count as 0 in the mean.",
          [](const Row& r) {
            return paired(100 * r.value("stretch_mean_last_second"), 100 * r.value("stretch_max_last_second"), " / ",
                          2);
          },
          false),
      rates(
          "kB per frame, read / written",
          std::string("Bytes: ") + kBytes + " –: a CPU solver, whose bytes are not known.",
          [](const Row& r) { return bytes(r, "read_B_per_frame", "write_B_per_frame", 1e-3); }, false),
      rates("Peak bandwidth, read / written [GB/s]", "Computed bytes divided by wall time.",
            [](const Row& r) { return bytes(r, "bandwidth_read_peak_B_per_s", "bandwidth_write_peak_B_per_s", 1e-9); }),
      rates(
          "Device memory [kB] · dispatches per frame", "Buffers in device-local memory. –: a CPU solver.",
          [](const Row& r) {
            const double m = r.value("device_memory_B"), d = r.value("dispatches");
            return std::isfinite(m) || std::isfinite(d) ? significant(1e-3 * m, 4) + " · " + significant(d, 1)
                                                        : std::string("–");
          },
          false)};
  out[10].more = windows;
  out.push_back(time_of_a_frame());
  return out;
}

}  // namespace clothbench
