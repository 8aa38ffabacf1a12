#include "truth/spring_sheet.hpp"

#include <algorithm>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <string>

#include "clothbench/error.hpp"
#include "truth/checks.hpp"

namespace clothbench::truth {
namespace {

// Time in units of a cell over the wave's speed. State: positions of all vertices, then their speeds.
using State = std::vector<double>;

struct SheetSpring {
  std::size_t a, b;
  double stiffness, rest_m;
};

// Written anew, apart from the springs of the solvers that it judges.
double along(double Y, double a, double b) { return Y * std::max(9.0 / 8 * b / a - 3.0 / 8 * a / b, 0.1 * b / a); }

std::vector<SheetSpring> springs_of(const SpringSheet& s) {
  const double Y = positive(s.membrane_stiffness_N_per_m, "membrane_stiffness_N_per_m");
  const double a = s.width_m / (s.columns - 1), b = s.height_m / (s.rows - 1);
  const double diagonal = 3.0 / 16 * Y * (a * a + b * b) / (a * b), across = std::hypot(a, b);
  const auto at = [&](int i, int j) {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(s.columns) + static_cast<std::size_t>(i);
  };
  std::vector<SheetSpring> out;
  for (int j = 0; j < s.rows; ++j)
    for (int i = 0; i < s.columns; ++i) {
      const bool right = i + 1 < s.columns, below = j + 1 < s.rows;
      const double row = j == 0 || !below ? 0.5 : 1, column = i == 0 || !right ? 0.5 : 1;
      if (right) out.push_back({at(i, j), at(i + 1, j), row * along(Y, a, b), a});
      if (below) out.push_back({at(i, j), at(i, j + 1), column * along(Y, b, a), b});
      if (!right || !below) continue;
      out.push_back({at(i, j), at(i + 1, j + 1), diagonal, across});
      out.push_back({at(i + 1, j), at(i, j + 1), diagonal, across});
    }
  return out;
}

/// Reciprocal masses, 0 of held vertices [1/kg].
std::vector<double> inverse_masses(const SpringSheet& s) {
  const double cell = positive(s.areal_density_kg_per_m2, "areal_density_kg_per_m2") * s.width_m / (s.columns - 1) *
                      s.height_m / (s.rows - 1);
  std::vector<double> out;
  for (int j = 0; j < s.rows; ++j)
    for (int i = 0; i < s.columns; ++i) {
      const bool end = i == 0 || i + 1 == s.columns, border = j == 0 || j + 1 == s.rows;
      out.push_back(1 / (cell * (end ? 0.5 : 1) * (border ? 0.5 : 1)));
    }
  for (const std::uint32_t v : s.held) {
    if (v >= out.size()) throw Error("argument held: expected vertices of the sheet");
    out[v] = 0;
  }
  return out;
}

struct SheetMotion {
  const SpringSheet& sheet;
  const std::vector<SheetSpring> springs;
  const std::vector<double> inverse_mass;
  double unit_s;  ///< of time

  void operator()(const State& state, State& rate, double) const {
    const std::size_t n = inverse_mass.size(), speeds = 3 * n;
    std::copy(state.begin() + static_cast<std::ptrdiff_t>(speeds), state.end(), rate.begin());
    std::fill(rate.begin() + static_cast<std::ptrdiff_t>(speeds), rate.end(), 0.0);
    for (const SheetSpring& s : springs) {
      double d[3], square = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        d[k] = state[3 * s.b + k] - state[3 * s.a + k];
        square += d[k] * d[k];
      }
      const double pull = s.stiffness * (1 - s.rest_m / std::sqrt(square));
      for (std::size_t k = 0; k < 3; ++k) {
        rate[speeds + 3 * s.a + k] += pull * d[k];
        rate[speeds + 3 * s.b + k] -= pull * d[k];
      }
    }
    for (std::size_t v = 0; v < n; ++v)
      for (std::size_t k = 0; k < 3; ++k) {
        double& of = rate[speeds + 3 * v + k];
        of = inverse_mass[v] == 0 ? 0 : unit_s * unit_s * (of * inverse_mass[v] + sheet.gravity_m_per_s2[k]);
      }
  }
};

}  // namespace

std::vector<std::vector<double>> move_sheet(const SpringSheet& s, std::span<const double> start_m,
                                            std::span<const double> times_s, const HeldPosition& held,
                                            double tolerance) {
  namespace odeint = boost::numeric::odeint;
  at_least(s.columns, 2, "columns");
  at_least(s.rows, 2, "rows");
  const double cell =
      std::min(positive(s.width_m, "width_m") / (s.columns - 1), positive(s.height_m, "height_m") / (s.rows - 1));
  between(tolerance, 0, 1, "tolerance");
  const SheetMotion motion{s, springs_of(s), inverse_masses(s),
                           cell / std::sqrt(s.membrane_stiffness_N_per_m / s.areal_density_kg_per_m2)};
  const std::size_t speeds = 3 * motion.inverse_mass.size();
  if (start_m.size() != speeds) throw Error("argument start_m: expected 3 for each vertex");
  if (times_s.empty() || times_s[0] != 0) throw Error("argument times_s: expected to begin at 0");
  State state(start_m.begin(), start_m.end());
  state.resize(2 * speeds, 0);
  std::vector<std::vector<double>> out = {{start_m.begin(), start_m.end()}};
  const auto stepper = odeint::make_controlled(tolerance * std::max(s.width_m, s.height_m), tolerance,
                                               odeint::runge_kutta_fehlberg78<State>());
  const auto hold = [&](std::size_t time, double per_unit) {
    for (std::size_t v = 0; v < s.held.size(); ++v) {
      const auto from = held(v, time), to = per_unit > 0 ? held(v, time + 1) : from;
      for (std::size_t k = 0; k < 3; ++k) {
        state[3 * s.held[v] + k] = from[k];
        state[speeds + 3 * s.held[v] + k] = (to[k] - from[k]) * per_unit;
      }
    }
  };
  for (std::size_t f = 1; f < times_s.size(); ++f) {
    const double duration = positive(times_s[f] - times_s[f - 1], "times_s (ascending)") / motion.unit_s;
    hold(f - 1, 1 / duration);
    try {
      odeint::integrate_adaptive(stepper, std::cref(motion), state, 0.0, duration, std::min(0.1, duration));
    } catch (const odeint::odeint_error& e) {
      throw Error(std::string("sheet of springs: the integrator made no progress at this tolerance: ") + e.what());
    }
    hold(f, 0);
    out.emplace_back(state.begin(), state.begin() + static_cast<std::ptrdiff_t>(speeds));
  }
  return out;
}

}  // namespace clothbench::truth
