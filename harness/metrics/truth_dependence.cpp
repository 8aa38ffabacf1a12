#include "metrics/truth_dependence.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "metrics/metric.hpp"
#include "metrics/truth_errors.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

constexpr double kMore = 1.1;
constexpr int kFrames = 4;

double change(const TruthJudge& judge, const Scene& scene, const std::string& key, double value) {
  const Scene other =
      scene_from_json(nlohmann::json::parse(scene.json), scene.source, {fmt::format("{}={}", key, kMore * value)});
  const auto known = truth::reference_case_of(other);
  const int last = scene.time.frames();
  double most = 0;
  for (int k = known->settles ? kFrames : 1; k <= kFrames; ++k) {
    const int frame = last * k / kFrames;
    ClothState state;
    state.position = truth::vertex_positions(other.cloth, *known, frame);
    state.velocity.assign(state.position.size(), 0);
    const TruthErrors e = judge.judge(frame, state);
    most = max_or_nan(most, judge.reference_case().by_quantity ? e.quantity_error : e.e2);
  }
  return most / std::log(kMore);
}

}  // namespace

std::map<std::string, double> truth_dependence(const Scene& scene) {
  if (scene.reference_case.empty()) return {};
  const TruthJudge judge(scene);
  std::map<std::string, double> out = {{"truth_dependence_Y", 0}, {"truth_dependence_B", 0}};
  if (const auto Y = scene.material.membrane_stiffness_N_per_m)
    out["truth_dependence_Y"] = change(judge, scene, "material.membrane_stiffness_N_per_m", *Y);
  if (const double B = scene.material.bending_rigidity_N_m; B > 0)
    out["truth_dependence_B"] = change(judge, scene, "material.bending_rigidity_N_m", B);
  return out;
}

}  // namespace clothbench
