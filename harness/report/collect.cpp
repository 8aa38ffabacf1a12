#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clothbench/error.hpp"
#include "report/report.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

/// Record of a planned run without a result, from its name "<scene>__<solver>__<setting>".
RunRecord missing_run(const std::string& name, bool started) {
  RunRecord c;
  const std::size_t first = name.find("__"), last = name.rfind("__");
  c.header.scene = name.substr(0, first);
  if (first != std::string::npos && last > first) {
    c.header.solver = name.substr(first + 2, last - first - 2);
    c.header.setting = name.substr(last + 2);
  }
  c.outcome = {"missing", "ok", -1, started ? "started, not finished" : "planned, not run"};
  return c;
}

void collect_folder(const fs::path& dir, std::vector<RunRecord>& runs) {
  const std::size_t first = runs.size();
  const StudyManifest manifest = read_manifest(dir);
  for (const std::string& name : manifest.runs) {
    const fs::path file = finished_file(dir, name);
    runs.push_back(file.empty() ? missing_run(name, fs::exists(dir / (name + ".part"))) : read_run_summary(file));
  }
  // A missing run gets the scenario of its scene from a run of another solver, so that tables can place it.
  for (std::size_t k = first; k < runs.size(); ++k)
    for (std::size_t j = first; j < runs.size() && runs[k].header.scenario_json.empty(); ++j)
      if (run_name(runs[j].header).starts_with(runs[k].header.scene + "__"))
        runs[k].header.scenario_json = runs[j].header.scenario_json;
}

/// Whether a summary value is a time, or a rate computed from a time.
bool is_time(const std::string& name) {
  if (name == "load_s" || name == "untimed_s") return true;
  for (const char* start : {"fps_", "frame_", "bandwidth_", "stage_device_"})
    if (name.starts_with(start)) return true;
  return false;
}

}  // namespace

std::vector<RunRecord> withhold_times(std::vector<RunRecord> runs) {
  for (RunRecord& c : runs) {
    if (!(jobs_of(c) > 1)) continue;
    for (auto& [name, value] : c.summary)
      if (is_time(name) && std::isfinite(value)) {
        value = kMissing;
        c.withheld[name] = fmt::format("not timed alone: up to {:.0f} jobs ran side by side", jobs_of(c));
      }
    c.header.load_s = kMissing;
    c.trials.clear();
  }
  return runs;
}

std::string withheld_note(const std::vector<const Row*>& rows) {
  double most = 1;
  std::size_t count = 0;
  for (const Row* r : rows) {
    if (r->run->withheld.empty()) continue;
    ++count;
    most = std::max(most, jobs_of(*r->run));
  }
  return count == 0 ? ""
                    : fmt::format("Times of {} run{} are withheld (–) because up to {:.0f} jobs ran side by side.",
                                  count, count == 1 ? "" : "s", most);
}

std::vector<RunRecord> collect(const std::vector<fs::path>& results) {
  std::vector<RunRecord> runs;
  for (const fs::path& result : results) {
    if (!fs::exists(result)) throw Error(result.string() + ": no such file or folder");
    if (fs::is_directory(result))
      collect_folder(result, runs);
    else
      runs.push_back(read_run_summary(result));
  }
  return runs;
}

}  // namespace clothbench
