#include "truth/pull_chain.hpp"

#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <string>

#include "clothbench/error.hpp"
#include "truth/checks.hpp"

namespace clothbench::truth {
namespace {

// Time in units of a/c, so that tolerances mean the same for any strip. State: displacements of the inner nodes, then
// their speeds.
using State = std::vector<double>;

/// Straight motion of an end between two times.
struct Leg {
  double from_m, to_m;
  double at(double share) const { return from_m + share * (to_m - from_m); }
};

struct Motion {
  std::size_t inner;
  Leg first, last;
  double begin, duration;

  void operator()(const State& state, State& rate, double time) const {
    const double share = (time - begin) / duration, a = first.at(share), b = last.at(share);
    for (std::size_t i = 0; i < inner; ++i) {
      const double before = i == 0 ? a : state[i - 1], after = i + 1 == inner ? b : state[i + 1];
      rate[i] = state[inner + i];
      rate[inner + i] = before - 2 * state[i] + after;
    }
  }
};

}  // namespace

std::vector<PulledState> pull(const PulledChain& c, std::span<const double> times_s, std::span<const double> first_m,
                              std::span<const double> last_m, double tolerance) {
  namespace odeint = boost::numeric::odeint;
  const auto n = static_cast<std::size_t>(at_least(c.links, 2, "links"));
  const double cell = positive(c.length_m, "length_m") / c.links;
  const double speed = std::sqrt(positive(c.membrane_stiffness_N_per_m, "membrane_stiffness_N_per_m") /
                                 positive(c.areal_density_kg_per_m2, "areal_density_kg_per_m2"));
  between(tolerance, 0, 1, "tolerance");
  if (times_s.empty() || times_s[0] != 0 || first_m.size() != times_s.size() || last_m.size() != times_s.size())
    throw Error("argument times_s: expected to begin at 0, with a place of either end for each");
  const double per_second = speed / cell;
  State state(2 * (n - 1), 0);
  std::vector<PulledState> out;
  const auto stepper =
      odeint::make_controlled(tolerance * c.length_m, tolerance, odeint::runge_kutta_fehlberg78<State>());
  for (std::size_t k = 0; k < times_s.size(); ++k) {
    PulledState now{times_s[k], State(n + 1, 0), State(n + 1, 0)};
    if (k > 0) {
      const double duration = positive(times_s[k] - times_s[k - 1], "times_s (ascending)");
      const Motion motion{n - 1, {first_m[k - 1], first_m[k]}, {last_m[k - 1], last_m[k]}, 0, duration * per_second};
      try {
        odeint::integrate_adaptive(stepper, motion, state, 0.0, motion.duration, std::min(1e-2, motion.duration));
      } catch (const odeint::odeint_error& e) {
        throw Error(std::string("pulled chain: the integrator made no progress at this tolerance: ") + e.what());
      }
      now.speed_m_per_s.front() = (first_m[k] - first_m[k - 1]) / duration;
      now.speed_m_per_s.back() = (last_m[k] - last_m[k - 1]) / duration;
    }
    now.displacement_m.front() = first_m[k];
    now.displacement_m.back() = last_m[k];
    for (std::size_t i = 1; i < n; ++i) {
      now.displacement_m[i] = state[i - 1];
      now.speed_m_per_s[i] = state[n - 1 + i - 1] * per_second;
    }
    out.push_back(std::move(now));
  }
  return out;
}

}  // namespace clothbench::truth
