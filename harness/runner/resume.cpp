#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

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
bool same_settings(const RunSpec& run, const json& stored) {
  if (!run.entry->make) {
    json both = stored;
    both.merge_patch(run.settings);
    return both == stored;
  }
  try {
    return complete_settings(run.entry->info, run.settings) == complete_settings(run.entry->info, stored);
  } catch (const Error&) {
    return false;  // a setting that this version of the solver does not have
  }
}

std::string short_hash(const std::string& sha256) {
  constexpr std::size_t kShown = 12;
  return sha256.empty() ? "none" : sha256.substr(0, kShown);
}

/// The file of a finished run, else of a run that was begun, else an empty path.
fs::path stored_run(const fs::path& folder, const std::string& run) {
  if (fs::path file = finished_file(folder, run); !file.empty()) return file;
  const fs::path part = folder / (run + ".part");
  return fs::exists(part) ? part : fs::path();
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

[[noreturn]] void refuse_finished_run(const fs::path& folder, const std::string& run) {
  throw Error(fmt::format("{}: {} is already there; give another --out, or --resume to continue in this folder",
                          folder.string(), run));
}

}  // namespace

void require_same_run(const fs::path& folder, const RunSpec& run) {
  fs::path file;
  const std::optional<RunHeader> h = stored_header(folder, run_name(run), file);
  if (!h) return;
  if (h->scenario_sha256 != run.scene->sha256)
    throw Error(fmt::format("{}: stored for another scene (SHA-256 of the completed scenario {}, now {}); {}",
                            file.string(), short_hash(h->scenario_sha256), short_hash(run.scene->sha256), kWhatToDo));
  if (!same_settings(run, h->settings))
    throw Error(fmt::format("{}: run with other settings ({}, now {}); {}", file.string(),
                            shortened(h->settings.dump(), 200), shortened(run.settings.dump(), 200), kWhatToDo));
  const nlohmann::json& e = h->environment;
  const std::string version = e.is_object() ? e.value("solver_version", "") : "";
  const SolverInfo& solver = run.entry->info;
  if (run.entry->make && !version.empty() && version != solver.version)  // a crash before the start leaves none
    throw Error(fmt::format("{}: run with version {} of {}, which is now version {}; {}", file.string(), version,
                            solver.name, solver.version, kWhatToDo));
}

std::optional<RunRecord> finished_run(const RunSpec& spec, const RunOptions& options) {
  const std::string name = run_name(spec);
  const fs::path file = finished_file(options.out, name);
  if (file.empty()) return std::nullopt;
  if (!options.resume) refuse_finished_run(options.out, name);
  require_same_run(options.out, spec);
  return read_run_summary(file);
}

void require_same_runs(const fs::path& folder, const RunPlan& plan, bool resume) {
  std::set<std::string> names;
  for (const auto& group : plan.groups)
    for (const RunSpec& run : group) {
      const std::string name = run_name(run);
      if (!names.insert(name).second)
        throw Error("two runs would be stored as " + name + ": expected each scene, solver and setting once");
      require_short_name(folder, name);
      if (!resume && run_finished(folder, name)) refuse_finished_run(folder, name);
      require_same_run(folder, run);
    }
}

}  // namespace clothbench
