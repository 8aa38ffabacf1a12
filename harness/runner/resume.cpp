#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "results/result_folder.hpp"
#include "results/store.hpp"
#include "runner/study_runner.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kWhatToDo = "results of both would be mixed; give another --out, or undo the change";

/// Where a solver is known both are completed: a process that crashed has stored settings as they were given.
bool same_settings(const PlannedRun& run, const json& stored) {
  if (run.solver == nullptr) {
    json both = stored;
    both.merge_patch(run.settings);
    return both == stored;
  }
  try {
    return complete_settings(*run.solver, run.settings) == complete_settings(*run.solver, stored);
  } catch (const Error&) {
    return false;  // a setting that this version of the solver does not have
  }
}

/// Null if there is none. Another process of a sharded study may be finishing the run: its part file then disappears.
std::optional<RunHeader> stored_header(const fs::path& folder, const std::string& run, fs::path& file) {
  for (int attempt = 0;; ++attempt) {
    file = stored_run(folder, run);
    if (file.empty()) return std::nullopt;
    try {
      return read_run_summary(file).header;
    } catch (const Error&) {
      if (fs::exists(file) || attempt > 0) throw;
    }
  }
}

}  // namespace

std::string short_hash(const std::string& sha256) {
  constexpr std::size_t kShown = 12;
  return sha256.empty() ? "none" : sha256.substr(0, kShown);
}

PlannedRun planned_run(const RunSpec& spec) {
  return {run_name(spec), spec.scene->sha256, spec.settings, spec.entry->make ? &spec.entry->info : nullptr};
}

fs::path stored_run(const fs::path& folder, const std::string& run) {
  if (fs::path file = finished_file(folder, run); !file.empty()) return file;
  const fs::path part = folder / (run + ".part");
  return fs::exists(part) ? part : fs::path();
}

void require_same_run(const fs::path& folder, const PlannedRun& run) {
  fs::path file;
  const std::optional<RunHeader> h = stored_header(folder, run.name, file);
  if (!h) return;
  if (h->scenario_sha256 != run.scenario_sha256)
    throw Error(fmt::format("{}: stored for another scene (SHA-256 of the completed scenario {}, now {}); {}",
                            file.string(), short_hash(h->scenario_sha256), short_hash(run.scenario_sha256), kWhatToDo));
  if (!same_settings(run, h->settings))
    throw Error(fmt::format("{}: run with other settings ({}, now {}); {}", file.string(),
                            shortened(h->settings.dump(), 200), shortened(run.settings.dump(), 200), kWhatToDo));
  const nlohmann::json& e = h->environment;
  const std::string version = e.is_object() ? e.value("solver_version", "") : "";
  if (run.solver != nullptr && !version.empty() &&
      version != run.solver->version)  // a crash before the start leaves none
    throw Error(fmt::format("{}: run with version {} of {}, which is now version {}; {}", file.string(), version,
                            run.solver->name, run.solver->version, kWhatToDo));
}

void refuse_finished_run(const fs::path& folder, const std::string& run) {
  throw Error(fmt::format("{}: {} is already there; give another --out, or --resume to continue in this folder",
                          folder.string(), run));
}

void require_same_runs(const fs::path& folder, const std::vector<PlannedRun>& runs, bool resume) {
  for (const PlannedRun& run : runs) {
    require_short_name(folder, run.name);
    if (!resume && run_finished(folder, run.name)) refuse_finished_run(folder, run.name);
    require_same_run(folder, run);
  }
}

}  // namespace clothbench
