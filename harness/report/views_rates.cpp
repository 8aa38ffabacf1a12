// Tables of frame rates, times and memory.
#include <fmt/format.h>

#include <cmath>

#include "report/report.hpp"
#include "report/verdict.hpp"
#include "report/view.hpp"

namespace clothbench {
namespace {

/// "12.3 / 4.50" of the bytes read and written, times `scale`.
std::string bytes(const Row& r, const char* read, const char* written, double scale) {
  const double in = scale * r.value(read), out = scale * r.value(written);
  if (!std::isfinite(in) && !std::isfinite(out)) return "–";
  return significant(in, 3) + " / " + significant(out, 3);
}

/// "Over windows of 5 s, or of the whole trial where it is shorter (here 0.3 to 2 s)."
std::string windows(const Group& runs) {
  double least = kMissing, most = kMissing;
  for (const Row* r : runs) {
    const double w = r->value("bandwidth_window_s");
    if (!std::isfinite(r->value("bandwidth_read_peak_B_per_s")) || !std::isfinite(w)) continue;
    if (!(least <= w)) least = w;
    if (!(most >= w)) most = w;
  }
  if (!std::isfinite(most)) return "";
  return fmt::format(
      "Bandwidth: over windows of 5 s, or of the whole trial where it is shorter (here {:.2g} to {:.2g}\u00a0s).",
      least, most);
}

View errors() {
  View v{
      "rates", "Errors of the timed scenes",
      "Free fall: maximum distance of a vertex from the closed form of the solver's own integrator, over gT²/2 at "
      "T = 0.5 s. Stretch: of structural edges in the last second, over edges and frames; edges shorter than at rest "
      "count as 0 in the mean.",
      [](const Row& r) { return r.part == Part::Rates && r.published < 0; }};
  v.keys = {scene_key(), solver_key(), sides_key()};
  v.columns = {column("free-fall error",
                      [](const Row& r) {
                        const double e = r.value("free_fall_error");
                        return std::isfinite(e) ? fmt::format("{:.1e}", e) : std::string();
                      }),
               column("stretch, mean / maximum [%]", [](const Row& r) {
                 return paired(100 * r.value("stretch_mean_last_second"), 100 * r.value("stretch_max_last_second"),
                               " / ", 2);
               })};
  v.in_full = true;
  return v;
}

/// Rows of a run's frame times: by clock, of all frames and of those with contact.
constexpr std::pair<const char*, FrameTimes RunTimes::*> kClocks[] = {{"wall", &RunTimes::wall},
                                                                      {"wall, with contact", &RunTimes::contact_wall},
                                                                      {"GPU", &RunTimes::device},
                                                                      {"GPU, with contact", &RunTimes::contact_device}};

Texts clocks_of(const Row& r) {
  Texts out;
  for (const auto& [name, times] : kClocks)
    if (!((*r.times).*times).sorted.empty()) out.emplace_back(name);
  return out;
}

std::string milliseconds(double s) { return significant(1e3 * s, 3); }

/// "2.00 (1.95–2.10)"; " ~" follows if the interval is wide.
std::string median_text(const FrameTimes& t) {
  const std::string span = milliseconds(t.median.low) + "–" + milliseconds(t.median.high);
  return milliseconds(t.at(0.5)) + (std::isfinite(t.median.low) ? " (" + span + ")" : "") + (t.uncertain() ? " ~" : "");
}

std::string ratio(const Row& r) {
  return std::isfinite(r.baseline_s) ? significant(r.times->wall.at(0.5) / r.baseline_s, 3) : "";
}

std::string rank(const Row& r) { return r.rank > 0 ? std::to_string(r.rank) : ""; }

View frame_times() {
  View v{"time", "Time per frame [ms]",
         std::string("Over all trials, without rendering. Wall: from submission to fence. GPU: first to last timestamp "
                     "of the frame's one submission. Percentiles by nearest rank. Missed: frames longer than one "
                     "refresh of the display. Real-time factor: simulated time over the median. Rank: one more than "
                     "the number of runs of the scene whose whole interval of wall time is below the run's; runs that "
                     "failed, and cloths with an edge of more than twice its length, are not ranked. CPU threads: CPU "
                     "time over wall time. ") +
             kIntervalMethod,
         [](const Row& r) { return r.published < 0; }};
  v.keys = {scene_key(), solver_key(), sides_key(), {"clock", clocks_of}};
  const auto add = [&](const std::string& head, std::function<std::string(const FrameTimes&)> text) {
    v.columns.push_back({head, [text](const Group& g, const Texts& keys) {
                           for (const auto& [name, times] : kClocks)
                             if (keys.back() == name) return text((*g.front()->times).*times);
                           return std::string();
                         }});
  };
  const auto add_wall = [&](const std::string& head, std::function<std::string(const Row&)> text) {
    v.columns.push_back({head, [text](const Group& g, const Texts& keys) {
                           return keys.back() == kClocks[0].first ? text(*g.front()) : std::string();
                         }});
  };
  v.columns.push_back(trials_column());
  add("frames", [](auto& t) { return std::to_string(t.sorted.size()); });
  add("p50 (95 %)", median_text);
  for (const auto& [head, q] : {std::pair{"p95", 0.95}, {"p99", 0.99}, {"worst", 1.0}})
    add(head, [q = q](auto& t) { return milliseconds(t.at(q)); });
  for (const double rate_hz : {72.0, 90.0})
    add(fmt::format("missed at {:g} Hz [%]", rate_hz),
        [rate_hz](auto& t) { return significant(100 * t.missed(rate_hz), 3); });
  add_wall("real-time factor",
           [](const Row& r) { return significant(1 / (r.frame_rate_hz() * r.times->wall.at(0.5)), 3); });
  add_wall("× " + time_baseline(), ratio);
  add_wall("rank", rank);
  for (const auto& [head, key] : {std::pair{"precision", "precision"}, {"device", "gpu"}})
    v.columns.push_back(column(
        head, [key = key](const Row& r) { return r.environment(key); }, true));
  v.columns.push_back(column(
      "CPU threads", [](const Row& r) { return significant(r.times->threads, 1); }, true));
  v.columns.push_back(column("conditions", &Row::trust));
  v.in_full = true;
  v.timed = true;
  return v;
}

View other_clocks() {
  View v{
      "time", "Other clocks, median time per frame [ms]",
      "CPU: sum over a solver's threads. Pipelined: two frames in flight, median of the trials' means; –: the solver "
      "waits for each frame. Rendered: a frame and the images for both eyes, one after the other; the paper's rates "
      "include rendering. Load: once, before the first frame.",
      [](const Row& r) { return r.published < 0 && r.status() != "missing"; }};
  v.keys = {scene_key(), solver_key(), sides_key()};
  const auto ms = [](const char* head, const char* name) {
    return column(head, [name](const Row& r) { return milliseconds(r.value(name)); });
  };
  v.columns = {ms("CPU", "frame_cpu_median_s"), ms("pipelined", "frame_pipelined_median_s"),
               ms("with rendering, stereo", "frame_rendered_median_s"), ms("load", "load_s")};
  v.in_full = true;
  v.timed = true;
  return v;
}

View memory() {
  View v{"time", "Bytes and device memory per frame",
         "Bytes: loads and stores of the shaders, counted by instrumented kernels in a run of the same frames that is "
         "not timed; mean over the frames. Peak bandwidth: counted bytes divided by wall time. "
         "Memory: device-local buffers. CPU solvers, whose bytes are not known, are left out.",
         [](const Row& r) {
           return r.part != Part::Generated && r.part != Part::Stability && std::isfinite(r.value("device_memory_B"));
         }};
  v.keys = {scene_key(), solver_key(), sides_key()};
  v.columns = {column("kB per frame, read / written",
                      [](const Row& r) { return bytes(r, "read_B_per_frame", "write_B_per_frame", 1e-3); }),
               column("peak bandwidth, read / written [GB/s]",
                      [](const Row& r) {
                        return bytes(r, "bandwidth_read_peak_B_per_s", "bandwidth_write_peak_B_per_s", 1e-9);
                      }),
               column("memory [kB]", [](const Row& r) { return significant(1e-3 * r.value("device_memory_B"), 4); }),
               column("dispatches", [](const Row& r) { return significant(r.value("dispatches"), 1); })};
  v.more = windows;
  v.in_full = true;
  v.timed = true;
  return v;
}

View in_short() {
  View v{
      "", "In short",
      "Frame: wall time, with the 95 % interval of the median. Outcome: how the run ended, or the verdict "
      "on the scene's criteria; ignored: they are met, but the solver ignores all contact. Stretch: maximum strain of "
      "a structural edge in the last second. Not ranked: runs that failed, cloths with an edge of more than twice "
      "its length, and medians whose interval is wider than 20 % (~).",
      [](const Row& r) { return r.published < 0; }};
  v.keys = {scene_key(), solver_key()};
  const auto timed = [](const char* head, std::function<std::string(const FrameTimes&)> text) {
    return column(head, [text](const Row& r) { return r.times->wall.sorted.empty() ? "" : text(r.times->wall); });
  };
  v.columns = {
      column("outcome",
             [](const Row& r) {
               const std::string text = verdict(*r.run);
               return text == "–" ? r.status() : text;
             }),
      column("stretch [%]", [](const Row& r) { return significant(100 * r.value("stretch_max_last_second"), 3); }),
      column("frame p50 [ms]",
             [](const Row& r) {
               return r.times->wall.sorted.empty() ? "" : median_text(r.times->wall) + r.frames_mark();
             }),
      timed("p95 / p99 / worst",
            [](auto& t) {
              return milliseconds(t.at(0.95)) + " / " + milliseconds(t.at(0.99)) + " / " + milliseconds(t.at(1));
            }),
      timed("missed 72 / 90 Hz [%]", [](auto& t) { return paired(100 * t.missed(72), 100 * t.missed(90), " / ", 3); }),
      trials_column(),
      column("× " + time_baseline(), ratio),
      column("rank", rank)};
  v.timed = true;
  return v;
}

}  // namespace

std::vector<View> rate_views() { return {errors(), frame_times(), other_clocks(), memory()}; }

Table in_short_table(const std::vector<RunRecord>& runs) {
  const RunTable table(runs);
  const std::vector<ViewTable> found = tables_of(in_short(), table);
  return found.empty() ? Table{} : Table(found.front());
}

}  // namespace clothbench
