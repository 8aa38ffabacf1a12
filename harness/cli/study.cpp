#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "cli/command.hpp"
#include "cli/run_common.hpp"
#include "cli/study_plan.hpp"

namespace clothbench {
namespace {

struct Arguments {
  std::string study;
  std::vector<std::string> set, only;
  int trials = 0;
  bool full = false, quick = false;
  RunFlags run;
};

}  // namespace

namespace {

/// The study's solvers, or those of them that `only` names; one that the study does not know joins with its defaults.
std::vector<StudySolver> chosen(const Study& study, const std::vector<std::string>& only) {
  if (only.empty()) return study.solvers;
  std::vector<StudySolver> out;
  for (const StudySolver& s : study.solvers)
    if (std::find(only.begin(), only.end(), s.solver) != only.end()) out.push_back(s);
  for (const std::string& name : std::set<std::string>(only.begin(), only.end()))
    if (std::none_of(out.begin(), out.end(), [&](const StudySolver& s) { return s.solver == name; }))
      out.push_back({name, "default", nlohmann::json::object()});
  return out;
}

}  // namespace

CellPlan plan_study(const Study& study, bool full, const std::vector<std::string>& only) {
  const StudyRules& rules = full ? study.full_rules : study.short_rules;
  CellPlan plan;
  plan.protocol = full ? "full" : "short";
  plan.rules = {study.trials, rules.frames, rules.max_wall_s, rules.min_frames, rules.warmup_s, study.drop_frames, study.accuracy_duration_s};
  for (const std::string& name : only) find_solver(name);
  const std::vector<StudySolver> solvers = chosen(study, only);
  for (const Study::Item& item : study.scenes) {
    if (plan.groups.size() <= static_cast<std::size_t>(item.group)) plan.groups.resize(static_cast<std::size_t>(item.group) + 1);
    for (const StudySolver& s : solvers) {
      const SolverEntry& entry = find_solver(s.solver);
      plan.groups[static_cast<std::size_t>(item.group)].push_back({&item.scene, &entry, complete_settings(entry.info, s.settings), s.label});
    }
  }
  return plan;
}

void add_study(CLI::App& app, Console& console) {
  static Arguments a;
  CLI::App* cmd = app.add_subcommand("study", "Run every cell of a study");
  cmd->add_option("study", a.study, "Study file or name, such as table3")->required();
  cmd->add_flag("--quick,--short", a.quick, "The short protocol (the default): sized for a software device on 2 cores");
  cmd->add_flag("--full", a.full, "The long protocol")->excludes("--quick");
  cmd->add_option("--trials", a.trials, "Trials a cell, instead of the study's")->check(CLI::Range(1, 1000));
  cmd->add_option("--solver", a.only, "Only these solvers; one that the study does not name runs with its default settings");
  cmd->add_option("--set", a.set, "Override a scene key in every cell: cloth.size_m=[0.5,0.5]");
  cmd->add_option("--out", a.run.out, "Folder for the result files; default results/runs/<study>-<UTC>");
  cmd->add_flag("--resume", a.run.resume, "Go on with the folder of an interrupted study");
  a.run.device.add_to(*cmd);
  cmd->footer("Example: clothbench study table3 --out results/runs/mine");
  cmd->callback([&console] {
    const Overrides overrides = split_overrides(a.set);
    if (!overrides.solver.empty()) throw Error("--set solver.…: a study's solver settings stand in its file");
    if (a.run.resume && a.run.out.empty()) throw Error("--resume: say which folder with --out");
    const Study study = load_study(a.study, overrides.scene);
    CellPlan plan = plan_study(study, a.full, a.only);
    if (a.trials > 0) plan.rules.trials = a.trials;
    StudyManifest manifest;
    manifest.study = study.name;
    manifest.definition = study.definition;
    run_and_tell(std::move(plan), std::move(manifest), a.run, console);
  });
}

}  // namespace clothbench
