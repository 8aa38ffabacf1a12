// Exact solutions against published numbers, limiting cases, and integrations of the equations in other variables.
#include "truth/solutions.hpp"

#include <gtest/gtest.h>

#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>

#include "clothbench/error.hpp"

namespace clothbench::truth {
namespace {

using std::numbers::pi;
using State = std::vector<double>;
constexpr double kDegree = pi / 180;

/// A table of published numbers: comment lines with its source and "# digits N" (significant), a line of column names,
/// then rows.
class PrintedTable {
 public:
  using Row = std::map<std::string, double>;

  explicit PrintedTable(const std::string& file) {
    std::ifstream in(std::string(CLOTHBENCH_SOURCE_DIR) + "/tests/truth/data/" + file);
    std::vector<std::string> names;
    for (std::string line; std::getline(in, line);) {
      if (line.rfind("# digits ", 0) == 0) digits_ = std::stoi(line.substr(9));
      if (line.empty() || line[0] == '#') continue;
      std::istringstream cells(line);
      Row row;
      std::size_t column = 0;
      for (std::string cell; std::getline(cells, cell, ','); ++column) {
        if (names.size() <= column)
          names.push_back(cell);
        else
          row[names[column]] = std::stod(cell);
      }
      if (!row.empty()) rows.push_back(row);
    }
    EXPECT_FALSE(rows.empty()) << file;
    EXPECT_GT(digits_, 0) << file;
  }

  /// Tolerance: half a unit of the last printed digit, plus the uncertainty of the printed value itself.
  void expect(double computed, double printed, const std::string& what, double uncertainty = 0) const {
    const double half =
        printed == 0 ? 1e-15 : 0.5 * std::pow(10, std::floor(std::log10(std::abs(printed))) - digits_ + 1);
    EXPECT_NEAR(computed, printed, half * (1 + 1e-6) + uncertainty) << what;
  }

  std::vector<Row> rows;

 private:
  int digits_ = 0;
};

std::string text(const PrintedTable::Row& row) {
  std::ostringstream out;
  for (const auto& [name, value] : row) out << name << '=' << value << ' ';
  return out.str();
}

/// Integrates y' = f(y, dy, t) from `y` at 0 to `end`.
template <class F>
State integrated(State y, double end, F f) {
  namespace odeint = boost::numeric::odeint;
  odeint::integrate_adaptive(odeint::make_controlled(1e-13, 1e-13, odeint::runge_kutta_fehlberg78<State>()), f, y, 0.0,
                             end, end / 100);
  return y;
}

TEST(FreeFall, SolvesItsEquation) {
  const FreeFall undamped{3, 9.81, 0};
  EXPECT_DOUBLE_EQ(fall_height_m(undamped, 0.5), 1.5 - 9.81 / 8);
  for (const double c : {1e-9, 1e-3, 0.1, 1.0, 1.999999, 2.000001, 30.0}) {
    const FreeFall f{3, 9.81, c};
    const auto y = integrated({0, 3}, 0.5, [&](const State& s, State& d, double) { d = {s[1], -9.81 - c * s[1]}; });
    EXPECT_NEAR(fall_height_m(f, 0.5), y[0], 1e-12) << c;
  }
}

TEST(Pendulum, HasThePublishedPeriodsAndSolvesItsEquation) {
  const PrintedTable table("pendulum.csv");
  for (const auto& row : table.rows)
    table.expect(pendulum_period_s({1, 9.81, row.at("amplitude_deg") * kDegree}), row.at("period_1m_s"), text(row));
  for (const double degrees : {1.0, 60.0, 135.0, 179.0}) {
    const Pendulum p{0.4, 3.7, degrees * kDegree};
    for (const double periods : {0.13, 0.5, 0.77, 1.9}) {
      const double t = periods * pendulum_period_s(p);
      const auto y = integrated({p.amplitude_rad, 0}, t, [](const State& s, State& d, double) {
        d = {s[1], -3.7 / 0.4 * std::sin(s[0])};
      });
      EXPECT_NEAR(pendulum_angle_rad(p, t), y[0], 1e-8) << degrees << ' ' << periods;
    }
  }
}

TEST(SwingingChain, HasThePublishedMotion) {
  const PrintedTable table("swinging_chain.csv");
  std::map<std::pair<int, double>, std::vector<PrintedTable::Row>> cases;
  for (const auto& row : table.rows)
    cases[{static_cast<int>(row.at("links")), row.at("end_mass_ratio")}].push_back(row);
  for (const auto& [key, rows] : cases) {
    const SwingingChain chain{key.first, 1, 9.81, key.second};
    State times;
    for (const auto& row : rows) times.push_back(row.at("time_s"));
    const auto states = swing(chain, times);
    ASSERT_EQ(states.size(), rows.size());
    const auto tip = static_cast<std::size_t>(key.first), middle = (tip + 1) / 2;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      // The published run's own error, plus ours, which grows by the chaos that begins after 0.5 s.
      const double own = 3 * rows[i].at("uncertainty") + 1e-12;
      const auto &x = states[i][tip], &m = states[i][middle];
      table.expect(x[0], rows[i].at("x_tip"), text(rows[i]), own);
      table.expect(x[1], rows[i].at("z_tip"), text(rows[i]), own);
      table.expect(m[0], rows[i].at("x_mid"), text(rows[i]), own);
      table.expect(m[1], rows[i].at("z_mid"), text(rows[i]), own);
    }
  }
}

TEST(SwingingChain, OneLinkIsAPendulum) {
  const State times{0.2, 0.9, 3};
  const auto states = swing({1, 0.4, 3, 0.5}, times);
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double angle = pendulum_angle_rad({0.4, 3, pi / 2}, times[i]);
    EXPECT_NEAR(states[i][1][0], 0.4 * std::sin(angle), 1e-11);
    EXPECT_NEAR(states[i][1][1], -0.4 * std::cos(angle), 1e-11);
  }
  const Nodes nodes{{0, 0}, {1, -2}, {3, -2}};
  EXPECT_EQ(node_position(nodes, 0.25), (std::array<double, 2>{0.5, -1}));
  EXPECT_EQ(node_position(nodes, 1), (std::array<double, 2>{3, -2}));
}

TEST(HeavyStrip, HasThePublishedStretchAlsoInRows) {
  const PrintedTable table("heavy_stretch.csv");
  for (const auto& row : table.rows) {
    const HeavyStrip s{2, 0.25, 0.25 * 4 * 2 / row.at("eps"), 4, 0};
    // At small strains the table differs by 5e-14 from the series eps/2.
    table.expect(hang_displacement_m(s, 2) / 2, row.at("engineering"), text(row), 1e-13);
  }
  const HeavyStrip loaded{1.5, 0.3, 200, 9.81, 7};
  for (const double at : {0.2, 0.9, 1.4}) {
    const double h = 1e-5,
                 slope = (hang_displacement_m(loaded, at + h) - hang_displacement_m(loaded, at - h)) / (2 * h);
    EXPECT_NEAR(slope, (0.3 * 9.81 * (1.5 - at) + 7) / 200, 1e-8) << "the strain carries the weight below";
  }
  for (const int n : {1, 7, 32}) {
    double moved = 0;  // each spring carries half of its own cell and everything below
    for (int row = 1; row <= n; ++row) {
      moved += 1.5 / n * (0.3 * 9.81 * 1.5 / n * (n - row + 0.5) + 7) / 200;
      EXPECT_NEAR(moved, hang_displacement_m(loaded, 1.5 * row / n), 1e-14);
    }
  }
}

/// Euler's elastica by shooting over the tip angle: from the tip inwards theta'' = -Gamma s cos(theta).
std::array<double, 2> elastica_tip(double gamma) {
  const auto shot = [&](double tip_angle) {
    return integrated({tip_angle, 0, 0, 0}, 1, [&](const State& y, State& d, double s) {
      d = {y[1], -gamma * s * std::cos(y[0]), std::cos(y[0]), std::sin(y[0])};
    });
  };
  double low = 0, high = pi / 2;
  for (int k = 0; k < 60; ++k) (shot((low + high) / 2)[0] > 0 ? high : low) = (low + high) / 2;
  const State y = shot(low);
  return {y[2], y[3]};
}

TEST(Cantilever, IsTheElasticaWithOrderTwo) {
  const PrintedTable table("elastica.csv");
  for (const auto& row : table.rows) {
    const double gamma = row.at("Gamma");
    if (gamma > 100) continue;  // a boundary layer of a few links
    const auto error = [&](int links) {
      const auto tip = cantilever_nodes(links, gamma).back();
      return std::hypot(tip[0] - row.at("x_tip"), tip[1] - row.at("y_tip"));
    };
    EXPECT_LT(error(2048), gamma <= 10 ? 3e-7 : 1e-6) << text(row);
    if (gamma >= 1) {
      EXPECT_NEAR(std::log2(error(64) / error(128)), 2, 0.1) << text(row);
    }
  }
  const auto shot = elastica_tip(30), tip = cantilever_nodes(2048, 30).back();
  EXPECT_NEAR(tip[0], shot[0], 1e-6);
  EXPECT_NEAR(tip[1], shot[1], 1e-6);
  // One link of a clamp: 2 tan(theta) = Gamma/2.
  const auto one = cantilever_nodes(1, 4).back();
  EXPECT_NEAR(one[1] / one[0], 1, 1e-13);
}

TEST(PullWave, SolvesTheWaveEquationWithItsEnds) {
  // Published plateaus of the default scene: 14 % at the grips, twice that in the middle.
  const double c = std::sqrt(5000.0), ramp = 1 / c, h = 1e-6;
  const PullWave scene{1, c, 10, ramp};
  const auto strain = [&](double x, double t) {
    return (scene.displacement_m(x + h, t) - scene.displacement_m(x - h, t)) / (2 * h);
  };
  EXPECT_NEAR(strain(0.5 - h, ramp), 0.1414, 5e-5);
  EXPECT_NEAR(strain(0, ramp + 0.5 / c), 0.2828, 5e-5);
  EXPECT_EQ(strain(0, 0.49 / c), 0);
  for (const double ramp_s : {0.015, 0.04}) {
    const PullWave wave{0.8, 20, 2, ramp_s};
    for (const double t : {0.013, 0.0471, 0.09, 0.2}) {
      for (const double x : {-0.31, 0.0, 0.22}) {
        const double dx = 2e-5, dt = 1e-6;
        const auto u = [&](double by_x, double by_t) { return wave.displacement_m(x + by_x, t + by_t); };
        EXPECT_NEAR((u(0, dt) - 2 * u(0, 0) + u(0, -dt)) / (dt * dt),
                    400 * (u(dx, 0) - 2 * u(0, 0) + u(-dx, 0)) / (dx * dx), 0.1)
            << t << ' ' << x;
      }
      EXPECT_NEAR(wave.displacement_m(0.4, t), wave.hand_displacement_m(t), 1e-14);
      EXPECT_NEAR(wave.displacement_m(-0.4, t), -wave.hand_displacement_m(t), 1e-14);
    }
  }
}

TEST(PulledChain, FollowsTheWaveOfTwoHands) {
  const PullWave wave{1, 1, 0.1, 1};
  State times, first, last;
  for (int k = 0; k <= 800; ++k) {
    times.push_back(k * 0.0025);
    last.push_back(wave.hand_displacement_m(times.back()));
    first.push_back(-last.back());
  }
  double largest[3] = {};
  for (int level = 0; level < 3; ++level) {
    const int links = 32 << level;
    const auto states = pull({links, 1, 0.4, 0.4}, times, first, last);
    for (int i = 0; i <= links; ++i) {
      const double x = static_cast<double>(i) / links - 0.5, moved = states.back()[static_cast<std::size_t>(i)];
      largest[level] = std::max(largest[level], std::abs(moved - wave.displacement_m(x, 2)) / last.back());
    }
  }
  EXPECT_LT(largest[0], 0.01);
  EXPECT_LT(largest[1], 0.5 * largest[0]);
  EXPECT_LT(largest[2], 0.5 * largest[1]);
}

TEST(Incline, HasThePublishedStops) {
  const PrintedTable table("incline.csv");
  for (const auto& row : table.rows) {
    const double angle = row.at("angle_deg") * kDegree, friction = row.at("friction"), stop_s = row.at("stop_time");
    table.expect(2 * slide_down({angle, friction, 0, 9.81}, 1).distance_m, row.at("acceleration"), text(row));
    const Incline thrown{angle, friction, 1, 9.81};
    if (std::isinf(stop_s)) {
      EXPECT_GT(slide_down(thrown, 100).speed_m_per_s, 0) << text(row);
      continue;
    }
    table.expect(slide_down(thrown, 2 * stop_s).distance_m, row.at("stop_distance"), text(row));
    EXPECT_EQ(slide_down(thrown, stop_s * (1 + 1e-7)).speed_m_per_s, 0) << text(row);
    EXPECT_NEAR(slide_down(thrown, stop_s / 2).speed_m_per_s, 0.5, 1e-7) << text(row);
    table.expect(slide_down(thrown, stop_s * (1 - 1e-7)).distance_m, row.at("stop_distance"), text(row));
  }
  EXPECT_EQ(slide_down({16.6991 * kDegree, 0.3, 0, 9.81}, 1).distance_m, 0);
  EXPECT_GT(slide_down({16.6993 * kDegree, 0.3, 0, 9.81}, 1).distance_m, 0);
}

/// Weightless, with contact at rows only: [(1 + mu tan(d/2)) / (1 - mu tan(d/2))]^m, d = pi/m.
double weightless_ratio(double friction, int turns) {
  return std::exp(turns * 2 * std::atanh(friction * std::tan(pi / (2 * turns))));
}

TEST(Capstan, HasThePublishedRatiosAndOverhangs) {
  const PrintedTable ratios("capstan.csv"), overhangs("heavy_capstan.csv");
  int half_turns = 0;
  for (const auto& row : ratios.rows) {
    if (std::abs(row.at("wrap_rad") - pi) > 1e-6) continue;
    ++half_turns;
    ratios.expect(greatest_overhang_m({row.at("friction"), 0, 0.2, 9.81, 0}, 1), row.at("ratio"), text(row));
  }
  EXPECT_GT(half_turns, 0);
  for (const auto& row : overhangs.rows)
    overhangs.expect(greatest_overhang_m({row.at("friction"), row.at("radius"), 0.37, 3.1, 0}, row.at("light")),
                     row.at("heavy"), text(row));
  const auto off = [](int m) { return greatest_overhang_m({0.3, 0.05, 0.2, 9.81, m}, 0.2); };
  EXPECT_NEAR(std::log2((off(32) - off(0)) / (off(64) - off(0))), 2, 0.05);
  EXPECT_LT(std::abs(off(2000) - off(0)), 1e-6);
  EXPECT_NEAR(greatest_overhang_m({0.3, 0.05, 0.2, 9.81, 10}, 1e9) / 1e9, weightless_ratio(0.3, 10), 1e-8);
  EXPECT_NEAR(weightless_ratio(0.3, 10) / std::exp(0.3 * pi) - 1, 0.0086, 5e-5);
  EXPECT_NEAR(greatest_overhang_m({0, 0.05, 0.2, 9.81, 7}, 0.2), 0.2, 1e-15)
      << "without friction equal overhangs balance";
}

TEST(Capstan, SlidesByTheBalanceOfItsElements) {
  const State times{0, 0.1, 0.2, 0.3};
  // Without friction it is an Atwood machine: L s'' = 2 g s, so s = s0 cosh(sqrt(2g/L) t).
  const auto atwood = slide_over({0, 0.05, 0.2, 9.81, 0}, 0.3, 0.5, times);
  const double k = std::sqrt(2 * 9.81 / (0.8 + 0.05 * pi));
  for (std::size_t f = 0; f < times.size(); ++f) {
    EXPECT_NEAR(atwood[f].distance_m, 0.1 * std::cosh(k * times[f]) - 0.1, 1e-10);
    EXPECT_NEAR(atwood[f].speed_m_per_s, 0.1 * k * std::sinh(k * times[f]), 1e-9);
  }
  // With friction: tension divided by rho along the cylinder, from the light side, at the initial acceleration.
  const double mu = 0.3, R = 0.05, g = 9.81, light = 0.2, heavy = 0.7, t = 1e-4;
  const double a = 2 * slide_over({mu, R, 0.2, g, 0}, light, heavy, State{0, t}).back().distance_m / (t * t);
  const State tension = integrated({light * (g + a)}, pi, [&](const State& y, State& d, double phi) {
    d[0] = mu * (y[0] + g * R * std::sin(phi)) + g * R * std::cos(phi) + R * a;
  });
  EXPECT_GT(a, 0);
  EXPECT_NEAR(tension[0], heavy * (g - a), 1e-5);
  for (const int turns : {0, 12}) {
    const Capstan rough{0.3, 0.05, 0.2, 9.81, turns};
    const double most = greatest_overhang_m(rough, 0.2);
    EXPECT_EQ(slide_over(rough, 0.2, 0.999 * most, times).back().distance_m, 0);
    const double slow = slide_over(rough, 0.2, 1.001 * most, times).back().distance_m;
    EXPECT_TRUE(slow > 0 && slow < 1e-3) << slow;
  }
  EXPECT_THROW(slide_over({}, 0.2, 5, State{0, 0.5}), Error) << "the light end has left the cylinder";
}

}  // namespace
}  // namespace clothbench::truth
