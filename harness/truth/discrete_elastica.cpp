#include "truth/discrete_elastica.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "clothbench/error.hpp"
#include "truth/checks.hpp"
#include "truth/tridiagonal.hpp"

namespace clothbench::truth {
namespace {

using Angles = std::vector<double>;

// Energy over B/L: n sum of bending(turn) - sum of pull_i sin(angle_i)/n.
std::optional<Angles> newton(const DiscreteElasticaLoad& load, Angles angle, double share) {
  const std::size_t n = angle.size();
  const double cells = load.links, clamp = load.clamp == ClampHinge::HalfCell ? 2 : 1;
  const bool hinge = load.model == BendingModel::Hinge;
  Angles diagonal(n), off(n), rhs(n);
  double last = 1;
  for (int iteration = 0; iteration < 50; ++iteration) {
    for (std::size_t i = 0; i < n; ++i) {
      const double beyond = 1 - (static_cast<double>(i) + 0.5) / cells;  // rows of mass 1/n, the last half of it
      const double pull = share * (load.own_weight * beyond + load.tip_load) / cells;
      diagonal[i] = pull * std::sin(angle[i]);
      rhs[i] = pull * std::cos(angle[i]);
    }
    for (std::size_t i = 0; i < n; ++i) {
      const double stiffness = (i == 0 ? clamp : 1) * cells, turn = angle[i] - (i == 0 ? 0 : angle[i - 1]);
      const double moment = stiffness * (hinge ? turn : std::sin(turn)),
                   rigidity = stiffness * (hinge ? 1 : std::cos(turn));
      if (!(rigidity > 0)) return std::nullopt;
      rhs[i] -= moment;
      diagonal[i] += rigidity;
      if (i == 0) continue;
      rhs[i - 1] += moment;
      diagonal[i - 1] += rigidity;
      off[i - 1] = -rigidity;
    }
    solve_tridiagonal(diagonal, off, rhs);
    double size = 0;
    for (std::size_t i = 0; i < n; ++i) {
      angle[i] += rhs[i];
      size = std::abs(rhs[i]) <= size ? size : std::abs(rhs[i]);
    }
    if (!(size < 0.5)) return std::nullopt;
    if (size < 1e-15 || (size < 1e-11 && size >= 0.5 * last)) return angle;
    last = size;
  }
  return std::nullopt;
}

}  // namespace

DiscreteElastica::DiscreteElastica(const DiscreteElasticaLoad& load) {
  within(load.own_weight, 0, 1e4, "own_weight");
  within(load.tip_load, 0, 1e4, "tip_load");
  angle_.assign(static_cast<std::size_t>(at_least(load.links, 1, "links")), 0.0);
  double share = 0, step = std::min(1.0, 2 / std::max(load.own_weight + load.tip_load, 1e-300));
  while (share < 1) {
    const double next = std::min(1.0, share + step);
    if (auto solution = newton(load, angle_, next)) {
      angle_ = std::move(*solution);
      share = next;
      step *= 1.5;
    } else if ((step *= 0.5) < 1e-9) {
      throw Error("discrete elastica: Newton's method failed at " + std::to_string(share) + " of the load");
    }
  }
}

std::vector<std::array<double, 2>> DiscreteElastica::nodes() const {
  std::vector<std::array<double, 2>> nodes{{0, 0}};
  const double cell = 1.0 / static_cast<double>(angle_.size());
  for (const double angle : angle_)
    nodes.push_back({nodes.back()[0] + cell * std::cos(angle), nodes.back()[1] + cell * std::sin(angle)});
  return nodes;
}

}  // namespace clothbench::truth
