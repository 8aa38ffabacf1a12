// Converged solutions of scenes with contact; see reference.hpp.
#include <fmt/format.h>

#include <cmath>
#include <span>

#include "base/dice.hpp"
#include "clothbench/error.hpp"
#include "metrics/metric.hpp"
#include "runner/frame_loop.hpp"
#include "runner/reference.hpp"
#include "scenario/load.hpp"
#include "truth/reference_case.hpp"

namespace clothbench {
namespace {

Scene nudged(const Scene& scene, int start) {
  Dice dice(static_cast<std::uint64_t>(start), "nudge");
  nlohmann::json j = json_from(scene.json);
  nlohmann::json& pose = j["cloth"]["pose"];
  pose.erase("over_table");  // it would compute the centre again
  for (nlohmann::json& x : pose["center_m"])
    x = x.get<double>() + dice.between(-scene.converged.nudge_m, scene.converged.nudge_m);
  return scene_from_json(j, scene.source);
}

}  // namespace

Ensemble ensemble_of(const Scene& scene, const SolverEntry& entry, const nlohmann::json& settings,
                     const DeviceOptions& device) {
  const truth::LatticeSampler sampler = truth::sampler_of(scene.cloth);
  const int frames = scene.time.frames();
  Ensemble e{};
  e.mean.resize(3 * truth::MaterialLattice::kSide * truth::MaterialLattice::kSide * (frames + 1ul));
  std::vector<double> squares(e.mean.size());
  for (int k = 0; k < scene.converged.starts; ++k) {
    const Scene start = nudged(scene, k);
    const auto solver = load_solver(entry, settings, device, start);
    FrameLoop loop(*solver, start, {.frames = frames});
    ClothState state;
    std::size_t at = 0;
    do {  // Welford's running mean and sum of squared deviations (Technometrics 4, 1962, 419)
      solver->read_state(state);
      for (const double x : sampler.sample(state.position)) {
        const double before = x - e.mean[at];
        e.mean[at] += before / (k + 1);
        squares[at] += before * (x - e.mean[at]);
        ++at;
      }
    } while (loop.next());
    if (loop.failed() || !finite(e.mean))
      throw Error(fmt::format("{}: the converged solution ({} {}) failed in frame {}", scene.source, entry.info.name,
                              dump(settings), loop.index()));
  }
  for (double& s : squares) s = std::sqrt(s / (scene.converged.starts - 1));
  e.spread = motion_distance(scene, squares, std::vector<double>(squares.size()));
  return e;
}

double motion_distance(const Scene& scene, const std::vector<double>& a, const std::vector<double>& b) {
  const truth::MaterialLattice lattice(scene.cloth.width_m, scene.cloth.height_m);
  const std::size_t size = 3 * lattice.size();
  std::vector<double> times_s, errors;
  for (std::size_t at = 0; at < a.size(); at += size) {
    times_s.push_back(scene.time.at(static_cast<int>(times_s.size())));
    errors.push_back(truth::lattice_rms_error(lattice, std::span(a).subspan(at, size), std::span(b).subspan(at, size),
                                              lattice.longer_side_m));
  }
  return truth::time_rms(times_s, errors);
}

double converged_error(const Scene& scene, const AccuracyPass& pass, const std::vector<double>& mean) {
  const auto size = static_cast<std::ptrdiff_t>(3 * scene.cloth.vertex_count());
  const truth::LatticeSampler sampler = truth::sampler_of(scene.cloth);
  std::vector<double> motion;
  for (auto at = pass.position.begin(); pass.position.end() - at >= size; at += size)
    for (const double x : sampler.sample(std::vector<double>(at, at + size))) motion.push_back(x);
  return motion.size() == mean.size() ? motion_distance(scene, motion, mean) : kMissing;
}

}  // namespace clothbench
