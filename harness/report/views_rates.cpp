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

std::string capped(const Row& r) {
  const double v = r.value("fps_at_72");
  return r.published < 0 ? rate_text(v) : fmt::format("{:g}", v);
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

constexpr const char *kAllFrames = "all", *kContactFrames = "with contact";

const FrameTimes& times(const Row& r, const Texts& keys, bool device) {
  const RunTimes& t = *r.times;
  if (keys.back() == kContactFrames) return device ? t.contact_device : t.contact_wall;
  return device ? t.device : t.wall;
}

std::string milliseconds(double s) { return significant(1e3 * s, 3); }

ViewColumn of_times(std::string head, bool device, std::function<std::string(const FrameTimes&)> text) {
  return {std::move(head), [=](const Group& g, const Texts& keys) {
            const FrameTimes& t = times(*g.front(), keys, device);
            return t.sorted.empty() ? std::string() : text(t);
          }};
}

/// A row for all frames; a second one for the frames with contact where the scene has some.
View frame_times(const char* title, const std::string& note, bool device) {
  View v{"time", title, note + " Percentiles by nearest rank. " + kIntervalMethod,
         [device](const Row& r) { return !(device ? r.times->device : r.times->wall).sorted.empty(); }};
  v.keys = {scene_key(),
            solver_key(),
            sides_key(),
            {"frames", [](const Row& r) {
               return r.times->contact_wall.sorted.empty() ? Texts{kAllFrames} : Texts{kAllFrames, kContactFrames};
             }}};
  v.columns = {{"trials", [](const Group& g, const Texts&) { return std::to_string(g.front()->run->trials.size()); }},
               of_times("number of frames", device, [](auto& t) { return std::to_string(t.sorted.size()); }),
               {"p50 (95 %)",
                [device](const Group& g, const Texts& keys) {
                  const FrameTimes& t = times(*g.front(), keys, device);
                  const std::string span = milliseconds(t.median.low) + "–" + milliseconds(t.median.high);
                  if (t.sorted.empty()) return std::string();
                  return milliseconds(t.at(0.5)) + (std::isfinite(t.median.low) ? " (" + span + ")" : "") +
                         (t.median.high - t.median.low > 0.2 * t.at(0.5) ? " ~" : "");
                }},
               of_times("p95", device, [](auto& t) { return milliseconds(t.at(0.95)); }),
               of_times("p99", device, [](auto& t) { return milliseconds(t.at(0.99)); }),
               of_times("worst", device, [](auto& t) { return milliseconds(t.at(1)); })};
  for (const double rate_hz : {72.0, 90.0})
    v.columns.push_back(of_times(fmt::format("missed at {:g} Hz [%]", rate_hz), device,
                                 [rate_hz](auto& t) { return significant(100 * t.missed(rate_hz), 3); }));
  v.in_full = true;
  v.timed = true;
  return v;
}

std::string of_environment(const Row& r, const char* key) {
  const nlohmann::json e = environment_of(*r.run, key);
  return e.is_string() ? e.get<std::string>() : "";
}

/// Conditions of a run, each only where the rows of a table differ in it.
std::vector<ViewColumn> conditions() {
  return {column(
              "precision", [](const Row& r) { return of_environment(r, "precision"); }, true),
          column(
              "CPU threads", [](const Row& r) { return significant(r.times->threads, 1); }, true),
          column(
              "device",
              [](const Row& r) {
                const std::string gpu = of_environment(r, "gpu");
                return gpu.empty() || gpu == "CPU" ? "CPU" : gpu;
              },
              true),
          column(
              "conditions", [](const Row& r) { return r.trust(); }, false)};
}

View wall_times() {
  View v = frame_times("Wall time per frame [ms]",
                       "From submission to fence, over all trials, without rendering. Missed: frames longer than one "
                       "refresh of the display. Real-time factor: simulated time over the median. Rank: one more than "
                       "the number of runs of the scene whose whole interval is below the run's; runs that failed are "
                       "not ranked.",
                       false);
  const auto in_all = [](auto text) {
    return [text](const Group& g, const Texts& keys) {
      return keys.back() == kAllFrames ? text(*g.front()) : std::string();
    };
  };
  v.columns.push_back({"real-time factor", [](const Group& g, const Texts& keys) {
                         const double frame_s = times(*g.front(), keys, false).at(0.5);
                         return significant(1 / (g.front()->frame_rate_hz() * frame_s), 3);
                       }});
  v.columns.push_back({"× " + time_baseline(), in_all([](const Row& r) {
                         return std::isfinite(r.baseline_s) ? significant(r.times->wall.at(0.5) / r.baseline_s, 3)
                                                            : std::string();
                       })});
  v.columns.push_back(
      {"rank", in_all([](const Row& r) { return r.rank > 0 ? std::to_string(r.rank) : std::string(); })});
  for (ViewColumn& c : conditions()) v.columns.push_back(std::move(c));
  return v;
}

View gpu_times() {
  return frame_times(
      "GPU time per frame [ms]",
      "First to last timestamp of the frame's one submission, over all trials. CPU solvers are left out.", true);
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

}  // namespace

View cost_view() {
  View v{"contact", "Cost", std::string("Bytes: ") + kBytes + " Memory: device-local buffers. –: a CPU solver.",
         [](const Row& r) { return r.part == Part::Contact; }};
  v.keys = {scene_key(), solver_key(), sides_key()};
  v.columns = {column("kB per frame, read / written",
                      [](const Row& r) { return bytes(r, "read_B_per_frame", "write_B_per_frame", 1e-3); }),
               column("memory [kB]", [](const Row& r) { return significant(1e-3 * r.value("device_memory_B"), 4); }),
               column("dispatches", [](const Row& r) { return significant(r.value("dispatches"), 1); })};
  v.in_full = true;
  return v;
}

std::vector<View> rate_views() {
  std::vector<View> out = {
      table3(),
      rates("Frames per second, uncapped", std::string("Median of the trials. ") + kIntervalMethod, rate_with_interval),
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
  out[5].more = windows;
  for (auto* more : {wall_times, gpu_times, other_clocks}) out.push_back(more());
  return out;
}

}  // namespace clothbench
