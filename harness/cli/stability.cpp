#include <fmt/format.h>

#include <filesystem>

#include "cli/run_common.hpp"
#include "report/report.hpp"
#include "runner/child.hpp"
#include "runner/environment.hpp"
#include "runner/stability_map.hpp"

namespace clothbench {
namespace {

/// The environment of all its processes; without GPU solvers where there is no device and that is allowed.
nlohmann::json settle(Study& study, const DeviceFlags& flags, std::vector<std::string>& only) {
  const SolverEntry* gpu = nullptr;
  for (const SolverEntry& e : solvers())
    if (e.devices && e.info.on_gpu) gpu = &e;
  DeviceInfo device;
  if (gpu != nullptr && check_device(*gpu, flags)) {
    const std::vector<DeviceInfo> all = gpu->devices();
    std::size_t best = 0;
    for (std::size_t k = all.size(); k-- > 0;)
      if (!all[k].is_software) best = k;
    device = all[flags.options.index >= 0 ? static_cast<std::size_t>(flags.options.index) : best];
  } else if (gpu != nullptr) {
    const auto is_gpu = [](const std::string& name) {
      for (const SolverEntry& e : solvers())
        if (e.info.name == name) return e.info.on_gpu;
      return false;
    };
    for (Study::Item& item : study.scenes)
      std::erase_if(item.solvers, [&](std::size_t k) { return is_gpu(study.solvers[k].solver); });
    if (only.empty())
      for (const SolverEntry& e : solvers())
        if (!e.info.on_gpu) only.push_back(e.info.name);
    std::erase_if(only, is_gpu);
  }
  return describe_environment(device, study.protocol);
}

}  // namespace

StabilityOptions options_apart(Study& study, StudyManifest& manifest, const RunFlags& flags,
                               std::vector<std::string>& only, int jobs, const Console& console) {
  StabilityOptions options;
  options.environment = settle(study, flags.device, only);
  options.out = flags.out.empty() ? default_folder(manifest.study) : std::filesystem::path(flags.out);
  options.program = own_program();
  options.device = flags.device.options;
  options.resume = flags.resume;
  options.jobs = jobs;
  options.solvers = only;
  std::filesystem::create_directories(options.out);
  manifest.created = utc_now();
  manifest.command_line = console.command_line;
  for (const Study::Item& item : study.scenes)
    for (const std::size_t k : item.solvers)
      manifest.runs.push_back(run_name(item.scene.name, study.solvers[k].solver, study.solvers[k].label));
  return options;
}

void run_stability_and_tell(Study study, StudyManifest manifest, const RunFlags& flags, std::vector<std::string> only,
                            int jobs, Console& console) {
  StabilityOptions options = options_apart(study, manifest, flags, only, jobs, console);
  require_same_study(study, options);
  write_manifest(options.out, manifest);
  StabilityCounts counts;
  {
    StatusLine line(!console.json);
    options.progress = [&](const std::string& what, std::size_t done, std::size_t total) {
      line.show(what, done, total);
    };
    counts = execute_stability_runs(study, options);
    counts.add(run_stability_maps(study, options));
  }
  if (console.json) {
    nlohmann::json j = {{"out", options.out.string()},       {"stable", counts.stable},
                        {"degraded", counts.degraded},       {"failed", counts.failed},
                        {"unsupported", counts.unsupported}, {"crashed", counts.crashed}};
    fmt::print("{}\n", j.dump(2));
    return;
  }
  print_console_report({options.out});
  fmt::print("\n{} runs stable, {} degraded, {} failed ({} of them crashed or hung), {} unsupported; results in {}\n",
             counts.stable, counts.degraded, counts.failed, counts.crashed, counts.unsupported, options.out.string());
}

}  // namespace clothbench
