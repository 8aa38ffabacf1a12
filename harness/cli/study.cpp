#include <fmt/format.h>

#include <algorithm>

#include "cli/command.hpp"
#include "cli/run_common.hpp"
#include "runner/run_choice.hpp"
#include "runner/study_plan.hpp"
#ifdef CLOTHBENCH_WITH_DRAW
#include "render/stereo.hpp"
#endif

namespace clothbench {
namespace {

struct StudyArguments {
  std::string study;
  std::vector<std::string> set, only;
  int trials = 0, jobs = 0;
  std::optional<std::uint64_t> seed;
  std::string eye = "2064x2208", runs;
  bool with_rendering = false, list_runs = false;
  bool full = false, short_trials = false, quick = false, require_assets = false, no_moduli = false;
  RunFlags run;
};

/// A plugin climbs a study's ladder by the knobs that it has in common with the solvers here.
std::map<std::string, std::vector<std::string>> knobs_of_plugins(const std::vector<std::string>& names) {
  std::map<std::string, std::vector<std::string>> out;
  for (const std::string& name : names)
    if (const SolverEntry* e = known_solver(name); e != nullptr && is_external(e->info))
      for (const SettingSpec& s : e->info.settings)
        if (s.name == "substeps" || s.name == "iterations") out[name].push_back(s.name);
  return out;
}

void print_runs(const std::vector<std::string>& names, const Console& console) {
  if (console.json) return fmt::print("{}\n", nlohmann::json(names).dump(2));
  for (std::size_t k = 0; k < names.size(); ++k) fmt::print("{}\t{}\n", k, names[k]);
}

Rendering rendering_of([[maybe_unused]] const std::string& eye) {
#ifdef CLOTHBENCH_WITH_DRAW
  const auto [width, height] = pixels_of("--eye", eye);
  return render::stereo_rendering(width, height);
#else
  return {};
#endif
}

/// Protocol stability-map, which judges one untimed run of every run.
void run_maps(Study study, const StudyArguments& a, Console& console) {
  if (a.with_rendering) throw Error("--with-rendering: studies of protocol stability-map have no timed trials");
  if (a.trials > 0) throw Error("--trials: studies of protocol stability-map have no timed trials");
  if (a.list_runs || !a.runs.empty())
    throw Error(
        "--list-runs, --run: not for protocol stability-map, whose next run depends on the last; --jobs uses all "
        "cores of a machine");
  run_stability_and_tell(study, {study.name, "", "", study.definition, {}}, a.run, a.only, std::max(1, a.jobs),
                         console);
}

void run_study(StudyArguments& a, Console& console) {
  const Overrides overrides = split_overrides(a.set);
  if (!overrides.solver.empty()) throw Error("--set solver.…: the solver settings of a study are set in its file");
  if (a.run.resume && a.run.out.empty()) throw Error("--resume: say which folder with --out");
  const StudyLength length = a.full ? StudyLength::Full : a.quick ? StudyLength::Quick : StudyLength::Short;
  Study study =
      load_study(a.study, {overrides.scene, length, asset_policy(a.require_assets), a.only, knobs_of_plugins(a.only)});
  for (Study::Item& item : study.scenes) item.scene = at_seed(std::move(item.scene), a.seed, console);
  if (a.seed) study.definition["seed"] = *a.seed;
  if (a.with_rendering) study.definition["rendering"] = {{"eyes", 2}, {"pixels", a.eye}};
  if (study.protocol == "stability-map") return run_maps(std::move(study), a, console);
  if (a.jobs > 0) throw Error("--jobs: only for studies of protocol stability-map, which have no timed trials");
  RunPlan plan = plan_study(study);
  if (a.trials > 0) plan.rules.trials = a.trials;
  if (a.no_moduli) plan.measure_moduli = false;
  if (a.with_rendering) plan.rules.rendering = rendering_of(a.eye);
  const std::vector<std::string> names = run_names(plan);
  if (a.list_runs) return print_runs(names, console);
  StudyManifest manifest;
  manifest.study = study.name;
  manifest.definition = study.definition;
  if (!a.runs.empty()) {
    if (a.run.out.empty()) throw Error("--run: expected --out with the folder that all runs of the study share");
    const std::vector<std::size_t> chosen = parse_runs(a.runs, names.size());
    require_same_runs(a.run.out, plan, true);  // also what other processes have made of it
    plan = only_runs(std::move(plan), chosen);
    manifest.runs = names;
    plan.measure_moduli = false;  // of fronts, which need all runs
    a.run.resume = a.run.part = true;
  }
  run_and_tell(std::move(plan), std::move(manifest), a.run, console);
}

}  // namespace

void add_study(CLI::App& app, Console& console) {
  StudyArguments& a = console.arguments<StudyArguments>();
  CLI::App* cmd = app.add_subcommand("study", "Execute every run of a study");
  cmd->add_option("study", a.study, "Study file or name, such as table3")->required();
  CLI::Option* quick = cmd->add_flag("--quick", a.quick,
                                     "Fewer scenes and solvers, as the study says: for a software device on 2 cores");
  CLI::Option* brief =
      cmd->add_flag("--short", a.short_trials, "Every run with short trials (the default)")->excludes(quick);
  cmd->add_flag("--full", a.full, "Every run with long trials")->excludes(quick)->excludes(brief);
  cmd->add_option("--trials", a.trials, "Trials a run, instead of the study's")->check(CLI::Range(1, 1000));
  add_solvers(*cmd, "--solver", a.only,
              "Only these solvers; one that the study does not name joins with its default settings");
  cmd->add_option("--set", a.set, "Override a scene key in every run: cloth.size_m=[0.5,0.5]");
  cmd->add_option("--out", a.run.out, "Folder for the result files; default results/runs/<study>-<UTC>");
  cmd->add_flag("--resume", a.run.resume, "Go on with the folder of an interrupted study");
  add_seed(*cmd, a.seed);
  cmd->add_flag("--list-runs", a.list_runs, "Print the runs' numbers and names and execute none");
  cmd->add_option(
      "--run", a.runs,
      "Only these runs, by number: 7, or 0,3-5. They join what is in --out (scripts/slurm_study.sh spreads a study "
      "over a cluster so)");
  cmd->add_flag("--no-moduli", a.no_moduli,
                "No effective moduli after a work-precision study (then no solver is left unranked for its stiffness)");
  cmd->add_option("--jobs", a.jobs,
                  "Processes at a time, of a study that gives each run a process of its own (default 1)")
      ->check(CLI::Range(1, 256));
#ifdef CLOTHBENCH_WITH_DRAW
  CLI::Option* rendering =
      cmd->add_flag("--with-rendering", a.with_rendering,
                    "Also time frames with their pictures, one for each eye of a headset (frame_rendered_s)");
  cmd->add_option("--eye", a.eye, "WIDTHxHEIGHT of each picture in pixels")->capture_default_str()->needs(rendering);
#endif
  add_require_assets(*cmd, a.require_assets);
  a.run.device.add_to(*cmd);
  cmd->footer("Example: clothbench study table3 --out results/runs/mine");
  cmd->callback([&console, &a] { run_study(a, console); });
}

}  // namespace clothbench
