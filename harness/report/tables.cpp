#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "report/report.hpp"

namespace clothbench {
namespace {

struct Key {
  std::string solver, setting, sides;
  auto operator<=>(const Key&) const = default;
};

nlohmann::json scenario(const CellRecord& c) { return nlohmann::json::parse(c.header.scenario_json, nullptr, false); }

int resolution(const CellRecord& c) {
  const nlohmann::json s = scenario(c);
  return s.is_object() && s.contains("cloth") ? s["cloth"]["grid"][0].get<int>() : 0;
}

Key key_of(const CellRecord& c) {
  const nlohmann::json s = scenario(c);
  return {c.header.solver, c.header.setting, s.is_object() && s.contains("cloth") ? s["cloth"]["sides"].get<std::string>() : ""};
}

std::string number(double v, const char* format) { return std::isfinite(v) ? fmt::format(fmt::runtime(format), v) : "–"; }

double value(const CellRecord& c, const std::string& name) {
  const auto at = c.summary.find(name);
  return at == c.summary.end() ? kMissing : at->second;
}

/// Frames per second with four digits at most; spread in per cent.
std::string fps(double v) { return !std::isfinite(v) ? "–" : v >= 1000 ? fmt::format("{:.0f}", v) : fmt::format("{:.1f}", v); }

class Grid {
 public:
  explicit Grid(const std::vector<CellRecord>& cells) : cells_(cells) {
    for (const CellRecord& c : cells) {
      if (c.outcome.status == "missing") continue;  // no file, so no resolution either: a dash in its place
      if (resolution(c) > 0) sizes_.insert(resolution(c));
      const Key k = key_of(c);
      if (std::find(keys_.begin(), keys_.end(), k) == keys_.end()) keys_.push_back(k);
    }
    const auto rank = [](const Key& k) { return k.sides == "single" ? 0 : k.sides == "double-duplicated" ? 1 : 2; };
    std::stable_sort(keys_.begin(), keys_.end(), [&](const Key& a, const Key& b) {
      return std::pair(a.solver + a.setting, rank(a)) < std::pair(b.solver + b.setting, rank(b));
    });
  }

  const std::set<int>& sizes() const { return sizes_; }

  /// Rows: solver, setting, sides; columns: resolutions. A cell that did not end well says how instead.
  template <class Text>
  Table table(const std::string& title, const std::string& note, Text text) const {
    Table t{title, note, {{"solver", "sides"}}};
    for (int n : sizes_) t.rows[0].push_back(fmt::format("{}²", n));
    for (const Key& k : keys_) {
      std::vector<std::string> row = {k.setting == "default" ? k.solver : k.solver + " " + k.setting, k.sides};
      for (int n : sizes_) row.push_back(entry(k, n, text));
      t.rows.push_back(std::move(row));
    }
    return t;
  }

 private:
  template <class Text>
  std::string entry(const Key& k, int n, Text text) const {
    for (const CellRecord& c : cells_) {
      if (resolution(c) != n || key_of(c) != k) continue;
      if (c.outcome.status == "ok") return text(c);
      return c.outcome.failed_frame >= 0 ? fmt::format("{} at {}", c.outcome.status, c.outcome.failed_frame) : c.outcome.status;
    }
    return "–";
  }

  const std::vector<CellRecord>& cells_;
  std::set<int> sizes_;
  std::vector<Key> keys_;
};

void add_published(Table& t, const std::set<int>& sizes, const nlohmann::json& published) {
  const auto& resolutions = published.at("resolution");
  auto at = t.rows.begin() + 1;
  for (const auto& column : published.at("columns")) {
    std::vector<std::string> row = {"published: " + column.at("name").get<std::string>(), column.value("sides", "–")};
    for (int n : sizes) {
      std::string text = "–";
      for (std::size_t k = 0; k < resolutions.size(); ++k)
        if (resolutions[k].get<int>() == n) text = fps(column.at("fps")[k].get<double>());
      row.push_back(text);
    }
    at = t.rows.insert(at, std::move(row)) + 1;
  }
}

/// The ballistic solver's frame is what the harness itself costs.
std::string overhead_note(const std::vector<CellRecord>& cells) {
  double most = kMissing;
  for (const CellRecord& c : cells)
    if (const double t = value(c, "frame_wall_median_s"); c.header.solver == "ballistic" && c.outcome.status == "ok" && !(t <= most)) most = t;
  if (!std::isfinite(most)) return "";
  const double share = most * 72;
  return fmt::format("Harness overhead (ballistic, largest grid): {:.2g} µs, {:.3g} % of a 72 Hz frame{}.", most * 1e6, share * 100,
                     share < 0.01 ? "" : ": more than the 1 % allowed");
}

}  // namespace

std::vector<Table> fps_tables(const std::vector<CellRecord>& cells, const nlohmann::json& published) {
  const Grid grid(cells);
  std::vector<Table> tables;
  tables.push_back(grid.table("Table 3: frames per second, capped at 72",
                              "Published: Quest 3, rendering included, to the unit. Ours: mean over frames of min(72, 1/t), median of the trials.",
                              [](const CellRecord& c) { return fps(value(c, "fps_at_72")); }));
  add_published(tables.back(), grid.sizes(), published);
  tables.push_back(grid.table("Frames per second, uncapped: median of the trials ± half their range", "",
                              [](const CellRecord& c) { return fps(value(c, "fps_median")) + " ± " + number(100 * value(c, "fps_spread"), "{:.0f} %"); }));
  tables.push_back(grid.table("Wall time a frame, median [ms]", overhead_note(cells),
                              [](const CellRecord& c) { return number(1e3 * value(c, "frame_wall_median_s"), "{:.4f}"); }));
  tables.push_back(grid.table("GPU time a frame, median [ms]", "First to last timestamp of the frame's one submission; – on a CPU.",
                              [](const CellRecord& c) { return number(1e3 * value(c, "frame_device_median_s"), "{:.4f}"); }));
  tables.push_back(grid.table("Free-fall error over gT²/2 at T = 0.5 s",
                              "Greatest distance of a vertex from the closed form of the solver's own integrator.",
                              [](const CellRecord& c) { return number(value(c, "free_fall_error"), "{:.1e}"); }));
  tables.push_back(grid.table("Bytes a frame, read + written [MB]", "Counted loads and stores of the shaders; missing for CPU solvers, never modelled.",
                              [](const CellRecord& c) { return number(1e-6 * (value(c, "read_B_per_frame") + value(c, "write_B_per_frame")), "{:.3f}"); }));
  tables.push_back(grid.table("Bandwidth, peak over 5 s windows, read / written [GB/s]", "Windows of 5 s, or of the whole trial where it is shorter.",
                              [](const CellRecord& c) {
                                const double r = value(c, "bandwidth_read_peak_B_per_s"), w = value(c, "bandwidth_write_peak_B_per_s");
                                return std::isfinite(r) ? fmt::format("{:.3g} / {:.3g}", 1e-9 * r, 1e-9 * w) : std::string("–");
                              }));
  tables.push_back(grid.table("Device memory [kB] · dispatches a frame", "", [](const CellRecord& c) {
    const double m = value(c, "device_memory_B");
    return std::isfinite(m) ? fmt::format("{:.1f} · {:.0f}", 1e-3 * m, value(c, "dispatches")) : std::string("–");
  }));
  return tables;
}

std::string headline(const std::vector<CellRecord>& cells) {
  const auto missing = std::count_if(cells.begin(), cells.end(), [](const CellRecord& c) { return c.outcome.status == "missing"; });
  nlohmann::json e;
  for (const CellRecord& c : cells)
    if (c.header.environment.is_object() && (e.is_null() || e.value("gpu", "").empty()) && !c.header.environment.value("gpu", "").empty()) {
      if (c.header.environment["gpu"] == "CPU" && !e.is_null()) continue;
      e = c.header.environment;
      if (e["gpu"] == "CPU") e["gpu"] = "";
    }
  if (!e.is_object()) return "no cells\n";
  std::string out;
  if (e.value("gpu_is_software", false))
    out += fmt::format("**Software Vulkan device ({}): for correctness, not for speed claims.**\n\n", e.value("gpu", ""));
  const auto text = [&](const char* key) { return e.contains(key) && e[key].is_string() && !e[key].get<std::string>().empty() ? e[key].get<std::string>() : std::string("–"); };
  out += fmt::format("GPU {} · driver {} · CPU {} · protocol {} · commit {}{} · {} · {}\n", text("gpu"), text("driver"), text("cpu"), text("protocol"),
                     text("git_commit").substr(0, 12), e.value("git_dirty", false) ? " (with local changes)" : "", text("build_type"), text("created"));
  if (missing > 0) out += fmt::format("\n{} of {} planned cells were not run.\n", missing, cells.size());
  return out;
}

std::string cells_csv(const std::vector<CellRecord>& cells) {
  std::set<std::string> names;
  for (const CellRecord& c : cells)
    for (const auto& [name, unused] : c.summary) names.insert(name);
  std::vector<std::string> head = {"scene", "solver", "setting", "sides", "resolution", "status", "failed_frame", "message",
                                   "gpu", "driver", "gpu_is_software", "protocol", "git_commit", "created"};
  head.insert(head.end(), names.begin(), names.end());
  std::string out = csv_row(head);
  for (const CellRecord& c : cells) {
    const nlohmann::json& e = c.header.environment;
    const auto text = [&](const char* key) {
      const nlohmann::json v = e.is_object() ? e.value(key, nlohmann::json("")) : nlohmann::json("");
      return v.is_string() ? v.get<std::string>() : v.dump();
    };
    std::vector<std::string> row = {c.header.scene, c.header.solver, c.header.setting, key_of(c).sides, std::to_string(resolution(c)),
                                    c.outcome.status, std::to_string(c.outcome.failed_frame), c.outcome.message, text("gpu"), text("driver"),
                                    text("gpu_is_software"), text("protocol"), text("git_commit"), text("created")};
    for (const std::string& name : names) {
      const double v = value(c, name);
      row.push_back(std::isfinite(v) ? fmt::format("{}", v) : "");
    }
    out += csv_row(row);
  }
  return out;
}

}  // namespace clothbench
