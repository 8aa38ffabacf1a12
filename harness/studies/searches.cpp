#include "studies/searches.hpp"

#include <fmt/format.h>

#include "results/result_folder.hpp"
#include "runner/effective_moduli.hpp"
#include "runner/friction.hpp"
#include "runner/metamorphic.hpp"

namespace clothbench {
namespace {

bool stretches(const SolverInfo& s) { return !s.ignores.has(Feature::Stretch); }
bool touches(const SolverInfo& s) { return !(s.supports & kColliderFeatures).empty(); }

/// One study while it runs.
struct Search {
  const SearchCall& call;
  const Overrides overrides = split_overrides(call.set);
  const std::vector<std::string> solvers;
  Guard guard{call.words};
  std::optional<ResultFolder> held = {};
  StudyRuns runs;
  std::vector<RunRecord> found = {};

  Search(const std::string& study, const SearchCall& c, std::vector<std::string> by_default)
      : call(c), solvers(c.solvers.empty() ? std::move(by_default) : c.solvers), runs(stored(study)) {}

  StudyRuns stored(const std::string& study) {
    if (call.out.empty()) return StudyRuns(call.device.options);
    if (!Guard::in_child()) held.emplace(call.out, ResultFolder::Use::Alone, call.command_line);
    const nlohmann::json definition = {{"name", study}, {"solvers", solvers}, {"set", call.set}};
    return {call.device.options, call.out, call.resume, {study, "", call.command_line, definition, {}}};
  }
  void add(std::vector<RunRecord> some) {
    for (RunRecord& c : some) found.push_back(std::move(c));
  }
  Searched end() { return {std::move(found), guard.crashed()}; }
};

/// The settings given, and those with each number of substeps where the solver has that setting.
std::vector<Overrides> at_substeps(const SolverInfo& solver, const Overrides& given, const std::vector<int>& substeps) {
  std::vector<Overrides> out = {given};
  if (!complete_settings(solver, nlohmann::json::object()).contains("substeps")) return out;
  for (const int n : substeps) {
    out.push_back(given);
    out.back().solver["substeps"] = n;
  }
  return out;
}

}  // namespace

Searched search_moduli(const SearchCall& call, bool sweep) {
  refuse_scene(call.set, "expected solver.<name>=<value>; the patches are fixed");
  Search search("moduli", call, solver_names(stretches));
  const auto one = [&](const SolverEntry& entry, const nlohmann::json& settings, const std::string& label, bool full) {
    call.progress(entry.info.name + " " + label, search.found.size());
    try {
      search.add({ask_material(search.guard, search.runs, entry, settings, label, full)});
    } catch (const Error& e) {
      if (e.code() != ExitCode::NoDevice || !call.device.allow_no_device) throw;
      if (full) fmt::print(stderr, "no Vulkan device is present: {} is left out\n", entry.info.name);
    }
  };
  for (const std::string& name : search.solvers) {
    const ChosenSolver s = chosen_solver(name, search.overrides);
    one(*s.entry, s.settings, s.setting, true);
    // Whatever came of it: a plugin's child asks the same questions without knowing the answers.
    if (!sweep || !stretches(s.entry->info)) continue;
    for (const auto& [label, settings] : swept_settings(s.entry->info, s.settings))
      one(*s.entry, settings, label, false);
  }
  return search.end();
}

Searched search_friction(const SearchCall& call, const std::vector<int>& substeps) {
  Search search("friction", call, solver_names(touches));
  for (const std::string& name : search.solvers)
    for (const Overrides& given : at_substeps(find_solver(name).info, search.overrides, substeps)) {
      const ChosenSolver s = chosen_solver(name, given);
      search.add(friction_runs(
          search.guard, search.runs, *s.entry, s.settings, s.setting, given.scene,
          [&](const std::string& scene) { call.progress(fmt::format("{} {}: {}", name, s.setting, scene), 0); }));
    }
  return search.end();
}

Searched search_thresholds(const SearchCall& call, const std::vector<std::string>& scenes) {
  Search search("threshold", call, {"xpbd"});
  for (const std::string& file : scenes)
    for (const std::string& name : search.solvers) {
      const ChosenSolver s = chosen_solver(name, search.overrides);
      call.progress(name + ": " + file, search.found.size());
      search.add(threshold_runs(search.guard, search.runs, load_scene(file, search.overrides.scene), *s.entry,
                                s.settings, s.setting));
    }
  return search.end();
}

Searched search_metamorphic(const SearchCall& call) {
  refuse_scene(call.set, "the scenes are fixed; expected solver.<name>=<value>");
  Search search("metamorphic", call, solver_names());
  const std::vector<Scene> scenes = metamorphic_scenes();
  for (const std::string& name : search.solvers) {
    const ChosenSolver s = chosen_solver(name, search.overrides);
    for (const Scene& scene : scenes)
      search.add(metamorphic_runs(search.guard, search.runs, *s.entry, s.settings, s.setting, scene,
                                  [&](const std::string& what) { call.progress(what, search.found.size()); }));
  }
  return search.end();
}

}  // namespace clothbench
