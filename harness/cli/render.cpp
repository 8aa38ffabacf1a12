#include <unistd.h>

#include <algorithm>
#include <tuple>

#include "cli/command.hpp"
#include "render/pictures.hpp"
#include "runner/interrupt.hpp"
#include "runner/worker.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

struct RenderArguments {
  std::vector<std::string> files, views, set;
  std::string out, frames, size, run, solver;
  bool no_movie = false;
  DeviceFlags device;
};

/// Runs a scenario only for its positions.
auto run_of(const RenderArguments& a, const Console& console) {
  return [&](const std::string& file) {
    const Overrides overrides = split_overrides(a.set);
    const Scene scene = load_scene(file, overrides.scene);
    const auto [entry, settings, setting] = chosen_solver(a.solver, overrides);
    if (!console.json)
      fmt::print("{}: this is a scenario, not a result file, so {} runs it now ({:g} s of simulated time)\n", file,
                 a.solver, scene.time.duration_s);
    return render::run_motion({&scene, entry, settings, setting}, a.device.options);
  };
}

void render_all(const RenderArguments& a, const Console& console) {
  render::Shots shots;
  if (!a.views.empty()) shots.views.clear();
  for (const std::string& v : a.views) shots.views.push_back(render::view_from(v));
  std::tie(shots.width, shots.height) = pixels_of("--size", a.size);
  shots.movie = !a.no_movie;
  shots.out = a.out;
  nlohmann::json reported = {{"pictures", nlohmann::json::array()}, {"movies", nlohmann::json::array()}};
  for (const std::string& file : a.files)
    for (const render::Motion& m : render::motions_of(file, run_of(a, console), a.run)) {
      shots.frames = render::frames_from(a.frames, m.frames());
      render::Taken taken;
      {
        StatusLine line(!console.json);
        taken =
            render::take(m, shots, a.device.options, [&](const std::string& what, std::size_t done, std::size_t of) {
              if (interrupt_requested())
                throw Error("interrupted; the pictures drawn so far are kept", ExitCode::Interrupted);
              line.show(what, done, of);
            });
      }
      for (const fs::path& p : taken.pictures) reported["pictures"].push_back(p.string());
      for (const fs::path& p : taken.movies) reported["movies"].push_back(p.string());
      if (!taken.no_movie.empty()) reported["no_movie"] = taken.no_movie;
      if (!console.json) fmt::print("{}", render::taken_text(taken));
    }
  if (console.json) Console::print(reported);
}

/// A plugin runs the scenarios in a worker process, which stores their motions.
void render_plugin(RenderArguments a, const SolverEntry& solver, const Console& console) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("clothbench-render-{}", getpid());
  const Overrides overrides = split_overrides(a.set);
  const auto [entry, settings, setting] = chosen_solver(a.solver, overrides);
  RunPlan plan;
  plan.protocol = "render";
  plan.rules.trials = 0;
  RunOptions options;
  options.device = a.device.options;
  Worker worker;
  for (std::string& file : a.files) {
    if (fs::is_directory(file) || render::is_run(file)) continue;
    const Scene scene = load_scene(file, overrides.scene);
    const RunSpec spec{&scene, entry, settings, setting};
    plan.rules.accuracy_duration_s = scene.time.duration_s;
    options.out = folder / std::to_string(&file - a.files.data());
    const RunRecord r = run_apart(worker, plan, spec, options);
    if (r.outcome.status == "crashed" || r.outcome.status == "timed_out" || r.outcome.status == "error")
      throw Error(solver.info.folder + ": " + r.outcome.message, ExitCode::CheckFailed);
    file = finished_file(options.out, run_name(spec)).string();
  }
  render_all(a, console);
  std::error_code ignored;
  fs::remove_all(folder, ignored);
}

}  // namespace

void add_render(CLI::App& app, Console& console) {
  RenderArguments& a = console.arguments<RenderArguments>();
  a.out = "pictures";
  a.frames = ":";
  a.size = "1200x900";
  a.solver = "xpbd";
  CLI::App* cmd =
      app.add_subcommand("render", "Draw images (PNG) and a movie (MP4, if ffmpeg is present) of stored motions");
  cmd->add_option("file", a.files, "Result files (.h5), study folders, or scenarios, which are run first")->required();
  cmd->add_option("-o,--out", a.out, "Folder to write to")->capture_default_str();
  cmd->add_option("--frames", a.frames,
                  "FRAME, FIRST:LAST or FIRST:LAST:STEP, both included; -1 is the last. Default: all");
  cmd->add_option("--view", a.views, "front, top or corner (default); more than one may be given");
  cmd->add_option("--size", a.size, "Size of an image: WIDTHxHEIGHT in pixels")->capture_default_str();
  cmd->add_option("--run", a.run, "For a folder: draw the runs with this text in their names");
  cmd->add_flag("--no-movie", a.no_movie, "Images only, no movie");
  cmd->add_option("--solver", a.solver, "Solver that runs a scenario")->capture_default_str();
  cmd->add_option("--set", a.set, "For a scenario: override, as with `clothbench run`");
  a.device.add_to(*cmd);
  cmd->footer(
      "Examples: clothbench render results/runs/mine --run desk-flat-low__xpbd --view top --frames -1\n"
      "          clothbench render paper/hand-push --frames 0:-1:4 -o push");
  cmd->callback([&console, &a] {
    const bool runs = std::any_of(a.files.begin(), a.files.end(),
                                  [](const fs::path& f) { return !fs::is_directory(f) && !render::is_run(f); });
    const SolverEntry* solver = runs ? &find_solver(a.solver) : nullptr;
    if (solver == nullptr || !is_external(solver->info)) return render_all(a, console);
    render_plugin(a, *solver, console);
  });
}

}  // namespace clothbench
