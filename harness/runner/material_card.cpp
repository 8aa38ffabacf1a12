#include "runner/material_card.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <optional>

#include "base/sha256.hpp"
#include "metrics/material_patch.hpp"
#include "metrics/metric.hpp"
#include "runner/cell.hpp"
#include "runner/environment.hpp"
#include "runner/frame_input.hpp"

namespace clothbench {
namespace {

using nlohmann::json;
using Moduli = std::map<std::string, double>;

constexpr int kWindow = 15;       // frames, a quarter of a second
constexpr int kLeastFrames = 45;  // an overdamped sheet creeps at first
constexpr double kAtRest = 1e-4;

struct Result {
  Moduli moduli;
  double unrest = kMissing;
  std::string fault;
};

double change(const Moduli& a, const Moduli& b) {
  double most = 0;
  for (const auto& [name, value] : a) {
    if (name == "skew" || name == "strip_border") continue;  // ratios that may be 0
    most = max_or_nan(most, value == b.at(name) ? 0 : std::abs(value / b.at(name) - 1));
  }
  return most;
}

/// Runs the patch on a loaded solver to rest.
Result settle(ClothSolver& solver, Patch patch, const Scene& scene, double limit_s) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  std::vector<Moduli> past;
  ClothState state;
  Result r;
  for (int f = 0; f < scene.time.frames(); ++f) {
    if (interrupt_requested())
      throw Error("interrupted; finished cells are kept (continue with --resume)", ExitCode::Interrupted);
    if (solver.step(frame_input(scene, f)) != StepStatus::Ok)
      return {{}, kMissing, fmt::format("failed in frame {}", f + 1)};
    solver.read_state(state);
    past.push_back(patch_moduli(patch, scene, state.position));
    if (f >= kWindow) r.unrest = change(past.back(), past[past.size() - 1 - kWindow]);
    if (f >= kLeastFrames && r.unrest <= kAtRest) break;
    if (std::chrono::duration<double>(Clock::now() - start).count() > limit_s && f + 1 < scene.time.frames())
      return {{}, kMissing, fmt::format("not at rest after {:g} s", limit_s)};
  }
  r.moduli = past.back();
  return r;
}

}  // namespace

CellRecord measure_material(const SolverEntry& entry, const json& settings, const std::string& setting, bool full,
                            const DeviceOptions& device, const std::string& protocol, double limit_s, bool bending) {
  CellRecord c;
  c.header.scene = kMaterialCardScene;
  c.header.solver = entry.info.name;
  c.header.setting = setting;
  c.header.settings = settings;
  json scenario = {
      {"name", kMaterialCardScene}, {"material_card", full ? "full" : "short"}, {"patches", json::array()}};
  std::vector<std::pair<Patch, Scene>> scenes;
  for (const Patch p : patches(full)) {
    if (!bending && patch_scene(p).needs.has(Feature::Bend)) continue;
    scenes.emplace_back(p, patch_scene(p));
    scenario["patches"].push_back(json::parse(scenes.back().second.json));
  }
  c.header.scenario_json = scenario.dump();
  c.header.scenario_sha256 = sha256(c.header.scenario_json);
  c.header.environment = describe_environment({}, protocol);
  c.header.environment["solver_features"] = describe_features(entry.info);
  if (!entry.make || entry.info.ignores.has(Feature::Stretch)) {
    c.outcome = {"unsupported", "ok", -1, entry.make ? entry.info.name + " does not stretch" : "not in this build"};
    return c;
  }
  Moduli all;
  std::optional<double> unrest;  // of what was measured
  for (const auto& [patch, scene] : scenes) {
    if (!unsupported(entry.info, scene.needs).empty()) {
      c.outcome.message += fmt::format("{}{}: unsupported", c.outcome.message.empty() ? "" : "; ", patch_name(patch));
      continue;
    }
    const auto solver = entry.make(settings, device);
    solver->load(scene);
    c.header.environment = describe_environment(solver->device(), protocol);
    c.header.environment["solver_features"] = describe_features(entry.info);
    Result r = settle(*solver, patch, scene, limit_s);
    if (!r.fault.empty())
      c.outcome.message += fmt::format("{}{}: {}", c.outcome.message.empty() ? "" : "; ", patch_name(patch), r.fault);
    all.merge(r.moduli);
    if (r.fault.empty()) unrest = max_or_nan(unrest.value_or(0), r.unrest);
  }
  if (full) all["E_45"] = modulus_at_45(all);
  for (const auto& [name, value] : all) c.summary["material_" + name] = value;
  c.summary["material_unrest"] = unrest.value_or(kMissing);
  return c;
}

CellRecord failed_material(const SolverEntry& entry, const std::string& setting, const Outcome& outcome,
                           const std::string& protocol) {
  CellRecord c;
  c.header.scene = kMaterialCardScene;
  c.header.solver = entry.info.name;
  c.header.setting = setting;
  c.header.settings = json::object();
  c.header.scenario_json = json{
      {"name", kMaterialCardScene},
      {"material_card", setting == "default" ? "full" : "short"},
      {"patches",
       json::array()}}.dump();
  c.header.scenario_sha256 = sha256(c.header.scenario_json);
  c.header.environment = describe_environment({}, protocol);
  c.header.environment["solver_features"] = describe_features(entry.info);
  c.outcome = outcome;
  return c;
}

std::map<std::string, json> swept_settings(const SolverInfo& info, const json& complete) {
  constexpr int kFactor = 4, kInstead = 1024;
  std::map<std::string, json> out;
  for (const SettingSpec& s : info.settings) {
    if ((s.name != "substeps" && s.name != "iterations") || !complete.at(s.name).is_number_integer()) continue;
    const int now = complete.at(s.name).get<int>(), then = now > 0 ? kFactor * now : kInstead;
    json swept = complete;
    swept[s.name] = then;
    out[fmt::format("{}={}", s.name, then)] = std::move(swept);
  }
  return out;
}

}  // namespace clothbench
