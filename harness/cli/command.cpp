#include "cli/command.hpp"

#include <charconv>
#include <cstdio>

#include "base/words.hpp"

namespace clothbench {

void SolverFlags::add_to(CLI::App& app, const std::string& option, const std::string& help,
                         const std::string& set_help) {
  add_solvers(app, option, solvers, help);
  app.add_option("--set", set, set_help);
}

std::vector<ChosenSolver> SolverFlags::chosen(const std::vector<std::string>& by_default) const {
  const Overrides overrides = split_overrides(set);
  std::vector<ChosenSolver> out;
  for (const std::string& name : solvers.empty() ? by_default : solvers) out.push_back(chosen_solver(name, overrides));
  return out;
}

std::pair<int, int> pixels_of(const std::string& option, const std::string& text) {
  constexpr int kMost = 16384;
  int width = 0, height = 0, used = 0;
  if (std::sscanf(text.c_str(), "%5dx%5d%n", &width, &height, &used) != 2 || used != static_cast<int>(text.size()) ||
      width < 1 || height < 1 || width > kMost || height > kMost)
    throw Error(option + " " + text +
                ": not a size; give WIDTHxHEIGHT in pixels, each from 1 to 16384, such as 1200x900");
  return {width, height};
}

void DeviceFlags::add_to(CLI::App& app) {
  app.add_option("--device", options.index, "Vulkan device number (see `list devices`); default: the best one");
  app.add_option("--device-profile", options.profile,
                 "Limit the device to a device class: adreno-like (32 KiB shared memory, groups of 256)");
  app.add_flag("--validate", options.validation,
               "Vulkan core and synchronization validation; any message fails the run");
}

void SustainedFlag::add_to(CLI::App& app) {
  app.add_flag(
      "--sustained{600}", seconds,
      "Instead of trials, step each run at its scene's frame rate for this many seconds, in windows of at most 10 s "
      "(--sustained=60; default 600): shows how a device slows as it gets warm");
}

void SustainedFlag::apply_to(RunPlan& plan) const {
  if (seconds.empty()) return;
  constexpr int kDay_s = 86400;
  int s = 0;
  const auto [end, error] = std::from_chars(seconds.data(), seconds.data() + seconds.size(), s);
  if (error != std::errc() || *end != '\0' || s < 1 || s > kDay_s)
    throw Error("--sustained=" + shortened(seconds, 40) + ": expected whole seconds, from 1 to 86400");
  sustain(plan, s);
}

CLI::Option* add_solvers(CLI::App& app, const std::string& option, std::vector<std::string>& names,
                         const std::string& help) {
  const auto name_of_plugin = [](std::string name) {
    return name.starts_with(kPluginPrefix) ? find_solver(name).info.name : name;
  };
  return app.add_option(option, names, help + "; plugin:PATH loads a solver from a shared library")
      ->transform(name_of_plugin);
}

void add_require_assets(CLI::App& app, bool& required) {
  app.add_flag("--require-assets", required,
               "Fail if a scene would use procedural rooms or hands instead of scans (scripts/fetch-assets.sh "
               "fetches the scans)");
}

}  // namespace clothbench
