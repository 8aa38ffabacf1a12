#include "cli/command.hpp"
#include "runner/interrupt.hpp"
#include "xr/loop.hpp"

namespace clothbench {
namespace {

struct XrArguments {
  std::string scene, solver, out;
  std::vector<std::string> set;
  int frames = 0;
  double rate = 72, timeout = 120;
  DeviceFlags device;
};

}  // namespace

void add_xr(CLI::App& app, Console& console) {
  XrArguments& a = console.arguments<XrArguments>();
  a.solver = "xpbd";
  CLI::App* cmd = app.add_subcommand(
      "xr", "Run a live session in a headset (OpenXR): the cloth is drawn and touches the user's hands");
  cmd->add_option("scene", a.scene, "Scene file or name; the user's hands replace the hands of the scene")->required();
  cmd->add_option("--solver", a.solver, "Solver")->capture_default_str();
  cmd->add_option("--set", a.set, "Override: cloth.grid=[64,64], solver.substeps=20");
  cmd->add_option("--frames", a.frames,
                  fmt::format("Frames; default: the length of the scene, at most {}", xr::kMostFrames))
      ->check(CLI::Range(1, xr::kMostFrames));
  cmd->add_option("--rate", a.rate, "Requested refresh rate of the display [Hz]")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  cmd->add_option("--timeout", a.timeout, "The session ends after this time without tracked hands [s]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  cmd->add_option("--out", a.out, "Folder for the result file and the recorded scene; default results/runs/xr-<UTC>");
  a.device.add_to(*cmd);
  cmd->footer("Example: clothbench xr paper/capsule-sweep --frames 720");
  cmd->callback([&console, &a] {
    const Overrides overrides = split_overrides(a.set);
    xr::LoopOptions o;
    o.scenario = a.scene;
    o.overrides = overrides.scene;
    o.entry = &find_solver(a.solver);
    o.settings = complete_settings(o.entry->info, overrides.solver);
    o.setting = overrides.label();
    o.device = a.device.options;
    o.rate_hz = a.rate;
    o.frames = a.frames;
    o.timeout_s = a.timeout;
    o.out = a.out.empty() ? default_folder("xr") : std::filesystem::path(a.out);
    if (!console.json) o.tell = [](const std::string& text) { fmt::print("{}\n", text); };
    const xr::LoopResult r = xr::run_loop(o);
    console.print([&] { return xr::loop_json(r); }, [&] { return xr::loop_text(r); });
    if (r.outcome.status != "ok" || r.validation_messages > 0) console.exit_code = ExitCode::CheckFailed;
    if (interrupt_requested()) console.exit_code = ExitCode::Interrupted;
    if (r.outcome.status != "ok")
      fmt::print(stderr, "FAULT {} in frame {}: {}\n", r.outcome.status, r.outcome.failed_frame, r.outcome.message);
    if (r.validation_messages > 0) fmt::print(stderr, "FAULT {} validation messages\n", r.validation_messages);
  });
}

}  // namespace clothbench
