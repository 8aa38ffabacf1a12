// Tables of frame rates, times and memory.
#include <fmt/format.h>

#include <numeric>

#include "report/report.hpp"
#include "report/view.hpp"

namespace clothbench {
namespace {

/// "12.3 / 4.50": bytes read and written, times `scale`.
Cell bytes(const Row& r, const char* read, const char* written, double scale) {
  return paired_cell(scale * r.value(read), scale * r.value(written), 3);
}

/// Rows for a run's frame times: per clock, over all frames and over frames with contact.
constexpr std::pair<const char*, FrameTimes RunTimes::*> kClocks[] = {
    {"wall", &RunTimes::wall},  {"wall, with contact", &RunTimes::contact_wall},
    {"GPU", &RunTimes::device}, {"GPU, with contact", &RunTimes::contact_device},
    {"CPU", &RunTimes::cpu},    {"wall, with rendering", &RunTimes::rendered}};

Keys clocks_of(const Row& r) {
  Keys out;
  for (const auto& [name, times] : kClocks)
    if (!((*r.times).*times).sorted.empty()) out.emplace_back(name);
  return out;
}

std::string milliseconds(double s) { return significant(1e3 * s, 3); }

/// "2.00 (1.95–2.10)"; " ~" follows if the interval is wide.
Cell median_cell(const Row& r, const FrameTimes& t) {
  const std::string span = milliseconds(t.median.low) + "–" + milliseconds(t.median.high);
  return {milliseconds(t.at(0.5)) + (std::isfinite(t.median.low) ? " (" + span + ")" : "") +
              (t.uncertain() ? " ~" : "") + in_brackets(r.frames_mark()),
          t.at(0.5)};
}

/// "2.00 / 3.00 / 4.00"; a percentile is "–" if there are so few frames that it would be the worst frame.
Cell tails_cell(const FrameTimes& t) {
  const auto text = [&](double q) {
    return static_cast<double>(t.sorted.size()) * (1 - q) < 1 - 1e-9 ? "–" : milliseconds(t.at(q));
  };
  return {text(0.95) + " / " + text(0.99) + " / " + milliseconds(t.at(1)), t.at(0.95)};
}

/// A run and the times that a row shows; null if there are none.
using Timed = std::pair<const Row*, const FrameTimes*>;

void add_time_columns(View& v, const std::function<Timed(const Group&, const Keys&)>& of) {
  const auto add = [&](const char* head, std::function<Cell(const Row&, const FrameTimes&)> cell) {
    v.columns.push_back({head, [of, cell](const Group& g, const Keys& keys) {
                           const auto [row, times] = of(g, keys);
                           return times == nullptr || times->sorted.empty() ? Cell() : cell(*row, *times);
                         }});
  };
  add("frame p50 [ms]", median_cell);
  add("p95 / p99 / worst [ms]", [](auto&, auto& t) { return tails_cell(t); });
  add("missed 72 / 90 Hz [%]", [](auto&, auto& t) { return paired_cell(100 * t.missed(72), 100 * t.missed(90), 3); });
  add("real-time factor", [](auto& r, auto& t) { return number_cell(1 / (r.frame_rate_hz() * t.at(0.5)), 3); });
}

/// p50, p95, p99 and worst.
Cell quantiles_cell(const FrameTimes& t) {
  return t.sorted.empty() ? Cell() : Cell(milliseconds(t.at(0.5)) + " / " + tails_cell(t).text, t.at(0.5));
}

ViewColumn quantiles(const char* head, FrameTimes RunTimes::*times, const Pick& pick) {
  return column(
      head, [times](const Row& r) { return quantiles_cell((*r.times).*times); }, false, pick);
}

/// Adds columns for conditions in which the solvers of a table can differ.
void add_conditions(View& v, const Pick& pick) {
  const auto add = [&](const char* head, std::function<Cell(const Row&)> cell) {
    v.columns.push_back(column(head, std::move(cell), true, pick));
  };
  add("precision", [](const Row& r) { return environment_text(*r.run, "precision"); });
  add("device", [](const Row& r) { return short_name(environment_text(*r.run, "gpu")); });
  add("CPU threads", [](const Row& r) { return number_cell(r.times->threads, 1); });
}

View frame_times() {
  View v{"time", "Time per frame [ms]", note("frame times") + note("intervals"),
         [](const Row& r) { return r.published < 0 && !r.drawn().contains("settings") && !r.in_sweep(); }};
  v.keys = {scene_key(), solver_key(), sides_key(), {"clock", clocks_of}};
  const auto timed = [](const Group& g, const Keys& keys) {
    const auto clock =
        std::find_if(std::begin(kClocks), std::end(kClocks), [&](auto& c) { return keys.back().text == c.first; });
    return Timed{g.front(), &((*g.front()->times).*clock->second)};
  };
  const auto add_wall = [&](const std::string& head, std::function<Cell(const Row&)> text) {
    v.columns.push_back({head, [text](const Group& g, const Keys& keys) {
                           return keys.back().text == kClocks[0].first ? text(*g.front()) : Cell();
                         }});
  };
  add_time_columns(v, timed);
  v.columns.push_back(column("trials", trials_cell));
  v.columns.push_back({"frames", [timed](const Group& g, const Keys& keys) {
                         return number_cell(static_cast<double>(timed(g, keys).second->sorted.size()), 1);
                       }});
  add_wall("pipelined [ms]", [](const Row& r) { return number_cell(1e3 * r.value("frame_pipelined_median_s"), 3); });
  add_wall("load [ms]", [](const Row& r) { return number_cell(1e3 * r.value("load_s"), 3); });
  add_wall("p50: × " + time_baseline(), times_as_fast_cell);
  add_wall("rank", rank_cell);
  add_conditions(v, first_of);
  v.columns.push_back(column("conditions", &Row::trust));
  v.in_full = true;
  v.timed = true;
  return v;
}

View memory() {
  View v{"time", "Bytes and device memory per frame", note("memory"), [](const Row& r) {
           return (r.part == Part::Rates || r.part == Part::Contact || r.part == Part::Truth) && !r.in_sweep() &&
                  r.status() != "unsupported" && std::isfinite(r.value("device_memory_B"));
         }};
  v.keys = {scene_key(), solver_key(), sides_key()};
  v.columns = {column("MB per frame, read / written",
                      [](const Row& r) { return bytes(r, "read_B_per_frame", "write_B_per_frame", 1e-6); }),
               column("peak bandwidth, read / written [GB/s]",
                      [](const Row& r) {
                        return bytes(r, "bandwidth_read_peak_B_per_s", "bandwidth_write_peak_B_per_s", 1e-9);
                      }),
               column("window [s]", [](const Row& r) { return number_cell(r.value("bandwidth_window_s"), 2); }),
               column("memory [MB]", [](const Row& r) { return number_cell(1e-6 * r.value("device_memory_B"), 3); }),
               column("dispatches", [](const Row& r) { return number_cell(r.value("dispatches"), 1); }),
               column("trials", trials_cell)};
  v.in_full = true;
  v.timed = true;
  return v;
}

/// Numbers of a sustained run's windows, as keys.
Keys windows_of(const Row& r) {
  Keys out;
  for (const TimedTrial& t : r.run->trials) out.emplace_back(std::to_string(t.index + 1));
  return out;
}

View sustained() {
  View v{"time", "Frame times over time", note("sustained"),
         [](const Row& r) { return environment_of(*r.run, "window_s").is_number() && !r.run->trials.empty(); }};
  v.keys = {scene_key(), solver_key(), sides_key(), {"window", windows_of}};
  const auto add = [&](const char* head, std::function<Cell(const Row&, const TimedTrial&)> cell) {
    v.columns.push_back({head, [cell](const Group& g, const Keys& keys) {
                           const Keys windows = windows_of(*g.front());
                           const auto at = std::find(windows.begin(), windows.end(), keys.back()) - windows.begin();
                           return cell(*g.front(), g.front()->run->trials[static_cast<std::size_t>(at)]);
                         }});
  };
  const auto add_quantiles = [&](const char* head, std::vector<double> TimedTrial::*times) {
    add(head, [times](const Row&, const TimedTrial& t) {
      FrameTimes all;
      all.sorted = t.*times;
      std::erase_if(all.sorted, [](double s) { return !std::isfinite(s); });
      std::sort(all.sorted.begin(), all.sorted.end());
      return quantiles_cell(all);
    });
  };
  add("from [s]", [](const Row& r, const TimedTrial& t) {
    const double from_s = t.start_unix_s - r.run->trials.front().start_unix_s;
    return Cell(fmt::format("{:.0f}", from_s), from_s);
  });
  add_quantiles("wall: p50 / p95 / p99 / worst [ms]", &TimedTrial::frame_wall_s);
  add_quantiles("GPU: p50 / p95 / p99 / worst [ms]", &TimedTrial::frame_device_s);
  add("late [%]", [](const Row& r, const TimedTrial& t) {
    const auto late = std::count_if(t.frame_wall_s.begin(), t.frame_wall_s.end(),
                                    [&](double s) { return !(s <= 1 / r.frame_rate_hz()); });
    return number_cell(100.0 * static_cast<double>(late) / t.frames(), 3);
  });
  add("length [s]", [](const Row&, const TimedTrial& t) { return number_cell(t.end_unix_s - t.start_unix_s, 3); });
  add("CPU clock [MHz]", [](const Row&, const TimedTrial& t) { return number_cell(1e-6 * t.cpu_clock_Hz, 4); });
  add("GPU clock [MHz]", [](const Row&, const TimedTrial& t) { return number_cell(1e-6 * t.gpu_clock_Hz, 4); });
  add("temperature [°C]", [](const Row&, const TimedTrial& t) { return number_cell(t.temperature_C, 3); });
  add("GPU power [W]", [](const Row&, const TimedTrial& t) { return number_cell(t.gpu_power_W, 3); });
  add("power [W]", [](const Row&, const TimedTrial& t) { return number_cell(t.power_W, 3); });
  v.in_full = true;
  v.timed = true;
  return v;
}

View in_short(std::function<bool(const Row&)> where, const Pick& pick = first_of) {
  View v{"overview", "In short", note("in short"), std::move(where)};
  v.keys = {scene_key(), solver_key()};
  v.columns = {column("outcome",
                      [](const Row& r) {
                        const Cell judged = verdict_cell(r);
                        return judged.is_missing() ? Cell(r.status()) : judged;
                      }),
               column("stretch [%]", [](const Row& r) {
                 const double percent = 100 * r.value("stretch_max_last_second");
                 return percent > 0 && percent < 1e-3 ? Cell("<0.001", percent) : number_cell(percent, 3);
               })};
  v.columns.push_back(offset_column());
  v.columns.push_back(column("p50: × " + time_baseline(), times_as_fast_cell));
  v.columns.push_back(column("rank", rank_cell));
  v.columns.push_back(quantiles("with contact: p50 / p95 / p99 / worst [ms]", &RunTimes::contact_wall, pick));
  v.columns.push_back(quantiles("GPU, with contact [ms]", &RunTimes::contact_device, pick));
  v.columns.push_back(column("trials", trials_cell));
  add_tail_columns(v, pick, first_of);
  v.timed = true;
  return v;
}

}  // namespace

Cell ratio_cell(const Row& r, double value, const Interval& i, double by, const Interval& of_by) {
  if (&r == r.baseline) {
    const double n = r.times->threads;
    const std::string used = n > 0 ? fmt::format(", {} thread{}", n, n == 1 ? "" : "s") : "";
    return {"1.00" + in_brackets(short_name(environment_text(*r.run, "gpu")) + used), 1};
  }
  const double low = i.low / of_by.high, high = i.high / of_by.low;
  const std::string span = std::isfinite(low) ? significant(low, 3) + "–" + significant(high, 3) : "";
  const Row& shorter = r.frames() < r.baseline->frames() ? r : *r.baseline;
  return {significant(value / by, 3) + in_brackets(span) + in_brackets(shorter.frames_mark()), value / by};
}

Cell times_as_fast_cell(const Row& r) {
  if (!r.baseline || r.times->wall.sorted.empty()) return {};
  const auto [mine, other] = common_times(*r.run, *r.baseline->run);
  return ratio_cell(r, other.at(0.5), other.median, mine.at(0.5), mine.median);
}

void add_tail_columns(View& v, const Pick& pick, const Pick& about) {
  add_time_columns(v, [pick](const Group& g, const Keys&) {
    const Row* r = pick(g);
    return Timed{r, r == nullptr ? nullptr : &r->times->wall};
  });
  v.columns.push_back(quantiles("GPU: p50 / p95 / p99 / worst [ms]", &RunTimes::device, pick));
  add_conditions(v, about ? about : pick);
}

View devices() {
  View v{"rates", "Work and rate by device", note("devices"),
         [](const Row& r) { return r.elsewhere && std::isfinite(r.value("frame_device_median_s")); }};
  v.keys = {{"scene",
             [](const Row& r) {
               return Keys{r.scene, {"all", true}};
             }},
            key(
                "solver", [](const Row& r) { return label_of(*r.run); }, true),
            key("device", [](const Row& r) { return environment_text(*r.run, "gpu"); })};
  const auto add = [&](const char* head, int digits, double scale, const char* of, const char* per = nullptr) {
    const auto sum = [](const Group& g, const char* name) {
      return std::accumulate(g.begin(), g.end(), 0.0, [=](double s, const Row* r) { return s + r->value(name); });
    };
    v.columns.push_back({head, [=](const Group& g, const Keys&) {
                           return number_cell(scale * sum(g, of) / (per ? sum(g, per) : 1), digits);
                         }});
  };
  add("dispatches", 1, 1, "dispatches");
  add("read [MB]", 4, 1e-6, "read_B_per_frame");
  add("written [MB]", 4, 1e-6, "write_B_per_frame");
  add("GPU time [ms]", 3, 1e3, "frame_device_median_s");
  add("µs per dispatch", 3, 1e6, "frame_device_median_s", "dispatches");
  add("ns per byte read", 3, 1e9, "frame_device_median_s", "read_B_per_frame");
  v.by_key = v.timed = true;
  return v;
}

std::vector<View> rate_views() {
  View leading = in_short(&Row::leads, [](const Group& g) { return g.front()->on_software ? nullptr : g.front(); });
  leading.title = "Leading scenes with contact";
  leading.note = note("leading") + leading.note;
  return {std::move(leading), frame_times(), sustained(), memory()};
}

Table in_short_table(const RunTable& table) {
  const auto all = [](const Row& r) { return r.published < 0; };
  const std::vector<ViewTable> found = tables_of(in_short(all), table);
  return found.empty() ? Table{} : Table(found.front());
}

}  // namespace clothbench
