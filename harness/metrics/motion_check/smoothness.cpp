// Displacements that no impact causes: a spike of one vertex in one frame, a repeated frame, frozen vertices.
#include <algorithm>
#include <cmath>

#include "metrics/motion_check/motion.hpp"

namespace clothbench::motion_check {
namespace {

using Field = std::vector<V3>;

class Smoothness {
 public:
  Smoothness(const Motion& m, const Bodies& b, Findings& f)
      : m_(m), bodies_(b), found_(f), degree_(m.vertices, 0), near_(m.vertices) {
    std::vector<std::vector<std::uint32_t>> beside(m.vertices);
    for (const Edge& e : m.edges)
      ++degree_[e.a], ++degree_[e.b], beside[e.a].push_back(e.b), beside[e.b].push_back(e.a);
    for (std::uint32_t v = 0; v < m.vertices; ++v)
      for (const std::uint32_t a : beside[v])
        for (const std::uint32_t w : beside[a])
          if (w != v && std::find(beside[v].begin(), beside[v].end(), w) == beside[v].end()) near_[v].push_back(w);
  }

  void run() {
    freeze();
    stuck();
    if (!m_.scene.time.ends_s.empty() || m_.frames < 9 || m_.vertices <= 20) return;
    found_.define("spike");
    std::vector<Field> around;
    for (std::size_t k = 2; k + 2 < m_.frames; ++k) {
      around.push_back(high_pass(k));
      if (around.size() > 5) around.erase(around.begin());
      if (around.size() == 5) spike(k - 2, around);
    }
  }

 private:
  /// Fourth difference in time, divided by 6 to keep the height of a one-frame spike, minus its mean over neighbours.
  Field high_pass(std::size_t k) const {
    Field f(m_.vertices), sum(m_.vertices, V3::Zero());
    for (std::size_t v = 0; v < m_.vertices; ++v)
      f[v] = (m_.at(k - 2, v) - 4 * m_.at(k - 1, v) + 6 * m_.at(k, v) - 4 * m_.at(k + 1, v) + m_.at(k + 2, v)) / 6;
    for (const Edge& e : m_.edges) sum[e.a] += f[e.b], sum[e.b] += f[e.a];
    const std::vector<bool> fixed = m_.is_held(k);
    for (std::size_t v = 0; v < m_.vertices; ++v)
      f[v] = fixed[v] ? V3(V3::Zero()) : V3(f[v] - sum[v] / std::max(degree_[v], 1));
    return f;
  }

  /// A one-frame spike has the fourth difference 1 -4 6 -4 1, an impact 0 1 -2 1 0 and a jump 0 1 -3 3 -1. Noise is the
  /// residual of the fit to the first one, and the fits and residuals of the vertices two edges away.
  void spike(std::size_t k, const std::vector<Field>& around) {
    static constexpr std::array kSignature = {1.0 / 6, -2.0 / 3, 1.0, -2.0 / 3, 1.0 / 6};
    constexpr double kSquares = 35.0 / 18;
    const double t = m_.dt(k), floor = 20 * m_.resolution_m + 0.75 * m_.weight_unit * t * t;
    constexpr double kTolerance = 1.5;
    std::vector<double> height(m_.vertices), rest(m_.vertices);
    for (std::size_t v = 0; v < m_.vertices; ++v) {
      V3 fit = V3::Zero();
      double squares = 0;
      for (std::size_t o = 0; o < 5; ++o)
        fit += kSignature[o] / kSquares * around[o][v], squares += around[o][v].squaredNorm();
      height[v] = fit.norm();
      rest[v] = std::sqrt(std::max(0.0, squares - kSquares * fit.squaredNorm()));
    }
    double most = 0;
    for (std::size_t v = 0; v < m_.vertices; ++v) {
      double noise = 0;
      for (const std::uint32_t n : near_[v]) noise += 4 * height[n] + rest[n];
      noise /= static_cast<double>(std::max<std::size_t>(near_[v].size(), 1));
      most = std::max(most, height[v] / (kTolerance * (floor + 2 * rest[v] + noise)));
    }
    found_.add("spike", most, k);
  }

  void freeze() {
    found_.define("freeze");
    std::vector<double> speed(m_.frames, 0);
    for (std::size_t k = 1; k < m_.frames; ++k) {
      double sum = 0;
      for (std::size_t v = 0; v < m_.vertices; ++v) sum += (m_.at(k, v) - m_.at(k - 1, v)).squaredNorm();
      speed[k] = std::sqrt(sum / static_cast<double>(m_.vertices)) / m_.dt(k);
    }
    for (std::size_t k = 2; k + 1 < m_.frames; ++k) {
      const double beside = std::min(speed[k - 1], speed[k + 1]), t = m_.dt(k);
      if (beside > m_.weight_unit * t + 4 * m_.resolution_m / t) found_.add("freeze", (1 - speed[k] / beside) / 0.7, k);
    }
  }

  void stuck() {
    found_.define("stuck");
    const auto moved = [&](std::size_t k, std::size_t v) { return (m_.at(k, v) - m_.at(k - 1, v)).norm(); };
    for (std::size_t k = 2; k + 1 < m_.frames; ++k) {
      const double t = m_.dt(k), moving = m_.weight_unit * t * t + 4 * m_.resolution_m;
      std::vector<double> all;
      for (std::size_t v = 0; v < m_.vertices; ++v) all.push_back(moved(k, v));
      std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2), all.end());
      if (!(all[all.size() / 2] > moving)) continue;
      const std::vector<bool> fixed = m_.is_held(k);
      int still = 0;
      for (std::size_t v = 0; v < m_.vertices; ++v) {
        if (fixed[v] || !(moved(k, v) < 1e-9) || !(moved(k + 1, v) < 1e-9) || !(moved(k - 1, v) > moving)) continue;
        bool touches = false;
        for (std::size_t f = k - 1; f <= k + 1; ++f) touches = touches || bodies_.touched(f, v);
        still += !touches;
      }
      found_.add("stuck", still / 2.5, k);
    }
  }

  const Motion& m_;
  const Bodies& bodies_;
  Findings& found_;
  std::vector<int> degree_;
  std::vector<std::vector<std::uint32_t>> near_;  ///< vertices two edges away
};

}  // namespace

void check_smoothness(const Motion& m, Bodies& bodies, Findings& found) { Smoothness(m, bodies, found).run(); }

}  // namespace clothbench::motion_check
