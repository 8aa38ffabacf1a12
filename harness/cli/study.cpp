#include <algorithm>
#include <set>

#include "cli/command.hpp"
#include "runner/study_plan.hpp"
#ifdef CLOTHBENCH_WITH_DRAW
#include "render/offscreen.hpp"
#endif

namespace clothbench {
Rendering rendering_of([[maybe_unused]] const std::string& eye) {
#ifdef CLOTHBENCH_WITH_DRAW
  const auto [width, height] = pixels_of("--eye", eye);
  return render::stereo_rendering(width, height);
#else
  return {};
#endif
}

namespace {

struct StudyArguments {
  std::string study;
  std::vector<std::string> set, only;
  int trials = 0, jobs = 0, count = 0;
  std::optional<std::uint64_t> seed;
  std::string eye = "2064x2208", chosen;
  bool with_rendering = false, list_jobs = false;
  SustainedFlag sustained;
  bool quick = false, require_assets = false, procedural = false;
  RunFlags run;
};

void print_jobs(const std::vector<std::string>& names, const Console& console) {
  if (console.json) return Console::print(names);
  for (std::size_t k = 0; k < names.size(); ++k) fmt::print("{}\t{}\n", k, names[k]);
}

/// Prints one line per generated scene; nothing if there are many, because the result files contain them.
void print_drawn(const Study& study) {
  constexpr std::size_t kFew = 24;
  std::set<std::string> names;
  for (const Study::Item& item : study.scenes) names.insert(item.scene.name);
  if (names.size() > kFew) return;
  for (const Study::Item& item : study.scenes) {
    if (names.erase(item.scene.name) == 0) continue;
    const nlohmann::json drawn = json_from(item.scene.json)["drawn"];
    std::string text = fmt::format("{}: speed {:.3g} m/s;", item.scene.name, drawn["speed_m_per_s"].get<double>());
    std::set<std::string> run;
    for (const std::size_t k : item.solvers) run.insert(study.solvers[k].solver);
    for (const auto& [name, value] : drawn["values"].items())
      if (const std::string of = name.substr(0, name.find('.')); run.contains(of) || !item.drawn_settings.contains(of))
        text += fmt::format(" {}={}", name, value.is_string() ? value.get<std::string>() : dump(value));
    fmt::print("{}\n", text);
  }
}

/// Refuses options that the study's protocol does not have.
void check_options(const Study& study, bool has_trials, const StudyArguments& a) {
  if (!has_trials) {
    const std::string of = ": study " + study.name + " has no timed trials";
    if (a.with_rendering) throw Error("--with-rendering" + of);
    if (a.trials > 0) throw Error("--trials" + of);
    if (!a.sustained.seconds.empty()) throw Error("--sustained" + of);
  }
  if (!a.sustained.seconds.empty() && (a.with_rendering || a.trials > 0))
    throw Error("--sustained excludes --with-rendering and --trials; leave one out");
  if (is_drawn(study)) return;
  if (a.count > 0 || a.seed)
    throw Error(
        "--seed, --count: the scenes of this study are given in its file; only contact, physics and reproduction "
        "generate scenes");
  if (a.procedural)
    throw Error("--procedural: this study has no random contact scenes; set CLOTHBENCH_ASSETS=procedural instead");
}

void run_study(StudyArguments& a, Console& console) {
  const Overrides overrides = split_overrides(a.set);
  if (!overrides.solver.empty())
    throw Error("--set solver.…: a study takes solver settings from its file; copy the file and change its settings");
  if (a.run.resume && a.run.out.empty()) throw Error("--resume needs --out DIR, the folder of the interrupted study");
  const StudyLength length = a.quick ? StudyLength::Quick : StudyLength::Full;
  if (a.procedural && a.require_assets)
    throw Error("--procedural and --require-assets exclude each other; leave one out");
  if (a.procedural) setenv("CLOTHBENCH_ASSETS", "procedural", 1);  // for worker processes too
  // Random scenes need scanned assets unless --procedural is given.
  const Assets assets = asset_policy(a.require_assets || (!a.procedural && is_study_of(a.study, "contact")));
  Study study =
      load_study(a.study, {overrides.scene, length, assets, a.only, knobs_of_plugins(a.only), a.seed, a.count});
  const bool drawn = is_drawn(study);
  RunPlan plan = plan_study(study);
  check_options(study, !plan.apart, a);
  if (a.with_rendering) study.definition["rendering"] = {{"eyes", 2}, {"pixels", a.eye}};
  if (a.trials > 0) plan.rules.trials = a.trials;
  if (a.with_rendering) plan.rules.rendering = rendering_of(a.eye);
  a.sustained.apply_to(plan);
  const std::vector<std::string> names = run_names(plan);
  if (a.list_jobs) return print_jobs(names, console);
  StudyManifest manifest;
  manifest.study = study.name;
  manifest.definition = study.definition;
  if (!a.chosen.empty()) {
    if (a.run.out.empty()) throw Error("--job needs --out DIR, the folder that collects all runs of this study");
    const std::vector<std::size_t> chosen = parse_runs(a.chosen, names);
    require_same_runs(a.run.out, plan, true);  // checks runs of other processes, too
    plan = only_runs(std::move(plan), chosen);
    manifest.runs = names;
    a.run.resume = a.run.part = true;
  }
  a.run.jobs = std::max(1, a.jobs);
  if (a.with_rendering) a.run.eye = a.eye;
  execute_study(std::move(plan), manifest, a.run, console, [&] {
    if (drawn && !console.json) print_drawn(study);
  });
}

}  // namespace

void add_study(CLI::App& app, Console& console) {
  StudyArguments& a = console.arguments<StudyArguments>();
  CLI::App* cmd = app.add_subcommand("study", "Execute every run of a study");
  cmd->add_option("study", a.study, "Study file or name, such as table3")->required();
  cmd->add_flag("--quick", a.quick,
                "The study's quick form, with fewer scenes and solvers: for a software device on 2 cores");
  cmd->add_option("--trials", a.trials, "Number of trials per run, instead of the study's")->check(CLI::Range(1, 1000));
  a.sustained.add_to(*cmd);
  add_solvers(*cmd, "--solver", a.only,
              "Only these solvers. One that the study does not name is added with its default settings; a plugin with "
              "settings substeps or iterations takes part in settings sweeps");
  cmd->add_option("--set", a.set, "Override a scene key (no solver setting) in every run: cloth.size_m=[0.5,0.5]");
  cmd->add_option("--out", a.run.out, "Folder for the result files; default results/runs/<study>-<UTC>");
  cmd->add_flag("--resume", a.run.resume, "Continue the interrupted study in the folder of --out");
  cmd->add_option(
      "--seed", a.seed,
      "In studies of generated scenes (contact, physics, reproduction): seed of the first scene (default 1)");
  cmd->add_option("--count", a.count,
                  "Number of scenes to generate in these studies, from seed --seed on; default: the study's count")
      ->check(CLI::Range(1, 100000));
  cmd->add_flag("--procedural", a.procedural,
                "Generate contact scenes from procedural rooms and hands, which need no download; tables state this");
  cmd->add_flag("--list-jobs", a.list_jobs, "Print the numbers and names of the jobs (runs); execute none");
  cmd->add_option("--job", a.chosen,
                  "Only these jobs, by number or name: 7, or 0,3-5. Their results are added to the folder of --out "
                  "(scripts/slurm_study.sh spreads a study over a cluster in this way)");
  cmd->add_option("--jobs", a.jobs,
                  "Number of concurrent processes for untimed work (default 1); timed trials follow one at a time")
      ->check(CLI::Range(1, 256));
#ifdef CLOTHBENCH_WITH_DRAW
  CLI::Option* rendering =
      cmd->add_flag("--with-rendering", a.with_rendering,
                    "Also time frames with rendering, one image for each eye of a headset (frame_rendered_s)");
  cmd->add_option("--eye", a.eye, "Size of each image: WIDTHxHEIGHT in pixels")
      ->capture_default_str()
      ->needs(rendering);
#endif
  add_require_assets(*cmd, a.require_assets);
  a.run.device.add_to(*cmd);
  cmd->footer("Example: clothbench study table3 --out results/runs/mine");
  cmd->callback([&console, &a] { run_study(a, console); });
}

}  // namespace clothbench
