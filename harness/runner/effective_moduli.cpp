#include "runner/effective_moduli.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <optional>

#include "base/sha256.hpp"
#include "clothbench/unsupported_scene.hpp"
#include "metrics/material_patch.hpp"
#include "metrics/metric.hpp"
#include "runner/environment.hpp"
#include "runner/frame_loop.hpp"
#include "runner/interrupt.hpp"
#include "runner/solver_run.hpp"

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
  const int held_before = times_held();
  FrameLoop loop(solver, scene, {.frames = scene.time.frames(), .interrupted = kRunsKept});
  while (loop.next()) {
    const int f = loop.index();
    solver.read_state(state);
    past.push_back(patch_moduli(patch, scene, state.position));
    if (f >= kWindow) r.unrest = change(past.back(), past[past.size() - 1 - kWindow]);
    if (f >= kLeastFrames && r.unrest <= kAtRest) break;
    if (std::chrono::duration<double>(Clock::now() - start).count() > limit_s && times_held() == held_before &&
        f + 1 < scene.time.frames())
      return {{}, kMissing, fmt::format("not at rest after {:g} s", limit_s)};
  }
  if (loop.failed()) return {{}, kMissing, fmt::format("failed in frame {}", loop.index() + 1)};
  r.moduli = past.back();
  return r;
}

/// The solver with the patch, or why it cannot run it.
std::unique_ptr<ClothSolver> loaded(const SolverEntry& entry, const json& settings, const DeviceOptions& device,
                                    const Scene& scene, std::string& why) {
  why = unsupported(entry.info, scene.needs).empty() ? "" : "unsupported";
  if (!why.empty()) return nullptr;
  try {
    return load_solver(entry, settings, device, scene);
  } catch (const UnsupportedScene& e) {
    why = fmt::format("unsupported, because {}", e.what());
    return nullptr;
  }
}

using PatchScenes = std::vector<std::pair<Patch, Scene>>;

PatchScenes patch_scenes(bool full, PatchChoice choice) {
  std::vector<Patch> all = patches(full);
  if (choice == PatchChoice::GridsAndMeshes)
    for (const Patch p : mesh_patches()) all.push_back(p);
  PatchScenes out;
  for (const Patch p : all)
    if (Scene scene = patch_scene(p); choice != PatchChoice::Stretch || !scene.needs.has(Feature::Bend))
      out.emplace_back(p, std::move(scene));
  return out;
}

RunHeader moduli_header(const SolverEntry& entry, const std::string& setting, const json& settings, bool full,
                        const PatchScenes& scenes, const std::string& protocol) {
  json measured = json::array();
  for (const auto& [patch, scene] : scenes) measured.push_back(json::parse(scene.json));
  RunHeader h;
  h.scene = kModuliScene;
  h.solver = entry.info.name;
  h.setting = setting;
  h.settings = settings;
  h.scenario_json =
      json{{"name", kModuliScene}, {"effective_moduli", full ? "full" : "short"}, {"patches", measured}}.dump();
  h.scenario_sha256 = sha256(h.scenario_json);
  h.environment = describe_environment({}, protocol);
  describe_solver(entry.info, h.environment);
  return h;
}

}  // namespace

RunRecord measure_material(const SolverEntry& entry, const json& settings, const std::string& setting, bool full,
                           const DeviceOptions& device, const std::string& protocol, double limit_s,
                           PatchChoice choice) {
  const PatchScenes scenes = patch_scenes(full, choice);
  RunRecord c;
  c.header = moduli_header(entry, setting, settings, full, scenes, protocol);
  if (!entry.make || entry.info.ignores.has(Feature::Stretch)) {
    c.outcome = {"unsupported", "ok", -1, entry.make ? entry.info.name + " does not stretch" : "not in this build"};
    return c;
  }
  Moduli all;
  std::optional<double> unrest;  // of what was measured
  for (const auto& [patch, scene] : scenes) {
    std::string why;
    const auto solver = loaded(entry, settings, device, scene, why);
    if (!solver) {
      c.outcome.message += fmt::format("{}{}: {}", c.outcome.message.empty() ? "" : "; ", patch_name(patch), why);
      continue;
    }
    c.header.environment = describe_environment(solver->device(), protocol);
    describe_solver(entry.info, c.header.environment);
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

RunRecord failed_material(const SolverEntry& entry, const std::string& setting, const Outcome& outcome,
                          const std::string& protocol) {
  RunRecord c;
  c.header = moduli_header(entry, setting, json::object(), setting == "default", {}, protocol);
  c.outcome = outcome;
  return c;
}

RunRecord ask_material(Guard& guard, StudyRuns& runs, const SolverEntry& entry, const json& settings,
                       const std::string& setting, bool full) {
  constexpr char kProtocol[] = "moduli";
  constexpr double kLimit_s = 20;
  const PatchChoice choice = full ? PatchChoice::GridsAndMeshes : PatchChoice::Grids;
  const RunHeader header = moduli_header(entry, setting, settings, full, patch_scenes(full, choice), kProtocol);
  const PlannedRun planned{run_name(header), header.scenario_sha256, settings, entry.make ? &entry.info : nullptr};
  return runs
      .ask(guard, header, entry,
           [&] {
             return std::vector{runs.made(planned, [&] {
               return measure_material(entry, settings, setting, full, runs.device(), kProtocol, kLimit_s, choice);
             })};
           })
      .front();
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
