#include "render/run_motion.hpp"

#include <algorithm>

#include "clothbench/error.hpp"

namespace clothbench::render {
namespace {

namespace fs = std::filesystem;

/// Result files of a folder whose names have `wanted` in them. Throws Error where that leaves it open which are meant.
std::vector<fs::path> runs_in(const fs::path& folder, const std::string& wanted) {
  std::vector<fs::path> all, found;
  for (const auto& entry : fs::directory_iterator(folder))
    if (is_run(entry.path())) all.push_back(entry.path());
  std::sort(all.begin(), all.end());
  for (const fs::path& p : all)
    if (p.stem().string().find(wanted) != std::string::npos) found.push_back(p);
  if (!found.empty() && (!wanted.empty() || found.size() == 1)) return found;
  std::string names;
  for (const fs::path& p : all) names += "\n  " + p.stem().string();
  if (all.empty()) throw Error(folder.string() + ": no result files (.h5, .part) in it");
  if (found.empty()) throw Error(folder.string() + ": no run has \"" + wanted + "\" in its name; there are" + names);
  throw Error(folder.string() + ": " + std::to_string(all.size()) + " runs; choose one with --run TEXT:" + names);
}

}  // namespace

bool is_run(const fs::path& p) { return p.extension() == ".h5" || p.extension() == ".part"; }

Motion run_motion(const RunSpec& spec, const DeviceOptions& device) {
  SolverRun run(spec, device, "render");
  if (!run.alive())
    throw Error(spec.scene->source + ": " + spec.entry->info.name + ": " + run.outcome().status + ": " +
                run.outcome().message);
  TrialRules rules;
  rules.accuracy_duration_s = spec.scene->time.duration_s;
  AccuracyPass pass = run.run_accuracy(rules);
  return motion_of(*spec.scene, run.header(), run.outcome(), std::move(pass));
}

std::vector<Motion> motions_of(const std::string& file, const std::function<Motion(const std::string&)>& run,
                               const std::string& wanted) {
  std::vector<Motion> out;
  const fs::path path = file;
  if (fs::is_directory(path) && !is_run(path)) {
    for (const fs::path& p : runs_in(path, wanted)) out.push_back(stored_motion(p));
  } else if (is_run(path)) {
    out.push_back(stored_motion(path));
  } else {
    out.push_back(run(file));
  }
  for (const Motion& m : out)
    if (m.frames() == 0)
      throw Error(file + ": " + m.name + " has no trajectory" + (m.outcome.empty() ? "" : " (" + m.outcome + ")") +
                  "; a scenario can be run directly: clothbench render SCENE");
  return out;
}

}  // namespace clothbench::render
