// Short runs for strict.py: CPU solvers and prescribed motions, stored in ordinary files. Positions are rounded to the
// precision of the files before they are measured, so that a reader sees what the metrics saw.
//
// usage: stored_runs FOLDER
#include <cmath>
#include <cstdio>
#include <deque>
#include <filesystem>

#include "clothbench/error.hpp"
#include "prescribed_solver.hpp"
#include "runner/study_runner.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

/// Wraps a solver and rounds positions to the precision of files.
class Rounded final : public WrappedSolver {
 public:
  using WrappedSolver::WrappedSolver;
  void read_state(ClothState& out) const override {
    inner_->read_state(out);
    for (double& x : out.position) x = static_cast<double>(static_cast<float>(x));
  }
};

SolverEntry rounded(SolverEntry entry) {
  entry.make = [make = entry.make](const nlohmann::json& settings, const DeviceOptions& options) {
    return std::make_unique<Rounded>(make(settings, options));
  };
  return entry;
}

/// Waves in which no vertex has a special position.
Path waves(double height_m, double drop_m_per_frame = 0) {
  return [=](int frame, std::vector<double>& x) {
    for (std::size_t k = 0; k < x.size(); k += 3) {
      const double u = x[k], v = x[k + 1] + 1.3 * x[k + 2], t = 0.05 * frame;
      x[k] += 0.3 * height_m * std::sin(9.1 * v + 1.7 + t);
      x[k + 1] += height_m * std::sin(11.3 * u + 4.1 * v + t) - drop_m_per_frame * frame;
      x[k + 2] += height_m * std::cos(7.7 * u + 5.3 * v + 0.4 + t);
    }
  };
}

/// `rest`, with one vertex or another jumping aside in every fourth frame.
Path jumping(const Path& rest) {
  return [=](int frame, std::vector<double>& x) {
    rest(frame, x);
    if (frame % 4 == 0) x[3 * static_cast<std::size_t>(5 * frame) % x.size()] += 0.3;
  };
}

/// Rolled up so that it goes through itself, a little further every frame.
Path rolled() {
  return [](int frame, std::vector<double>& x) {
    for (std::size_t k = 0; k < x.size(); k += 3) {
      const double s = x[k], turn = 0.25 * frame * s, lean = 0.11 * x[k + 2] + 0.013;
      x[k] = 0.08 * std::sin(4 * turn) + 0.2 * s + 0.3 * lean;
      x[k + 1] += 0.08 * std::cos(4 * turn) + lean * s;
      x[k + 2] += 0.02 * std::sin(9 * s);
    }
  };
}

struct Sample {
  std::string scene;
  std::vector<std::string> changes;
  SolverEntry solver;
};

std::vector<Sample> samples() {
  const std::string small = "cloth.grid=[8,8]", few = "time.duration_s=0.5", friction = "colliders.0.friction=0.3";
  const SolverEntry &falls = find_solver("ballistic"), &soft = find_solver("bullet-soft");
  const std::string sphere_on_plane =
      R"(colliders=[{"type":"sphere","center_m":[0.02,-0.25,0.01],"radius_m":0.2},{"type":"plane","point_m":[0,-0.4,0],"normal":[0.28,0.96,0]}])";
  const std::string capsule =
      R"(colliders=[{"type":"capsule","center_m":[0.31,0.02,0.21],"radius_m":0.04,"length_m":0.5,"axis":[0.28,0.96,0],"velocity_m_per_s":[-1,0,-0.7],"margin_m":0.004,"friction":0.2}])";
  return {
      {"paper/gravity", {small, few}, falls},
      {"contact/sphere", {small, "time.duration_s=0.6", friction}, falls},
      {"contact/box", {small, few, "colliders.0.rotation_deg=[11,23,5]"}, falls},
      {"contact/plane", {small, "time.duration_s=0.7"}, falls},
      {"contact/open-sheet", {small, "time.duration_s=0.4"}, falls},
      {"contact/sphere", {small, "time.duration_s=0.8"}, soft},
      {"contact/open-sheet", {small, "time.duration_s=0.6"}, soft},
      {"contact/sphere", {small, "time.duration_s=0.7", sphere_on_plane}, prescribed(waves(0.02, 0.02))},
      {"contact/open-sheet", {small, "time.duration_s=0.7"}, prescribed(jumping(waves(0.03, 0.021)))},
      {"paper/capsule-sweep", {small, "time.duration_s=0.8", capsule}, prescribed(jumping(waves(0.03)))},
      {"paper/capsule-sweep", {small, "time.duration_s=1.45", "time.frame_rate_hz=18"}, prescribed(waves(0.01))},
      {"paper/two-hand-stretch-2mps", {"cloth.grid=[9,9]", "time.duration_s=3"}, prescribed(jumping(waves(0.01)))},
      {"paper/hand-push", {"cloth.grid=[9,9]", "time.duration_s=2.4", "time.frame_rate_hz=8"}, prescribed(waves(0.01))},
      {"paper/desk-flat-low", {small, "time.duration_s=0.5"}, prescribed(waves(0.01, 0.03))},
      {"contact/self-fold", {"cloth.grid=[12,12]", few}, prescribed(rolled())}};
}

void execute(const std::filesystem::path& folder) {
  const std::vector<Sample> all = samples();
  std::deque<Scene> scenes;
  std::deque<SolverEntry> entries;
  for (std::size_t k = 0; k < all.size(); ++k) {
    std::vector<std::string> changes{"time.frame_rate_hz=30"};
    changes.insert(changes.end(), all[k].changes.begin(), all[k].changes.end());
    scenes.push_back(load_scene(all[k].scene, changes));
    entries.push_back(rounded(all[k].solver));
    RunPlan plan;
    plan.groups = {
        {{&scenes.back(), &entries.back(), complete_settings(entries.back().info, nlohmann::json::object())}}};
    plan.rules.trials = 0;
    plan.rules.accuracy_duration_s = scenes.back().time.duration_s;
    plan.protocol = "test";
    RunOptions options;
    options.out = folder / std::to_string(k);
    std::filesystem::create_directories(options.out);
    const RunResult result = execute_runs(plan, options);
    if (read_run_summary(result.files.at(0)).outcome.status != "ok")
      throw Error(all[k].scene + ": the run did not end well");
  }
}

}  // namespace
}  // namespace clothbench

int main(int count, char** arguments) {
  if (count != 2) return std::fprintf(stderr, "usage: stored_runs FOLDER\n"), 2;
  try {
    std::filesystem::remove_all(arguments[1]);
    clothbench::execute(arguments[1]);
  } catch (const std::exception& e) {
    return std::fprintf(stderr, "stored_runs: %s\n", e.what()), 1;
  }
  return 0;
}
