// Displacements that no impact leaves: one vertex for one frame, a frame that repeats another, vertices that stand
// still in the air.
#include <algorithm>
#include <cmath>

#include "metrics/motion_check/bodies.hpp"
#include "metrics/motion_check/motion.hpp"

namespace clothbench::motion_check {
namespace {

using Field = std::vector<V3>;

class Smoothness {
 public:
  Smoothness(const Motion& m, const Bodies& b, Findings& f) : m_(m), bodies_(b), found_(f), degree_(m.vertices, 0) {
    for (const Edge& e : m.edges) ++degree_[e.a], ++degree_[e.b];
  }

  void run();

 private:
  Field high_pass(std::size_t k) const;
  void roughness(std::size_t k, const Field& f);
  void spike(std::size_t k, const std::vector<Field>& around);
  double reference_m(const Field& f, double t) const;
  std::vector<bool> held(std::size_t k) const;
  void freeze();
  void stuck();

  const Motion& m_;
  const Bodies& bodies_;
  Findings& found_;
  std::vector<int> degree_;
};

std::vector<bool> Smoothness::held(std::size_t k) const {
  std::vector<bool> out(m_.vertices, false);
  for (const std::uint32_t v : m_.held(k)) out[v] = true;
  return out;
}

/// Fourth difference in time over 6 (a spike of one frame keeps its height), minus the mean of the neighbours.
Field Smoothness::high_pass(std::size_t k) const {
  Field f(m_.vertices), sum(m_.vertices, V3::Zero());
  for (std::size_t v = 0; v < m_.vertices; ++v)
    f[v] = (m_.at(k - 2, v) - 4 * m_.at(k - 1, v) + 6 * m_.at(k, v) - 4 * m_.at(k + 1, v) + m_.at(k + 2, v)) / 6;
  for (const Edge& e : m_.edges) sum[e.a] += f[e.b], sum[e.b] += f[e.a];
  const std::vector<bool> fixed = held(k);
  for (std::size_t v = 0; v < m_.vertices; ++v)
    f[v] = fixed[v] ? V3(V3::Zero()) : V3(f[v] - sum[v] / std::max(degree_[v], 1));
  return f;
}

/// What is usual in a frame: a spike and its neighbours are a few vertices, an impact moves more.
double Smoothness::reference_m(const Field& f, double t) const {
  std::vector<double> size;
  for (const V3& x : f) size.push_back(x.norm());
  std::sort(size.rbegin(), size.rend());
  const double usual = size.size() > 12 ? (size[7] + size[8]) / 2 : size.back();
  return 12 * m_.resolution_m + m_.weight_unit * t * t / 4 + 3 * usual;
}

void Smoothness::roughness(std::size_t k, const Field& f) {
  const double allowed = 5 * reference_m(f, m_.dt(k));
  for (const V3& x : f) found_.add("roughness", x.norm() / allowed, k);
}

/// A displacement of one frame leaves 1 -4 6 -4 1, an impact 0 1 -2 1 0 and a jump 0 1 -3 3 -1.
void Smoothness::spike(std::size_t k, const std::vector<Field>& around) {
  static constexpr std::array kSignature = {1.0 / 6, -2.0 / 3, 1.0, -2.0 / 3, 1.0 / 6};
  const double allowed = 3 * reference_m(around[2], m_.dt(k));
  for (std::size_t v = 0; v < m_.vertices; ++v) {
    const V3& height = around[2][v];
    double rest = 0;
    for (std::size_t o = 0; o < 5; ++o) rest += (around[o][v] - kSignature[o] * height).squaredNorm();
    if (rest < std::pow(0.25 * height.norm(), 2)) found_.add("spike", height.norm() / allowed, k);
  }
}

void Smoothness::freeze() {
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

void Smoothness::stuck() {
  found_.define("stuck");
  const auto moved = [&](std::size_t k, std::size_t v) { return (m_.at(k, v) - m_.at(k - 1, v)).norm(); };
  for (std::size_t k = 2; k + 1 < m_.frames; ++k) {
    const double t = m_.dt(k), moving = m_.weight_unit * t * t + 4 * m_.resolution_m;
    std::vector<double> all;
    for (std::size_t v = 0; v < m_.vertices; ++v) all.push_back(moved(k, v));
    std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2), all.end());
    if (!(all[all.size() / 2] > moving)) continue;
    const std::vector<bool> fixed = held(k);
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

void Smoothness::run() {
  freeze();
  stuck();
  if (!m_.even || m_.frames < 9 || m_.vertices <= 20) return;
  found_.define("spike");
  std::vector<Field> around;
  for (std::size_t k = 2; k + 2 < m_.frames; ++k) {
    around.push_back(high_pass(k));
    roughness(k, around.back());
    if (around.size() > 5) around.erase(around.begin());
    if (around.size() == 5) spike(k - 2, around);
  }
}

}  // namespace

void check_smoothness(const Motion& m, const Bodies& bodies, Findings& found) { Smoothness(m, bodies, found).run(); }

}  // namespace clothbench::motion_check
