#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "base/columns.hpp"
#include "base/words.hpp"
#include "report/report.hpp"
#include "report/verdict.hpp"
#include "report/view.hpp"

namespace clothbench {
namespace {

constexpr double kDisplayHz = 72;
constexpr double kAllowedOverhead = 0.01;  // of a displayed frame

std::string text(const nlohmann::json& e, const char* key) {
  if (!e.is_object() || !e.contains(key) || !e[key].is_string() || e[key].get<std::string>().empty()) return "–";
  return e[key].get<std::string>();
}

bool flag(const nlohmann::json& e, const char* key) {
  return e.is_object() && e.contains(key) && e[key].is_boolean() && e[key].get<bool>();
}

/// Line of the properties that all runs of one study share, independent of the solver.
std::string host_line(const nlohmann::json& e) {
  return fmt::format("CPU {} · protocol {} · commit {}{} · {}", text(e, "cpu"), text(e, "protocol"),
                     text(e, "git_commit").substr(0, 12), flag(e, "git_dirty") ? " (with local changes)" : "",
                     text(e, "build_type"));
}

void add(std::vector<std::string>& lines, const std::string& line) {
  if (!contains(lines, line)) lines.push_back(line);
}

struct Span {
  std::string first, last;
  void add(const std::string& t) {
    if (t == "–") return;
    if (first.empty() || t < first) first = t;
    if (last.empty() || t > last) last = t;
  }
  std::string text() const { return first.empty() ? "–" : first == last ? first : first + " to " + last; }
};

/// A line for each build of a plugin among the runs; two builds differ by the hash.
std::vector<std::string> plugin_lines(const std::vector<RunRecord>& runs) {
  std::vector<std::string> out;
  for (const RunRecord& c : runs) {
    const nlohmann::json& e = c.header.environment;
    if (!e.is_object() || !e.contains("plugin")) continue;
    const nlohmann::json& p = e["plugin"];
    const std::string line =
        fmt::format("{} is a plugin, version {}: {}. Library {}, SHA-256 {}.", c.header.solver,
                    text(e, "solver_version"), text(p, "summary"),
                    std::filesystem::path(text(p, "path")).filename().string(), text(p, "sha256").substr(0, 16));
    add(out, line);
  }
  return out;
}

/// How many runs' times are withheld, and how many do not state whether they were timed alone.
std::vector<std::string> trust_lines(const std::vector<RunRecord>& runs) {
  std::vector<Row> rows;
  std::size_t silent = 0;
  for (const RunRecord& c : runs) {
    rows.push_back({&c});
    silent += std::isfinite(summary_value(c, "frame_wall_median_s")) && !std::isfinite(jobs_of(c));
  }
  std::vector<const Row*> all;
  for (const Row& r : rows) all.push_back(&r);
  std::vector<std::string> out;
  if (const std::string withheld = withheld_note(all); !withheld.empty()) out.push_back(withheld);
  if (silent > 0)
    out.push_back(fmt::format("{} of the timed runs {} not state whether other jobs ran beside {}.", silent,
                              silent == 1 ? "does" : "do", silent == 1 ? "it" : "them"));
  return out;
}

constexpr double kTornApart = 1;  // edges of twice their length

/// A run in the short table.
struct Short {
  Row row;
  double stretch = kMissing;     ///< maximum strain of a structural edge in the last second
  double baseline_s = kMissing;  ///< median frame of time_baseline() in the same scene
  double frame_s() const { return row.times->wall.at(0.5); }
  /// Whether its time may be compared: it ended well, and its cloth is not torn apart.
  bool ranked() const {
    return std::isfinite(frame_s()) && row.status() == "ok" && verdict(*row.run) != "fail" && !(stretch > kTornApart) &&
           !row.times->uncertain();
  }
  std::string times() const {
    const FrameTimes& t = row.times->wall;
    if (t.sorted.empty()) return "–";
    const auto ms = [](double s) { return significant(1e3 * s, 3); };
    return ms(t.at(0.5)) +
           (std::isfinite(t.median.low) ? " (" + ms(t.median.low) + "–" + ms(t.median.high) + ")" : "") +
           (row.times->uncertain() ? " ~" : "") + row.frames_mark();
  }
};

Short short_of(const RunRecord& c) {
  Short s{{&c}};
  s.row.scene = c.header.scene;
  s.row.times = std::make_shared<RunTimes>(times_of(c));
  s.stretch = summary_value(c, "stretch_max_last_second");
  return s;
}

}  // namespace

std::string overhead_line(const std::vector<RunRecord>& runs) {
  const RunRecord* most = nullptr;
  for (const RunRecord& c : runs) {
    if (!is_floor(c.header.solver) || c.outcome.status != "ok") continue;
    const double t = summary_value(c, "frame_wall_median_s");
    if (std::isfinite(t) && (most == nullptr || t > summary_value(*most, "frame_wall_median_s"))) most = &c;
  }
  if (most == nullptr) return "";
  const double t = summary_value(*most, "frame_wall_median_s"), share = t * kDisplayHz;
  return fmt::format(
      "Harness overhead: at most {:.2g} % of a 72 Hz frame (13.89 ms), {} the 1 % allowed. Measured: "
      "{:.3g} µs per frame of {} with {}, whose particles only fall.\n",
      100 * share, share < kAllowedOverhead ? "below" : "**above**", 1e6 * t, most->header.scene, most->header.solver);
}

std::vector<std::string> warnings_of(const std::vector<RunRecord>& runs) {
  std::vector<std::string> software, invalid, out;
  for (const RunRecord& c : runs) {
    const nlohmann::json& e = c.header.environment;
    if (!e.is_object() || e.empty()) continue;
    if (const nlohmann::json s = e.value("device_samples", nlohmann::json()); s.is_object() && !s.value("valid", true))
      for (const nlohmann::json& reason : s.value("reasons", nlohmann::json::array()))
        add(invalid, reason.get<std::string>());
    if (!gpu_of(c).empty() && flag(e, "gpu_is_software")) add(software, text(e, "gpu"));
  }
  for (const std::string& device : software)
    out.push_back(
        fmt::format("Software Vulkan device ({}): it shows correctness; its times say nothing of a GPU.", device));
  for (const std::string& reason : invalid) out.push_back(fmt::format("Not a valid measurement: {}.", reason));
  for (const std::string& line : trust_lines(runs)) out.push_back(line);
  return out;
}

std::string headline(const std::vector<RunRecord>& runs, Format format) {
  std::vector<std::string> lines, hosts;
  std::map<std::string, Span> created;
  std::map<std::string, bool> on_gpu;  // by host: whether it has a line with a GPU
  for (const RunRecord& c : runs) {
    const nlohmann::json& e = c.header.environment;
    if (!e.is_object() || e.empty()) continue;
    const std::string host = host_line(e);
    created[host].add(text(e, "created"));
    add(hosts, host);
    if (gpu_of(c).empty()) continue;
    add(lines, fmt::format("GPU {} · driver {} · {}", text(e, "gpu"), text(e, "driver"), host));
    on_gpu[host] = true;
  }
  for (const std::string& host : hosts)
    if (!on_gpu[host]) lines.push_back("no GPU · " + host);
  std::string out;
  for (const std::string& w : warnings_of(runs)) out += "**" + w + "**\n\n";
  for (const std::string& line : lines) {
    std::string host = line;
    for (const auto& [key, span] : created)
      if (line.ends_with(key)) host = line + " · " + span.text();
    out += host + "\n\n";
  }
  if (lines.empty()) out += "No run states its machine.\n\n";
  for (const std::string& line : plugin_lines(runs)) out += line + "\n\n";
  out += overhead_line(runs);
  if (format == Format::Markdown) return out;
  for (std::size_t at; (at = out.find("**")) != std::string::npos;) out.erase(at, 2);
  std::string console;
  for (std::size_t at = 0, end; at < out.size(); at = end + 1) {
    end = out.find('\n', at);
    if (end > at) console += wrapped(out.substr(at, end - at), 0, console_columns());
  }
  return console;
}

Table in_short_table(const std::vector<RunRecord>& runs) {
  std::map<std::string, std::vector<Short>> scenes;
  for (const RunRecord& c : runs) scenes[c.header.scene].push_back(short_of(c));
  std::vector<Short> all;
  for (auto& [scene, rows] : scenes) {
    std::stable_sort(rows.begin(), rows.end(), [](const Short& a, const Short& b) {
      if (a.ranked() != b.ranked()) return a.ranked();
      return a.frame_s() < b.frame_s() || (std::isnan(b.frame_s()) && !std::isnan(a.frame_s()));
    });
    int most_frames = 0;
    double baseline_s = kMissing;
    for (const Short& r : rows) {
      most_frames = std::max(most_frames, r.row.frames());
      if (r.row.run->header.solver == time_baseline() && r.row.run->header.setting == "default")
        baseline_s = r.frame_s();
    }
    for (Short& r : rows) {
      r.row.most_frames = most_frames;
      r.baseline_s = baseline_s;
      all.push_back(r);
    }
  }
  Group beside;
  for (const Short& s : all) beside.push_back(&s.row);
  const auto ended = [](const Short& s) {
    const std::string v = verdict(*s.row.run);
    return v == "–" ? s.row.status() : v;
  };
  const auto ratio = [](const Short& s) {
    if (!s.ranked()) return std::string(std::isfinite(s.frame_s()) ? "not ranked" : "–");
    return std::isfinite(s.baseline_s) ? significant(s.frame_s() / s.baseline_s, 3) + "×" : std::string("–");
  };
  const auto tail = [](const Short& s) {
    const FrameTimes& t = s.row.times->wall;
    return t.sorted.empty() ? std::string("–")
                            : significant(1e3 * t.at(0.95), 3) + " / " + significant(1e3 * t.at(0.99), 3) + " / " +
                                  significant(1e3 * t.at(1), 3);
  };
  const auto missed = [](const Short& s) {
    return paired(100 * s.row.times->wall.missed(72), 100 * s.row.times->wall.missed(90), " / ", 3);
  };
  const Columns<Short> columns = {{"", "scene", [](auto& s) { return s.row.scene; }},
                                  {"", "solver", [](auto& s) { return label_of(*s.row.run); }},
                                  {"", "outcome", ended},
                                  {"", "stretch", &Short::stretch, digits(3), {"%", 100}},
                                  {"", "frame p50 [ms]", &Short::times},
                                  {"", "p95 / p99 / worst", tail},
                                  {"", "missed 72 / 90 Hz [%]", missed},
                                  {"", "trials", [](auto& s) { return s.row.run->trials.size(); }},
                                  {"", "of " + time_baseline(), ratio}};
  return columns.table(
      {"In short",
       "Frame: wall time, with the 95 % interval of the median. Outcome: how the run ended, or the verdict "
       "on the scene's criteria; ignored: they are met, but the solver ignores all contact. Stretch: maximum strain of "
       "a structural edge in the last second. Not ranked: runs that failed, cloths with an edge of more than twice "
       "its length, and medians whose interval is wider than 20 % (~)." +
           std::string(" ") + withheld_note(beside),
       {}},
      all);
}

}  // namespace clothbench
