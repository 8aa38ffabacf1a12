#include "cli/run_common.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/tint.hpp"
#include "cli/study_moduli.hpp"
#include "report/in_short.hpp"
#include "report/report.hpp"
#include "report/withheld.hpp"
#include "runner/environment.hpp"
#include "runner/run_choice.hpp"
#include "runner/supervise.hpp"
#include "truth/draw.hpp"

namespace clothbench {
std::filesystem::path default_folder(const std::string& study) {
  std::string stamp = utc_now();
  stamp.erase(std::remove_if(stamp.begin(), stamp.end(), [](char c) { return c == '-' || c == ':'; }), stamp.end());
  return std::filesystem::path("results/runs") / (study + "-" + stamp);
}

void SearchFlags::add_storage_to(CLI::App& app) {
  CLI::Option* folder = app.add_option("--out", out, "Also store every run in this folder, for `clothbench report`");
  app.add_flag("--resume", resume, "Continue with the runs stored in that folder")->needs(folder);
  device.add_to(app);
}

StudyRuns SearchFlags::runs(const std::string& study, const Console& console) const {
  if (out.empty()) return StudyRuns(device.options);
  const nlohmann::json definition = {{"name", study}, {"solvers", solvers}, {"set", set}};
  return {device.options, out, resume, {study, "", console.command_line, definition, {}}};
}

bool check_device(const SolverEntry& gpu, const DeviceFlags& flags) {
  const std::vector<DeviceInfo> devices = gpu.devices();
  if (devices.empty()) {
    if (!flags.allow_no_device)
      throw Error(
          "no Vulkan device is present; install a driver (Debian: mesa-vulkan-drivers) or give --allow-no-device",
          ExitCode::NoDevice);
    fmt::print(stderr, "no Vulkan device: GPU solvers are left out\n");
    return false;
  }
  if (flags.options.index >= static_cast<int>(devices.size()))
    throw Error(
        fmt::format("--device {}: expected a number below {}, the count of devices (see `clothbench list devices`)",
                    flags.options.index, devices.size()),
        ExitCode::NoDevice);
  return true;
}

namespace {

/// Says what GPU solvers will run on, before anything is measured. Drops them where there is no device and that is
/// allowed.
void settle_device(RunPlan& plan, const DeviceFlags& flags) {
  const SolverEntry* gpu = nullptr;
  for (const auto& group : plan.groups)
    for (const RunSpec& c : group)
      if (c.entry->info.on_gpu && c.entry->devices) gpu = c.entry;
  if (gpu == nullptr) return;
  if (check_device(*gpu, flags)) return;
  for (auto& group : plan.groups)
    group.erase(std::remove_if(group.begin(), group.end(), [](const RunSpec& c) { return c.entry->info.on_gpu; }),
                group.end());
}

nlohmann::json seconds_json(const RunResult& r) {
  nlohmann::json j = nlohmann::json::object();
  for (const auto& [name, s] : r.seconds) j[name] = {{"runs", s}};
  for (const auto& [name, s] : r.moduli_seconds) j[name]["moduli"] = s;
  return j;
}

/// The plan's runs as they are stored.
std::vector<RunRecord> stored_runs(const RunPlan& plan, const std::filesystem::path& out) {
  const std::vector<std::string> names = run_names(plan);
  std::vector<RunRecord> runs = collect({out});
  std::erase_if(runs, [&](const RunRecord& c) {
    return std::find(names.begin(), names.end(), run_name(c.header)) == names.end();
  });
  withhold_times(runs);
  return runs;
}

/// Outcome and every figure of each run.
nlohmann::json figures_of(const RunPlan& plan, const std::filesystem::path& out) {
  nlohmann::json all = runs_json(stored_runs(plan, out));
  for (nlohmann::json& run : all) run.erase("environment");  // in the result files
  return all;
}

/// A few runs at a glance, under the tables; many are what the tables are for.
void print_in_short(const RunPlan& plan, const std::filesystem::path& out) {
  constexpr std::size_t kFew = 24;
  if (plan.size() == 0 || plan.size() > kFew) return;
  fmt::print("{}", in_short_table(stored_runs(plan, out)).console());
}

/// Where the time went, and what was not measured for its sake.
void print_spent(const RunResult& r) {
  std::string text;
  double all = 0;
  for (const auto& [name, s] : r.seconds) {
    const auto moduli = r.moduli_seconds.find(name);
    text += fmt::format("{}{} {:.1f}", text.empty() ? "" : ", ", name, s);
    if (moduli != r.moduli_seconds.end()) text += fmt::format(" + {:.1f} on moduli", moduli->second);
    all += s + (moduli == r.moduli_seconds.end() ? 0 : moduli->second);
  }
  fmt::print("seconds: {}; together {:.0f}\n", text, all);
  if (r.runs_over_budget > 0)
    fmt::print("not run: {} settings, because their solvers had used all of their time on the scene (over_budget)\n",
               r.runs_over_budget);
  if (r.moduli_left_out > 0)
    fmt::print(
        "not run: effective moduli of {} settings on fronts, which could change no verdict; a full study measures "
        "all\n",
        r.moduli_left_out);
}

}  // namespace

void add_seed(CLI::App& app, std::optional<std::uint64_t>& seed) {
  app.add_option("--seed", seed,
                 "Draw the parameters of scenes with an exact solution from this seed, and evaluate the solution for "
                 "them; in a study of drawn contact scenes, the seed of the first scene");
}

Scene at_seed(Scene scene, const std::optional<std::uint64_t>& seed, Console& console) {
  if (!seed) return scene;
  truth::DrawnScene drawn = truth::draw(scene, *seed);
  if (!console.json && console.reported_scenes.insert(scene.name).second) {
    std::string text;
    for (const auto& [name, value] : drawn.values) text += fmt::format(" {}={:.6g}", name, value);
    fmt::print("{} --seed {}:{} frame_rate_hz={:.6g} duration_s={:.6g}\n", scene.name, *seed, text,
               drawn.scene.time.frame_rate_hz, drawn.scene.time.duration_s);
  }
  return std::move(drawn.scene);
}

void run_and_tell(RunPlan plan, StudyManifest manifest, const RunFlags& flags, Console& console) {
  settle_device(plan, flags.device);
  const std::optional<Supervised> parent = supervised();
  const std::filesystem::path out = parent              ? parent->out
                                    : flags.out.empty() ? default_folder(manifest.study)
                                                        : std::filesystem::path(flags.out);
  require_same_runs(out, plan, parent ? parent->resume : flags.resume);
  std::filesystem::create_directories(out);
  if (needs_supervision(plan)) {
    console.exit_code = supervise(plan, out, flags.resume, console.words);
    return;
  }
  manifest.created = utc_now();
  manifest.command_line = console.command_line;
  if (manifest.runs.empty()) manifest.runs = run_names(plan);
  write_manifest(out, manifest);

  RunResult result;
  {
    StatusLine line(!console.json);
    const RunningNote note(parent);
    RunOptions options{out, parent ? parent->resume : flags.resume, flags.device.options,
                       [&](const std::string& what, std::size_t done, std::size_t total) {
                         line.show(what, done, total);
                         note.write(what);
                       }};
    result = execute_runs(plan, options);
    if (plan.measure_moduli) add_moduli_runs(plan, options, manifest, result);
  }
  for (const std::string& fault : result.faults) fmt::print(stderr, "FAULT {}\n", fault);
  if (!result.faults.empty()) console.exit_code = ExitCode::CheckFailed;
  if (console.json) {
    nlohmann::json j = {{"out", out.string()},
                        {"ok", result.runs_ok},
                        {"unsupported", result.runs_unsupported},
                        {"over_budget", result.runs_over_budget},
                        {"failed", result.runs_failed},
                        {"seconds", seconds_json(result)},
                        {"moduli", result.moduli},
                        {"moduli_left_out", result.moduli_left_out},
                        {"faults", result.faults},
                        {"expect_passed", result.expect_passed},
                        {"expect_failed", result.expect_failed},
                        {"runs", flags.part ? nlohmann::json::array() : figures_of(plan, out)}};
    fmt::print("{}\n", j.dump(2));
    return;
  }
  if (!flags.part) print_console_report({out});
  print_in_short(plan, out);
  const auto counted = [](int n, const char* what, Tone tone) {
    return tinted(n > 0 ? tone : Tone::Plain, fmt::format("{} {}", n, what));
  };
  fmt::print("\n{}, {}, {}; results in {}\n", counted(result.runs_ok, "runs ok", Tone::Good),
             counted(result.runs_unsupported, "unsupported", Tone::Doubtful),
             counted(result.runs_failed, "failed", Tone::Bad), out.string());
  print_spent(result);
}

}  // namespace clothbench
