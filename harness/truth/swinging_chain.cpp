#include "truth/swinging_chain.hpp"

#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <numbers>

#include "clothbench/error.hpp"
#include "truth/checks.hpp"
#include "truth/tridiagonal.hpp"

namespace clothbench::truth {
namespace {

// Time in units of sqrt(L/g) and length in units of L, so that tolerances mean the same at any scale. State: angles
// below the horizontal, then their rates.
using State = std::vector<double>;

class ChainMotion {
 public:
  ChainMotion(int links, double end_mass_ratio)
      : n_(static_cast<std::size_t>(links)),
        a_(1.0 / links),
        inverse_mass_(n_, 1),
        diagonal_(n_),
        off_(n_),
        tension_(n_) {
    inverse_mass_.back() = 1 / end_mass_ratio;
  }

  void operator()(const State& state, State& rate, double) {
    const double* angle = state.data();
    const double* speed = angle + n_;
    for (std::size_t j = 0; j < n_; ++j) {
      diagonal_[j] = inverse_mass_[j] + (j > 0 ? inverse_mass_[j - 1] : 0);
      if (j + 1 < n_) off_[j] = -std::cos(angle[j + 1] - angle[j]) * inverse_mass_[j];
      tension_[j] = a_ * speed[j] * speed[j];
    }
    tension_[0] += std::sin(angle[0]);
    solve_tridiagonal(diagonal_, off_, tension_);
    for (std::size_t j = 0; j < n_; ++j) {
      double push =
          j == 0 ? std::cos(angle[0]) : tension_[j - 1] * std::sin(angle[j - 1] - angle[j]) * inverse_mass_[j - 1];
      if (j + 1 < n_) push += tension_[j + 1] * std::sin(angle[j + 1] - angle[j]) * inverse_mass_[j];
      rate[j] = speed[j];
      rate[n_ + j] = push / a_;
    }
  }

 private:
  std::size_t n_;
  double a_;
  std::vector<double> inverse_mass_, diagonal_, off_, tension_;
};

ChainState nodes_of(const SwingingChain& c, const State& state, double time_s) {
  const auto n = static_cast<std::size_t>(c.links);
  const double a = c.length_m / c.links, per_second = std::sqrt(c.gravity_m_per_s2 / c.length_m);
  ChainState out{time_s, State(n + 1), State(n + 1), State(n + 1), State(n + 1)};
  for (std::size_t j = 0; j < n; ++j) {
    const double cosine = a * std::cos(state[j]), sine = a * std::sin(state[j]), w = state[n + j] * per_second;
    out.x_m[j + 1] = out.x_m[j] + cosine;
    out.z_m[j + 1] = out.z_m[j] - sine;
    out.x_speed_m_per_s[j + 1] = out.x_speed_m_per_s[j] - w * sine;
    out.z_speed_m_per_s[j + 1] = out.z_speed_m_per_s[j] - w * cosine;
  }
  return out;
}

void check(const SwingingChain& c) {
  at_least(c.links, 1, "links");
  positive(c.length_m, "length_m");
  positive(c.gravity_m_per_s2, "gravity_m_per_s2");
  positive(c.end_mass_ratio, "end_mass_ratio");
  within(c.start_angle_rad, -std::numbers::pi / 2, std::numbers::pi / 2, "start_angle_rad");
}

std::array<double, 2> along(const std::vector<double>& x, const std::vector<double>& z, double share) {
  if (x.size() < 2 || z.size() != x.size()) throw Error("argument state: expected 2 nodes or more");
  const double links = static_cast<double>(x.size() - 1), at = within(share, 0, 1, "share") * links;
  const double before = std::min(std::floor(at), links - 1), rest = at - before;
  const auto i = static_cast<std::size_t>(before);
  return {x[i] + rest * (x[i + 1] - x[i]), z[i] + rest * (z[i + 1] - z[i])};
}

}  // namespace

std::vector<ChainState> swing(const SwingingChain& c, std::span<const double> times_s, double tolerance) {
  namespace odeint = boost::numeric::odeint;
  check(c);
  between(tolerance, 0, 1, "tolerance");
  const double per_second = std::sqrt(c.gravity_m_per_s2 / c.length_m);
  std::vector<double> times{0};
  for (const double t : times_s) {
    times.push_back(non_negative(t, "times_s") * per_second);
    if (!(times.back() >= times[times.size() - 2])) throw Error("argument times_s: expected ascending times");
  }
  const auto n = static_cast<std::size_t>(c.links);
  State state(2 * n, 0);
  std::fill_n(state.begin(), n, c.start_angle_rad);
  std::vector<ChainState> out;
  ChainMotion motion(c.links, c.end_mass_ratio);
  const auto stepper = odeint::make_controlled(tolerance, tolerance, odeint::runge_kutta_fehlberg78<State>());
  try {
    // Leg by leg: Odeint's own list of times must not hold one twice.
    for (std::size_t i = 1; i < times.size(); ++i) {
      if (times[i] > times[i - 1])
        odeint::integrate_adaptive(stepper, std::ref(motion), state, times[i - 1], times[i],
                                   std::min(1e-3, times[i] - times[i - 1]));
      out.push_back(nodes_of(c, state, times_s[i - 1]));
    }
  } catch (const odeint::odeint_error& e) {
    throw Error(std::string("swinging chain: the integrator made no progress at this tolerance: ") + e.what());
  }
  return out;
}

std::array<double, 2> chain_position_m(const ChainState& s, double share) { return along(s.x_m, s.z_m, share); }

}  // namespace clothbench::truth
