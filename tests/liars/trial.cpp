#include "trial.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "metrics/truth_errors.hpp"

namespace clothbench::liars {
namespace {

/// Differences below this multiple of the resolution do not count as lies.
constexpr double kNoticed = 10e-4;

/// Error against the scene's exact solution, divided by its bound (a run fails above 1); NaN if there is none.
double solution_ratio(const Motion& m) {
  if (m.scene->reference_case.empty() || m.frames() != static_cast<std::size_t>(m.scene->time.frames()) + 1)
    return std::numeric_limits<double>::quiet_NaN();
  const TruthJudge judge(*m.scene);
  const ExactBound bound = exact_bound(judge);
  std::vector<double> e2, quantity;
  ClothState state;
  state.velocity.assign(3 * m.vertices(), 0);
  for (std::size_t k = 0; k < m.frames(); ++k) {
    const auto from = m.position.begin() + static_cast<std::ptrdiff_t>(3 * m.vertices() * k);
    state.position.assign(from, from + static_cast<std::ptrdiff_t>(3 * m.vertices()));
    const TruthErrors e = judge.judge(static_cast<int>(k), state);
    e2.push_back(e.e2), quantity.push_back(e.quantity_error);
  }
  const auto over = [&](const std::vector<double>& x, double allowed) {
    const double error = judge.reference_case().settles ? x.back() : truth::time_rms(m.time_s, x);
    return std::isfinite(error) ? error / allowed : std::numeric_limits<double>::infinity();
  };
  return std::max(over(e2, bound.e2), over(quantity, bound.quantity_error));
}

Trial judged(const Right& right, const Lie& lie, const Motion& told) {
  Trial t;
  t.lie = lie.name;
  t.right = lie.right;
  t.solver = right.motion.solver;
  t.determined = lie.determined(right, told);
  t.difference_m = difference_m(right, told);
  t.findings = motion_check::verify(*told.scene, {told.time_s, told.position}, told.contact_offsets_m);
  // Noise is below the check's resolution, but not below the bound of a solution at rest.
  const bool noise = lie.right && told.position != right.motion.position;
  t.solution = noise ? std::numeric_limits<double>::quiet_NaN() : solution_ratio(told);
  return t;
}

}  // namespace

std::vector<Trial> tell_all(const Matrix& matrix) {
  std::vector<Trial> out;
  const std::vector<std::string>& kinds = matrix.kinds.empty() ? scene_kinds() : matrix.kinds;
  for (int i = 0; i < matrix.motions; ++i) {
    const std::uint64_t seed = matrix.seed + static_cast<std::uint64_t>(i);
    const std::string& kind = kinds[seed % kinds.size()];
    const auto scene = std::make_shared<const Scene>(draw_scene(kind, seed));
    const std::vector<RightSolver> with = right_solvers(*scene, matrix.solver);
    if (with.empty()) continue;
    const RightSolver& solver = with[seed / kinds.size() % with.size()];
    std::optional<Motion> motion = run(scene, solver);
    if (!motion) continue;
    const Facts facts = facts_of(*motion);
    const Right right{std::move(*motion), facts,
                      [&](const std::function<void(Scene&)>& changed) { return run(scene, solver, changed); }};
    bool trusted = true;
    for (const Lie& lie : lies()) {
      if (!trusted || !lie.applies(right.facts)) continue;
      if (!lie.right && !matrix.only_lie.empty() && matrix.only_lie != lie.name) continue;
      Dice dice(seed, lie.name);
      const std::optional<Motion> told = lie.tell(right, dice);
      if (!told) continue;
      Trial t = judged(right, lie, *told);
      t.kind = kind;
      t.seed = seed;
      if (!lie.right && !(t.difference_m > kNoticed * right.facts.length_m)) continue;
      // If a correct motion fails, it cannot show whether a lie is detected.
      if (lie.right && t.failed()) trusted = false;
      out.push_back(std::move(t));
    }
  }
  return out;
}

nlohmann::json as_json(const Trial& t) {
  nlohmann::json alarms = nlohmann::json::object();
  for (const motion_check::Finding& f : t.findings)
    if (!(f.ratio <= 1)) alarms[f.statistic->name] = {motion_check::name_of(f.statistic->check), f.ratio, f.frame};
  return {{"kind", t.kind},
          {"seed", t.seed},
          {"solver", t.solver},
          {"lie", t.lie},
          {"right", t.right},
          {"determined", t.determined},
          {"failed", t.failed()},
          {"off_m", t.difference_m},
          {"worst", {t.worst().statistic->name, t.worst().ratio, t.worst().frame}},
          {"solution", t.solution},
          {"alarms", alarms}};
}

}  // namespace clothbench::liars
