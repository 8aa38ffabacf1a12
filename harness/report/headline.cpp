#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "base/words.hpp"
#include "report/report.hpp"
#include "report/roles.hpp"
#include "report/withheld.hpp"

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
        fmt::format("{}† is a plugin, version {}: {}. Library {}, SHA-256 {}.", c.header.solver,
                    text(e, "solver_version"), text(p, "summary"),
                    std::filesystem::path(text(p, "path")).filename().string(), text(p, "sha256").substr(0, 16));
    add(out, line);
  }
  return out;
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
      "{:.3g} µs a frame of {} with {}, whose particles only fall.\n",
      100 * share, share < kAllowedOverhead ? "below" : "**above**", 1e6 * t, most->header.scene, most->header.solver);
}

std::string window_note(const std::vector<RunRecord>& runs) {
  double least = kMissing, most = kMissing;
  for (const RunRecord& c : runs) {
    const double w = summary_value(c, "bandwidth_window_s");
    if (!std::isfinite(summary_value(c, "bandwidth_read_peak_B_per_s")) || !std::isfinite(w)) continue;
    if (!(least <= w)) least = w;
    if (!(most >= w)) most = w;
  }
  if (!std::isfinite(most)) return "";
  return fmt::format("windows of 5 s, or of the whole trial where it is shorter (here {:.2g} to {:.2g}\u00a0s)", least,
                     most);
}

std::string gpu_of(const RunRecord& c) {
  const nlohmann::json& e = c.header.environment;
  const std::string gpu = text(e, "gpu");
  if (gpu == "CPU" || gpu == "–") return "";
  return flag(e, "gpu_is_software") ? gpu + " (software; its times say nothing of a GPU)" : gpu;
}

std::string headline(const std::vector<RunRecord>& runs, Format format) {
  std::vector<std::string> software, invalid, lines, hosts;
  std::map<std::string, Span> created;
  std::map<std::string, bool> on_gpu;  // by host: whether it has a line with a GPU
  for (const RunRecord& c : runs) {
    const nlohmann::json& e = c.header.environment;
    if (!e.is_object() || e.empty()) continue;
    if (const nlohmann::json s = e.value("device_samples", nlohmann::json()); s.is_object() && !s.value("valid", true))
      for (const nlohmann::json& reason : s.value("reasons", nlohmann::json::array()))
        add(invalid, reason.get<std::string>());
    const std::string host = host_line(e);
    created[host].add(text(e, "created"));
    add(hosts, host);
    if (gpu_of(c).empty()) continue;
    if (flag(e, "gpu_is_software")) add(software, text(e, "gpu"));
    add(lines, fmt::format("GPU {} · driver {} · {}", text(e, "gpu"), text(e, "driver"), host));
    on_gpu[host] = true;
  }
  for (const std::string& host : hosts)
    if (!on_gpu[host]) lines.push_back("no GPU · " + host);
  std::string out;
  for (const std::string& device : software)
    out += fmt::format("**Software Vulkan device ({}): it shows correctness; its times say nothing of a GPU.**\n\n",
                       device);
  for (const std::string& reason : invalid) out += fmt::format("**Not a valid measurement: {}.**\n\n", reason);
  for (const std::string& line : withheld_lines(runs)) out += fmt::format("**{}**\n\n", line);
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
    if (end > at) console += wrapped(out.substr(at, end - at), 0, kConsoleColumns);
  }
  return console;
}

}  // namespace clothbench
