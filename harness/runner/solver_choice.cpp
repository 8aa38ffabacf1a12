#include "runner/solver_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "base/plugin_environment.hpp"
#include "base/words.hpp"

namespace clothbench {
namespace {

/// Whether GPU solvers have a device; a notice if there is none and that is allowed.
bool check_device(const SolverEntry& gpu, const DeviceChoice& choice) {
  const std::vector<DeviceInfo> devices = gpu.devices();
  if (devices.empty()) {
    if (!choice.allow_no_device)
      throw Error(
          "no Vulkan device is present; install a driver (Debian: mesa-vulkan-drivers) or give --allow-no-device",
          ExitCode::NoDevice);
    fmt::print(stderr, "no Vulkan device: GPU solvers are left out\n");
    return false;
  }
  if (choice.options.index >= static_cast<int>(devices.size()))
    throw Error(
        fmt::format("--device {}: expected a number below {}, the count of devices (see `clothbench list devices`)",
                    choice.options.index, devices.size()),
        ExitCode::NoDevice);
  return true;
}

}  // namespace

Overrides split_overrides(const std::vector<std::string>& set) {
  const std::string prefix = "solver.";
  Overrides out;
  for (const std::string& item : set) {
    if (item.rfind(prefix, 0) != 0) {
      out.scene.push_back(item);
      continue;
    }
    const auto eq = item.find('=');
    if (eq == std::string::npos) throw Error("--set " + shortened(item, 200) + ": expected solver.<name>=<value>");
    const std::string key = item.substr(prefix.size(), eq - prefix.size()), text = item.substr(eq + 1);
    nlohmann::json value = nlohmann::json::parse(text, nullptr, false);
    if (value.is_discarded()) value = text;
    if (const std::string tuning = std::string(kTuning) + "."; key.starts_with(tuning))
      out.solver[kTuning].update({{key.substr(tuning.size()), value}});
    else
      out.solver[key] = value;
  }
  return out;
}

void refuse_scene(const std::vector<std::string>& set, const std::string& expected) {
  for (const std::string& key : split_overrides(set).scene)
    throw Error("--set " + shortened(key, 200) + ": " + expected);
}

std::string Overrides::label() const {
  std::string text;
  nlohmann::json flat = solver;
  flat.erase(kTuning);
  if (solver.contains(kTuning)) flat.update(solver[kTuning]);
  for (const auto& [key, value] : flat.items())
    text += (text.empty() ? "" : ",") + key + "=" + (value.is_string() ? value.get<std::string>() : value.dump());
  return text.empty() ? "default" : text;
}

ChosenSolver chosen_solver(const std::string& name, const Overrides& overrides) {
  const SolverEntry& entry = find_solver(name);
  return {&entry, complete_settings(entry.info, overrides.solver), overrides.label()};
}

std::vector<const SolverEntry*> all_solvers() {
  std::vector<const SolverEntry*> out;
  for (const SolverEntry& e : solvers()) out.push_back(&e);
  const char* plugins = std::getenv(kPluginsVariable);  // --solver adds to it
  std::istringstream paths(plugins != nullptr ? plugins : "");
  for (std::string path; std::getline(paths, path, ':');)
    if (!path.empty()) out.push_back(&find_solver(kPluginPrefix + path));
  return out;
}

std::vector<std::string> solver_names(bool (*are)(const SolverInfo&)) {
  std::vector<std::string> names;
  for (const SolverEntry& e : solvers())
    if (are == nullptr || are(e.info)) names.push_back(e.info.name);
  return names;
}

void settle_device(RunPlan& plan, const DeviceChoice& choice) {
  const SolverEntry* gpu = nullptr;
  for (const auto& group : plan.groups)
    for (const RunSpec& c : group)
      if (c.entry->info.on_gpu && c.entry->devices) gpu = c.entry;
  if (gpu == nullptr || check_device(*gpu, choice)) return;
  for (auto& group : plan.groups) std::erase_if(group, [](const RunSpec& c) { return c.entry->info.on_gpu; });
}

}  // namespace clothbench
