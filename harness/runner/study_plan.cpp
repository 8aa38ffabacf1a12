#include "runner/study_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <set>
#include <sstream>

#include "base/child_process.hpp"
#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "results/store.hpp"
#include "runner/study_runner.hpp"

namespace clothbench {
namespace {

[[noreturn]] void refuse_name(const std::string& name) {
  std::vector<std::string> known = solver_names_of_tree();
  for (const SolverEntry* e : all_solvers()) known.push_back(e->info.name);
  throw Error("the study names a solver " + in_quotes(name) +
              ", which is neither a solver of clothbench nor a plugin in $" + kPluginsVariable +
              nearest_known(name, known));
}

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kWhatToDo = "results of both would be mixed; give another --out, or undo the change";

/// If the solver is known, both settings are completed first, because a crashed process stores them as given.
bool same_settings(const RunSpec& run, const json& stored) {
  if (!run.entry->make) {
    json both = stored;
    both.merge_patch(run.settings);
    return both == stored;
  }
  try {
    return complete_settings(run.entry->info, run.settings) == complete_settings(run.entry->info, stored);
  } catch (const Error&) {
    return false;  // a setting that this version of the solver lacks
  }
}

std::string short_hash(const std::string& sha256) {
  constexpr std::size_t kShown = 12;
  return sha256.empty() ? "none" : sha256.substr(0, kShown);
}

/// The file of a finished run, otherwise of an unfinished run, otherwise an empty path.
fs::path stored_run(const fs::path& folder, const std::string& run) {
  if (fs::path file = finished_file(folder, run); !file.empty()) return file;
  const fs::path part = folder / (run + ".part");
  return fs::exists(part) ? part : fs::path();
}

/// Header of a stored run, if any. Another process of a sharded study may finish the run and remove its part file.
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

const char* protocol_name(StudyLength length) { return length == StudyLength::Quick ? "quick" : "full"; }

const SolverEntry* known_solver(const std::string& name) {
  for (const SolverEntry& e : solvers())
    if (e.info.name == name) return &e;
  return external_solver(name);
}

std::map<std::string, std::vector<std::string>> knobs_of_plugins(const std::vector<std::string>& names) {
  std::map<std::string, std::vector<std::string>> out;
  for (const std::string& name : names)
    if (const SolverEntry* e = known_solver(name); e != nullptr && is_external(e->info))
      for (const SettingSpec& s : e->info.settings)
        if (s.name == "substeps" || s.name == "iterations") out[name].push_back(s.name);
  return out;
}

RunPlan plan_study(const Study& study, const std::function<const SolverEntry*(const std::string&)>& lookup) {
  const StudyRules& rules = study.rules;
  RunPlan plan;
  plan.protocol = protocol_name(study.length);
  plan.rules = {study.trials,   rules.frames,      rules.max_wall_s,          rules.min_frames,
                rules.warmup_s, study.drop_frames, study.accuracy_duration_s, study.run_limit_s,
                rules.agree,    study.pipelined};
  plan.references = study.protocol == "work-precision";
  if (plan.references) plan.rules.profiled_frames = 0;
  plan.apart = study.protocol == "stability-map" || (is_drawn(study) && rules.frames == 0);
  if (plan.apart) plan.rules.trials = 0;
  std::vector<const SolverEntry*> entries;
  for (const StudySolver& s : study.solvers) entries.push_back(s.joined ? &find_solver(s.solver) : lookup(s.solver));
  for (const Study::Item& item : study.scenes) {
    if (plan.groups.size() <= static_cast<std::size_t>(item.group))
      plan.groups.resize(static_cast<std::size_t>(item.group) + 1);
    for (const std::size_t k : item.solvers) {
      const StudySolver& s = study.solvers[k];
      if (entries[k] == nullptr) {
        if (!contains(solver_names_of_tree(), s.solver)) refuse_name(s.solver);
        entries[k] = plan.add_not_built(s.solver);
      }
      nlohmann::json settings = s.settings;
      settings.update(item.drawn_settings.value(s.solver, nlohmann::json::object()));
      if (entries[k]->make) settings = complete_settings(entries[k]->info, settings);
      plan.groups[static_cast<std::size_t>(item.group)].push_back({&item.scene, entries[k], settings, s.label, s.work});
    }
  }
  return plan;
}

void sustain(RunPlan& plan, double duration_s) {
  constexpr double kWindow_s = 10;
  TrialRules& r = plan.rules;
  r.trials = static_cast<int>(std::ceil(duration_s / kWindow_s));
  r.window_s = duration_s / r.trials;
  r.agree = 0;
  r.pipelined = false;
  r.profiled_frames = 0;
  std::vector<std::vector<RunSpec>> apart;
  for (const auto& group : plan.groups)
    for (const RunSpec& spec : group) apart.push_back({spec});
  plan.groups = std::move(apart);
}

std::vector<std::string> run_names(const RunPlan& plan) {
  std::vector<std::string> names;
  for (const auto& group : plan.groups)
    for (const RunSpec& c : group) names.push_back(run_name(c));
  return names;
}

std::vector<std::size_t> parse_runs(const std::string& text, const std::vector<std::string>& names) {
  const auto fail = [&] {
    throw Error(fmt::format("--job {}: expected names, or numbers from 0 to {} (0,3-5)", text, names.size() - 1));
  };
  const auto number = [&](const std::string& word) {
    std::size_t n = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), n);
    if (error != std::errc() || end != word.data() + word.size() || n >= names.size()) fail();
    return n;
  };
  std::set<std::size_t> chosen;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), part) - names.begin());
    const std::size_t dash = at < names.size() ? std::string::npos : part.find('-');
    const std::size_t first = at < names.size() ? at : number(part.substr(0, dash)),
                      last = dash == std::string::npos ? first : number(part.substr(dash + 1));
    if (last < first) fail();
    for (std::size_t k = first; k <= last; ++k) chosen.insert(k);
  }
  if (chosen.empty()) fail();
  return {chosen.begin(), chosen.end()};
}

RunPlan only_runs(RunPlan plan, const std::vector<std::size_t>& runs) {
  std::size_t at = 0;
  for (auto& group : plan.groups)
    std::erase_if(group, [&](const RunSpec&) { return !std::binary_search(runs.begin(), runs.end(), at++); });
  std::erase_if(plan.groups, [](const auto& group) { return group.empty(); });
  return plan;
}

Overrides split_overrides(const std::vector<std::string>& set) {
  const std::string prefix = "solver.";
  Overrides out;
  for (const std::string& item : set) {
    if (item.rfind(prefix, 0) != 0) {
      out.scene.push_back(item);
      continue;
    }
    const auto eq = item.find('=');
    if (eq == std::string::npos) throw Error("--set " + shortened(item, 200) + ": expected solver.<name>=<value>");
    const std::string key = item.substr(prefix.size(), eq - prefix.size()), text = item.substr(eq + 1);
    nlohmann::json value = json_or_discarded(text);
    if (value.is_discarded()) value = text;
    if (const std::string tuning = std::string(kTuning) + "."; key.starts_with(tuning))
      out.solver[kTuning].update({{key.substr(tuning.size()), value}});
    else
      out.solver[key] = value;
  }
  return out;
}

std::string Overrides::label() const {
  std::string text;
  nlohmann::json flat = solver;
  flat.erase(kTuning);
  if (solver.contains(kTuning)) flat.update(solver[kTuning]);
  for (const auto& [key, value] : flat.items())
    text += (text.empty() ? "" : ",") + key + "=" + (value.is_string() ? value.get<std::string>() : dump(value));
  return text.empty() ? "default" : text;
}

ChosenSolver chosen_solver(const std::string& name, const Overrides& overrides) {
  const SolverEntry& entry = find_solver(name);
  return {&entry, complete_settings(entry.info, overrides.solver), overrides.label()};
}

std::vector<const SolverEntry*> all_solvers() {
  std::vector<const SolverEntry*> out;
  for (const SolverEntry& e : solvers()) out.push_back(&e);
  const char* plugins = std::getenv(kPluginsVariable);  // --solver appends to it
  std::istringstream paths(plugins != nullptr ? plugins : "");
  for (std::string path; std::getline(paths, path, ':');)
    if (!path.empty()) out.push_back(&find_solver(kPluginPrefix + path));
  return out;
}

std::vector<std::string> solver_names(bool (*are)(const SolverInfo&)) {
  std::vector<std::string> names;
  for (const SolverEntry& e : solvers())
    if (are == nullptr || are(e.info)) names.push_back(e.info.name);
  return names;
}

void require_device(const RunPlan& plan, const DeviceOptions& chosen) {
  for (const auto& group : plan.groups)
    for (const RunSpec& c : group) {
      if (!c.entry->info.on_gpu || !c.entry->devices) continue;
      const std::size_t devices = c.entry->devices().size();
      if (devices == 0)
        throw Error("no Vulkan device is present; install a driver (Debian: mesa-vulkan-drivers)", ExitCode::NoDevice);
      if (chosen.index >= static_cast<int>(devices))
        throw Error(
            fmt::format("--device {}: expected a number below {}, the count of devices (see `clothbench list devices`)",
                        chosen.index, devices),
            ExitCode::NoDevice);
      return;
    }
}

void require_same_run(const fs::path& folder, const RunSpec& run, std::optional<double> window_s = {}) {
  fs::path file;
  const std::optional<RunHeader> h = stored_header(folder, run_name(run), file);
  if (!h) return;
  if (h->scenario_sha256 != run.scene->sha256)
    throw Error(fmt::format("{}: stored for another scene (SHA-256 of the resolved scene {}, now {}); {}",
                            file.string(), short_hash(h->scenario_sha256), short_hash(run.scene->sha256), kWhatToDo));
  if (!same_settings(run, h->settings))
    throw Error(fmt::format("{}: run with different settings ({}, now {}); {}", file.string(),
                            shortened(dump(h->settings), 200), shortened(dump(run.settings), 200), kWhatToDo));
  const nlohmann::json& e = h->environment;
  const std::string version = e.is_object() ? e.value("solver_version", "") : "";
  if (const double stored_s = e.is_object() ? e.value("window_s", 0.0) : 0;
      window_s && !version.empty() && stored_s != *window_s)
    throw Error(fmt::format("{}: run with windows of {:g} s (0: trials), now {:g} s; {}", file.string(), stored_s,
                            *window_s, kWhatToDo));
  const SolverInfo& solver = run.entry->info;
  if (run.entry->make && !version.empty() && version != solver.version)  // a crash before the start stores no version
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
      require_same_run(folder, run, plan.rules.window_s);
    }
}

}  // namespace clothbench
