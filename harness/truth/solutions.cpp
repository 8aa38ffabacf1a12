#include "truth/solutions.hpp"

#include <algorithm>
#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "clothbench/error.hpp"

namespace clothbench::truth {
namespace {

using std::numbers::pi;
using State = std::vector<double>;

/// Integrates from `begin` to `end`, with errors per step below `absolute` and below `relative` times the value.
template <class Values, class Rate>
void integrate(const char* what, Rate rate, Values& state, double begin, double end, double first_step, double absolute,
               double relative) {
  namespace odeint = boost::numeric::odeint;
  try {
    odeint::integrate_adaptive(odeint::make_controlled(absolute, relative, odeint::runge_kutta_fehlberg78<Values>()),
                               rate, state, begin, end, first_step);
  } catch (const odeint::odeint_error& e) {
    throw Error(std::string(what) + ": the integrator made no progress at this tolerance: " + e.what());
  }
}

/// Solves a symmetric positive definite tridiagonal system in place (elimination without pivoting or allocation).
/// `off[i]` couples i and i + 1. `diagonal` is overwritten; `rhs` becomes the solution.
void solve_tridiagonal(std::span<double> diagonal, std::span<const double> off, std::span<double> rhs) {
  const std::size_t n = diagonal.size();
  for (std::size_t i = 1; i < n; ++i) {
    const double factor = off[i - 1] / diagonal[i - 1];
    diagonal[i] -= factor * off[i - 1];
    rhs[i] -= factor * rhs[i - 1];
  }
  for (std::size_t i = n; i-- > 0;) rhs[i] = (rhs[i] - (i + 1 < n ? off[i] * rhs[i + 1] : 0)) / diagonal[i];
}

double p1(double x) { return x == 0 ? 1 : -std::expm1(-x) / x; }

double p2(double x) {
  if (x > 1) return (x + std::expm1(-x)) / (x * x);
  // Series sum of (-x)^k / (k + 2)!, because the closed form loses all digits near 0.
  double term = 0.5, sum = 0;
  for (int k = 0; k < 20; ++k) {
    sum += term;
    term *= -x / (k + 3);
  }
  return sum;
}

double rate_of(const Pendulum& p) { return std::sqrt(p.gravity_m_per_s2 / p.length_m); }

// Units are sqrt(L/g) and L, so that tolerances fit any scale. State: angles below the horizontal, then their rates.
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

Nodes nodes_of(const SwingingChain& c, const State& state) {
  const auto n = static_cast<std::size_t>(c.links);
  const double a = c.length_m / c.links;
  Nodes out(n + 1);
  for (std::size_t j = 0; j < n; ++j)
    out[j + 1] = {out[j][0] + a * std::cos(state[j]), out[j][1] - a * std::sin(state[j])};
  return out;
}

/// Link angles at a fraction of the load, if Newton's method converges from the guess. Energy over B/L: n times the sum
/// of (1 - cos(turn)) minus the sum of pull_i sin(angle_i)/n.
std::optional<State> bent(double own_weight, State angle, double share) {
  const std::size_t n = angle.size();
  const auto cells = static_cast<double>(n);
  State diagonal(n), off(n), rhs(n);
  double last = 1;
  for (int iteration = 0; iteration < 50; ++iteration) {
    for (std::size_t i = 0; i < n; ++i) {
      const double beyond = 1 - (static_cast<double>(i) + 0.5) / cells;  // rows of mass 1/n; the last row has half
      const double pull = share * (own_weight * beyond) / cells;
      diagonal[i] = pull * std::sin(angle[i]);
      rhs[i] = pull * std::cos(angle[i]);
    }
    for (std::size_t i = 0; i < n; ++i) {
      const double stiffness = (i == 0 ? 2 : 1) * cells, turn = angle[i] - (i == 0 ? 0 : angle[i - 1]);
      const double moment = stiffness * std::sin(turn), rigidity = stiffness * std::cos(turn);
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

std::array<double, 2> node_position(const Nodes& nodes, double share) {
  const double links = static_cast<double>(nodes.size() - 1), at = share * links;
  const double before = std::min(std::floor(at), links - 1), rest = at - before;
  const auto &a = nodes[static_cast<std::size_t>(before)], &b = nodes[static_cast<std::size_t>(before) + 1];
  return {a[0] + rest * (b[0] - a[0]), a[1] + rest * (b[1] - a[1])};
}

double fall_height_m(const FreeFall& f, double t) {
  const double x = f.damping_per_s * t;
  return f.speed_m_per_s * t * p1(x) - f.gravity_m_per_s2 * t * t * p2(x);
}

double pendulum_period_s(const Pendulum& p) {
  return 4 * boost::math::ellint_1(std::sin(p.amplitude_rad / 2)) / rate_of(p);
}

double pendulum_angle_rad(const Pendulum& p, double t) {
  const double rate = rate_of(p), k = std::sin(p.amplitude_rad / 2);
  t = std::fmod(t, pendulum_period_s(p));
  return 2 * std::asin(k * boost::math::jacobi_cd(k, rate * t));
}

std::vector<Nodes> swing(const SwingingChain& c, std::span<const double> times_s, double tolerance) {
  const double per_second = std::sqrt(c.gravity_m_per_s2 / c.length_m);
  const auto n = static_cast<std::size_t>(c.links);
  State state(2 * n, 0);
  std::vector<Nodes> out;
  ChainMotion motion(c.links, c.end_mass_ratio);
  double now = 0;
  for (const double t : times_s) {
    const double next = t * per_second;
    if (next > now)
      integrate("swinging chain", std::ref(motion), state, now, next, std::min(1e-3, next - now), tolerance, tolerance);
    out.push_back(nodes_of(c, state));
    now = next;
  }
  return out;
}

double hang_displacement_m(const HeavyStrip& s, double rest) {
  const double weight = s.areal_density_kg_per_m2 * s.gravity_m_per_s2;
  return rest * (weight * (s.length_m - 0.5 * rest) + s.end_load_N_per_m) / s.membrane_stiffness_N_per_m;
}

Nodes cantilever_nodes(int links, double own_weight) {
  State angle(static_cast<std::size_t>(links), 0.0);
  double share = 0, step = std::min(1.0, 2 / std::max(own_weight, 1e-300));
  while (share < 1) {
    const double next = std::min(1.0, share + step);
    if (auto solution = bent(own_weight, angle, next)) {
      angle = std::move(*solution);
      share = next;
      step *= 1.5;
    } else if ((step *= 0.5) < 1e-9) {
      throw Error("cantilever: Newton's method failed at " + std::to_string(share) + " of the load");
    }
  }
  Nodes nodes{{0, 0}};
  const double cell = 1.0 / static_cast<double>(angle.size());
  for (const double a : angle)
    nodes.push_back({nodes.back()[0] + cell * std::cos(a), nodes.back()[1] + cell * std::sin(a)});
  return nodes;
}

std::vector<std::vector<double>> pull(const PulledChain& c, std::span<const double> times_s,
                                      std::span<const double> first_m, std::span<const double> last_m,
                                      double tolerance) {
  const auto n = static_cast<std::size_t>(c.links);
  const double cell = c.length_m / c.links;
  const double speed = std::sqrt(c.membrane_stiffness_N_per_m / c.areal_density_kg_per_m2);
  // Time in units of cell/speed. State: displacements of the inner nodes, then their speeds.
  const double per_second = speed / cell;
  State state(2 * (n - 1), 0);
  std::vector<State> out;
  for (std::size_t k = 0; k < times_s.size(); ++k) {
    State now(n + 1, 0);
    if (k > 0) {
      const double duration = (times_s[k] - times_s[k - 1]) * per_second;
      const auto along = [](std::span<const double> end, std::size_t to, double share) {
        return end[to - 1] + share * (end[to] - end[to - 1]);
      };
      const auto rate = [&](const State& x, State& d, double time) {
        const double share = time / duration, a = along(first_m, k, share), b = along(last_m, k, share);
        for (std::size_t i = 0; i < n - 1; ++i) {
          const double before = i == 0 ? a : x[i - 1], after = i + 1 == n - 1 ? b : x[i + 1];
          d[i] = x[n - 1 + i];
          d[n - 1 + i] = before - 2 * x[i] + after;
        }
      };
      integrate("pulled chain", rate, state, 0.0, duration, std::min(1e-2, duration), tolerance * c.length_m,
                tolerance);
    }
    now.front() = first_m[k];
    now.back() = last_m[k];
    std::copy_n(state.begin(), n - 1, now.begin() + 1);
    out.push_back(std::move(now));
  }
  return out;
}

SlideState slide_down(const Incline& i, double t) {
  const double v = i.speed_m_per_s;
  if (v == 0 && std::tan(i.angle_rad) <= i.friction) return {0, 0};
  const double a = i.gravity_m_per_s2 * (std::sin(i.angle_rad) - i.friction * std::cos(i.angle_rad));
  if (a < 0 && !(t < v / -a)) return {v * v / (2 * -a), 0};
  return {t * (v + 0.5 * a * t), v + a * t};
}

double greatest_overhang_m(const Capstan& c, double light_overhang) {
  const double weight = c.areal_density_kg_per_m2 * c.gravity_m_per_s2, mu = c.friction;
  if (c.turns <= 0) {
    // Particular solution a sin + b cos of the linear equation.
    const double on = weight * c.radius_m, a = on * (1 - mu * mu) / (1 + mu * mu), b = -2 * mu * on / (1 + mu * mu);
    return (std::exp(mu * pi) * (weight * light_overhang - b) + a * std::sin(pi) + b * std::cos(pi)) / weight;
  }
  const double half = pi / (2 * c.turns);
  const double edge = 2 * c.radius_m * std::sin(half), in = std::cos(half) + mu * std::sin(half),
               out = std::cos(half) - mu * std::sin(half);
  double tension = light_overhang;  // divided by rho g
  for (int j = 0; j < c.turns; ++j) {
    const double phi = (2 * j + 1) * half;
    tension = (tension * in + edge * (std::cos(phi) + mu * std::sin(phi))) / out;
  }
  return tension;
}

std::vector<SlideState> slide_over(const Capstan& c, double light_overhang, double heavy_overhang,
                                   std::span<const double> times_s) {
  using Pair = std::array<double, 2>;
  const double mu = c.friction, constant = greatest_overhang_m(c, 0), ratio = greatest_overhang_m(c, 1) - constant,
               smooth = std::exp(mu * pi);
  const double on_cylinder = mu > 0 ? c.radius_m * (smooth - 1) / mu : pi * c.radius_m;
  const auto rate = [&](const Pair& x, Pair& d, double) {
    const double light = light_overhang - x[0], heavy = heavy_overhang + x[0];
    d[0] = x[1];
    d[1] = (c.gravity_m_per_s2 * (heavy - ratio * light - constant) + x[1] * x[1] * (ratio - 1)) /
           (heavy + ratio * light + on_cylinder);
  };
  const bool holds = heavy_overhang <= greatest_overhang_m(c, light_overhang);
  Pair x = {0, 0};
  std::vector<SlideState> out;
  double now = 0;
  for (const double t : times_s) {
    if (!holds && t > now) integrate("capstan", rate, x, now, t, (t - now) / 4, 1e-12, 1e-12);
    if (!(x[0] < light_overhang))
      throw Error("capstan: expected a scene that ends before the light end of the strip reaches the cylinder");
    now = t;
    out.push_back({x[0], x[1]});
  }
  return out;
}

}  // namespace clothbench::truth
