#include "runner/study_plan.hpp"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <sstream>

#include "base/plugin_environment.hpp"
#include "clothbench/error.hpp"
#include "clothbench/solver_names.hpp"

namespace clothbench {
namespace {

[[noreturn]] void refuse_name(const std::string& name) {
  std::vector<std::string> known = solver_names_of_tree();
  for (const SolverEntry& e : solvers()) known.push_back(e.info.name);
  const char* plugins = std::getenv(kPluginsVariable);
  std::istringstream paths(plugins != nullptr ? plugins : "");
  for (std::string path; std::getline(paths, path, ':');)
    if (const SolverEntry* e = path.empty() ? nullptr : external_solver(kPluginPrefix + path))
      known.push_back(e->info.name);
  const std::string near = nearest(name, known);
  throw Error("the study names a solver \"" + name + "\", which is neither of clothbench nor a plugin in $" +
              kPluginsVariable + (near.empty() ? "" : "; nearest known: " + near));
}

}  // namespace

const char* protocol_name(StudyLength length) {
  return length == StudyLength::Full ? "full" : length == StudyLength::Quick ? "quick" : "short";
}

const SolverEntry* known_solver(const std::string& name) {
  for (const SolverEntry& e : solvers())
    if (e.info.name == name) return &e;
  return external_solver(name);
}

RunPlan plan_study(const Study& study) {
  const StudyRules& rules = study.rules;
  RunPlan plan;
  plan.protocol = protocol_name(study.length);
  plan.rules = {study.trials,
                rules.frames,
                rules.max_wall_s,
                rules.min_frames,
                rules.warmup_s,
                study.drop_frames,
                study.accuracy_duration_s,
                study.run_limit_s,
                rules.ladder_limit_s,
                rules.agree,
                study.pipelined};
  if (!study.stage_times) plan.rules.profiled_frames = 0;
  plan.references = plan.measure_moduli = study.protocol == "work-precision";
  std::vector<const SolverEntry*> entries;
  for (const StudySolver& s : study.solvers)
    entries.push_back(s.joined ? &find_solver(s.solver) : known_solver(s.solver));
  for (const Study::Item& item : study.scenes) {
    if (plan.groups.size() <= static_cast<std::size_t>(item.group))
      plan.groups.resize(static_cast<std::size_t>(item.group) + 1);
    for (const std::size_t k : item.solvers) {
      const StudySolver& s = study.solvers[k];
      if (entries[k] == nullptr) {
        const std::vector<std::string>& names = solver_names_of_tree();
        if (std::find(names.begin(), names.end(), s.solver) == names.end()) refuse_name(s.solver);
        auto absent = std::make_shared<SolverEntry>();
        absent->info.name = s.solver;
        entries[k] = absent.get();
        plan.not_built.push_back(std::move(absent));
      }
      const nlohmann::json settings = entries[k]->make ? complete_settings(entries[k]->info, s.settings) : s.settings;
      plan.groups[static_cast<std::size_t>(item.group)].push_back({&item.scene, entries[k], settings, s.label, s.work});
      plan.groups[static_cast<std::size_t>(item.group)].back().timed = item.timed && s.timed;
    }
  }
  return plan;
}

}  // namespace clothbench
