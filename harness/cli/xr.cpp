#include "cli/command.hpp"
#include "runner/interrupt.hpp"
#include "xr/loop.hpp"

namespace clothbench {
namespace {

struct XrArguments {
  xr::LoopOptions loop;
  std::string solver = "xpbd", out;
  std::vector<std::string> set;
  DeviceFlags device;
};

/// File, scenario, outcome and summary of a session as JSON.
nlohmann::json loop_json(const xr::LoopResult& r) {
  return {{"file", r.file.string()},
          {"scenario", r.scenario.string()},
          {"status", r.outcome.status},
          {"message", r.outcome.message},
          {"summary", r.summary}};
}

std::string loop_text(const xr::LoopResult& r) {
  const auto of = [&](const char* name) { return r.summary.contains(name) ? r.summary.at(name) : kMissing; };
  return fmt::format("{:.0f} frames: {}\n", of("xr_frames"), r.outcome.status) +
         fmt::format("frames per second  median {:.1f}   slowest {:.1f}\n", of("xr_fps_median"), of("xr_fps_worst")) +
         fmt::format("late frames        {:.1f} %\n", 100 * of("xr_late_frames")) +
         fmt::format("step               median {:.3f} ms\n", 1e3 * of("frame_wall_median_s")) +
         fmt::format("both eye views     median {:.3f} ms on the device\n", 1e3 * of("xr_paint_device_median_s")) +
         fmt::format("results in {}; the session replays with: clothbench run {}\n", r.file.string(),
                     r.scenario.string());
}

}  // namespace

void add_xr(CLI::App& app, Console& console) {
  XrArguments& a = console.arguments<XrArguments>();
  xr::LoopOptions& o = a.loop;
  CLI::App* cmd = app.add_subcommand(
      "xr", "Run a live session in a headset (OpenXR): the cloth is drawn and touches the user's hands");
  cmd->add_option("scene", o.scenario, "Scene file or name; the user's hands replace the hands of the scene")
      ->required();
  cmd->add_option("--solver", a.solver, "Solver")->capture_default_str();
  cmd->add_option("--set", a.set, "Override: cloth.grid=[64,64], solver.substeps=20");
  cmd->add_option("--frames", o.frames,
                  fmt::format("Frames; default: the length of the scene, at most {}", xr::kMostFrames))
      ->check(CLI::Range(1, xr::kMostFrames));
  cmd->add_option("--rate", o.rate_hz, "Requested refresh rate of the display [Hz]")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  cmd->add_option("--timeout", o.timeout_s, "The session ends after this time without tracked hands [s]")
      ->check(CLI::Range(0.001, 86400.0))
      ->capture_default_str();
  cmd->add_flag("--table", o.table, "Put the cloth over the user's table, instead of the scene's static colliders");
  cmd->add_option("--out", a.out, "Folder for the result file and the recorded scene; default results/runs/xr-<UTC>");
  a.device.add_to(*cmd);
  cmd->footer("Example: clothbench xr paper/capsule-sweep --frames 720");
  cmd->callback([&console, &a, &o] {
    const Overrides overrides = split_overrides(a.set);
    o.overrides = overrides.scene;
    o.entry = &find_solver(a.solver);
    o.settings = complete_settings(o.entry->info, overrides.solver);
    o.setting = overrides.label();
    o.device = a.device.options;
    o.out = a.out.empty() ? default_folder("xr") : std::filesystem::path(a.out);
    if (!console.json) o.tell = [](const std::string& text) { fmt::print("{}\n", text); };
    const xr::LoopResult r = xr::run_loop(o);
    console.print([&] { return loop_json(r); }, [&] { return loop_text(r); });
    if (r.outcome.status != "ok" || r.validation_messages > 0) console.exit_code = ExitCode::CheckFailed;
    if (interrupt_requested()) console.exit_code = ExitCode::Interrupted;
    if (r.outcome.status != "ok")
      fmt::print(stderr, "FAULT {} in frame {}: {}\n", r.outcome.status, r.outcome.failed_frame, r.outcome.message);
    if (r.validation_messages > 0) fmt::print(stderr, "FAULT {} validation messages\n", r.validation_messages);
  });
}

}  // namespace clothbench
