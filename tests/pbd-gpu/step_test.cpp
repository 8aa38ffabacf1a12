// One frame of each method against the same method in double on the CPU, written from the papers, not from the shaders.
#include <algorithm>
#include <array>
#include <cmath>

#include "gpu_fixture.hpp"

namespace clothbench::pbd_gpu {
namespace {

using V = std::array<double, 3>;

V operator+(V a, V b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
V operator-(V a, V b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
V operator*(double s, V a) { return {s * a[0], s * a[1], s * a[2]}; }
double length(V a) { return std::hypot(a[0], a[1], a[2]); }

struct Model {
  std::vector<V> x, v;
  std::vector<double> w;
};

/// A scene that starts deformed: the sheet is stretched by 7 % and 3 % by giving it smaller rest lengths than it has.
Scene deformed(Scene s) {
  s.cloth.axis_u = {1.07, 0, 0};
  s.cloth.axis_v = {0, 0.3, 1.0};
  s.cloth.initial_velocity_m_per_s = {0.3, -0.2, 0.1};
  return s;
}

Model start(const Scene& s) {
  Model m;
  const std::vector<double> x = initial_positions(s), mass = vertex_masses(s);
  for (std::size_t i = 0; i < mass.size(); ++i) {
    m.x.push_back({x[3 * i], x[3 * i + 1], x[3 * i + 2]});
    m.v.push_back(s.cloth.initial_velocity_m_per_s);
    m.w.push_back(1 / mass[i]);
  }
  for (std::uint32_t p : s.pins.vertices) {
    m.w[p] = 0;
    m.v[p] = {};
  }
  return m;
}

/// Müller et al. 2007 with averaged Jacobi iterations; damping after the forces.
void paper_frame(const Scene& s, Model& m, int iterations, double k) {
  const double h = s.time.dt(), keep = s.needs.has(Feature::Damping) ? 1 - s.material.damping_per_s * h : 1;
  std::vector<V> q = m.x;
  for (std::size_t i = 0; i < q.size(); ++i) {
    if (m.w[i] > 0) m.v[i] = keep * (m.v[i] + h * s.gravity_m_per_s2);
    q[i] = m.x[i] + h * m.v[i];
  }
  std::vector<Edge> all = edges(s.cloth, EdgeKind::Structural);
  for (EdgeKind kind : {EdgeKind::Shear, EdgeKind::SkipOne})
    if (s.needs.has(kind == EdgeKind::Shear ? Feature::Shear : Feature::Bend))
      for (const Edge& e : edges(s.cloth, kind)) all.push_back(e);
  for (int it = 0; it < iterations; ++it) {
    std::vector<V> sum(q.size(), V{});
    std::vector<int> count(q.size(), 0);
    for (const Edge& e : all) {
      const V d = q[e.b] - q[e.a];
      const double l = length(d), w = m.w[e.a] + m.w[e.b];
      if (w == 0) continue;
      const V c = (k * (l - e.rest_m) / (l * w)) * d;
      sum[e.a] = sum[e.a] + m.w[e.a] * c;
      sum[e.b] = sum[e.b] - m.w[e.b] * c;
      ++count[e.a];
      ++count[e.b];
    }
    for (std::size_t i = 0; i < q.size(); ++i)
      if (m.w[i] > 0) q[i] = q[i] + (1.0 / count[i]) * sum[i];
  }
  for (std::size_t i = 0; i < q.size(); ++i) {
    m.v[i] = (1 / h) * (q[i] - m.x[i]);
    m.x[i] = q[i];
  }
}

/// XPBD, Gauss-Seidel in the order: rows' structural edges even then odd, columns', diagonals, bending triplets. The
/// multipliers lie in the order in which the constraints are visited.
void xpbd_frame(const Scene& s, Model& m, int substeps, int iterations) {
  const Cloth& c = s.cloth;
  const double h = s.time.dt() / substeps, Y = *s.material.membrane_stiffness_N_per_m, du = c.du(), dv = c.dv();
  const double diagonal = 3.0 / 16 * Y * (du * du + dv * dv) / (du * dv);
  const bool shear = s.needs.has(Feature::Shear);
  const double along_u = shear ? Y * (9.0 / 8 * dv / du - 3.0 / 8 * du / dv) : Y * dv / du,
               along_v = shear ? Y * (9.0 / 8 * du / dv - 3.0 / 8 * dv / du) : Y * du / dv;
  const auto at = [&](int i, int j) { return static_cast<std::size_t>(j * c.columns + i); };
  const auto move = [&](std::size_t i, V d) {
    m.x[i] = m.x[i] + d;
    m.v[i] = m.v[i] + (1 / h) * d;
  };
  std::vector<V> multipliers;
  std::size_t visited = 0;
  const auto multiplier = [&]() -> V& {
    if (visited == multipliers.size()) multipliers.push_back({});
    return multipliers[visited++];
  };
  const auto distance = [&](std::size_t a, std::size_t b, double rest, double k) {
    const V d = m.x[b] - m.x[a];
    const double l = length(d), w = m.w[a] + m.w[b], alpha = 1 / (k * h * h);
    double& lambda = multiplier()[0];
    if (w == 0) return;
    const double change = (-(l - rest) - alpha * lambda) / (w + alpha);  // Macklin et al. 2016, eq. 18
    lambda += change;
    move(a, (-m.w[a] * change / l) * d);
    move(b, (m.w[b] * change / l) * d);
  };
  const auto bend = [&](std::size_t a, std::size_t b, std::size_t e, double alpha) {
    const double w = m.w[a] + 4 * m.w[b] + m.w[e];
    V& lambda = multiplier();
    if (w == 0) return;
    if (m.w[b] == 0 && (m.w[a] == 0) != (m.w[e] == 0)) alpha /= 2;  // a clamp is twice as stiff
    const V step = (-1 / (w + alpha / (h * h))) * (m.x[a] - 2.0 * m.x[b] + m.x[e] + (alpha / (h * h)) * lambda);
    lambda = lambda + step;
    move(a, m.w[a] * step);
    move(b, -2 * m.w[b] * step);
    move(e, m.w[e] * step);
  };
  const auto half = [](int k, int n) { return k == 0 || k == n - 1 ? 0.5 : 1.0; };
  const auto sweep = [&] {
    visited = 0;
    for (int colour = 0; colour < 2; ++colour)
      for (int i = colour; i + 1 < c.columns; i += 2)
        for (int j = 0; j < c.rows; ++j) distance(at(i, j), at(i + 1, j), du, along_u * half(j, c.rows));
    for (int colour = 0; colour < 2; ++colour)
      for (int j = colour; j + 1 < c.rows; j += 2)
        for (int i = 0; i < c.columns; ++i) distance(at(i, j), at(i, j + 1), dv, along_v * half(i, c.columns));
    for (int direction : {1, -1})
      for (int colour = 0; colour < 2; ++colour)
        for (int j = colour; j + 1 < c.rows; j += 2)
          for (int i = 0; i < c.columns; ++i)
            if (shear && i + direction >= 0 && i + direction < c.columns)
              distance(at(i, j), at(i + direction, j + 1), std::hypot(du, dv), diagonal);
    if (!s.needs.has(Feature::Bend)) return;
    const double B = s.material.bending_rigidity_N_m;
    for (int colour = 0; colour < 3; ++colour)
      for (int i = colour; i + 2 < c.columns; i += 3)
        for (int j = 0; j < c.rows; ++j)
          bend(at(i, j), at(i + 1, j), at(i + 2, j), du * du * du / (B * dv * half(j, c.rows)));
    for (int colour = 0; colour < 3; ++colour)
      for (int j = colour; j + 2 < c.rows; j += 3)
        for (int i = 0; i < c.columns; ++i)
          bend(at(i, j), at(i, j + 1), at(i, j + 2), dv * dv * dv / (B * du * half(i, c.columns)));
  };
  for (int n = 0; n < substeps; ++n) {
    for (std::size_t i = 0; i < m.x.size(); ++i) {
      if (m.w[i] == 0) continue;
      const double loss = s.needs.has(Feature::Damping) ? -std::expm1(-s.material.damping_per_s * h) : 0;
      m.v[i] = m.v[i] + h * s.gravity_m_per_s2 - loss * m.v[i];
      m.x[i] = m.x[i] + h * m.v[i];
    }
    multipliers.clear();
    for (int it = 0; it < iterations; ++it) sweep();
  }
}

void expect_close(const Model& m, const ClothState& state, double speed_scale, const std::string& what) {
  for (std::size_t i = 0; i < m.x.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(state.position[3 * i + k], m.x[i][k], 1e-5) << what << " vertex " << i;
      EXPECT_NEAR(state.velocity[3 * i + k], m.v[i][k], 1e-5 * speed_scale) << what << " vertex " << i;
    }
}

TEST_F(Gpu, OneFrameAgreesWithDoublePrecision) {
  for (const auto& [columns, rows] : {std::pair{2, 2}, {3, 2}, {2, 5}, {7, 5}, {33, 17}})
    for (int features : {0, 1, 2, 3, 4, 5, 6, 7, 8, 15, 18, 26, 31}) {  // bits, as below
      Scene s = deformed(sheet(columns, rows, (columns - 1) / 32.0, (rows - 1) / 32.0));
      if ((features & 1) != 0) s = with_pins(s);
      if ((features & 2) != 0) s = with_bending(s);
      if ((features & 4) != 0) s = with_damping(s);
      if ((features & 8) != 0) s.needs = s.needs - FeatureSet{Feature::Shear};
      if ((features & 16) != 0) {
        s.pins.vertices = clamp_vertices(s.cloth, "u0");
        s.needs.add(Feature::Pins);
      }
      const std::string what =
          std::to_string(columns) + "x" + std::to_string(rows) + " features " + std::to_string(features);
      // Speeds come from corrections over the step: 1e-5 of a metre over it.
      Model m = start(s);
      paper_frame(s, m, 5, 0.8);
      const auto paper = make("paper");
      paper->load(s);
      expect_close(m, after(*paper, s, 1), 1 / s.time.dt(), "paper " + what);
      // With 10 substeps of 3 iterations the sheet, let go from 7 % of stretch, is back and buckling by the end of the
      // frame: a one-ulp change of the start already moves it by 1e-6 m in double. Hence 4.
      for (const auto& [substeps, iterations] : {std::pair{10, 1}, {4, 3}}) {
        m = start(s);
        xpbd_frame(s, m, substeps, iterations);
        const auto xpbd = make("xpbd", {{"substeps", substeps}, {"iterations", iterations}});
        xpbd->load(s);
        expect_close(m, after(*xpbd, s, 1), substeps / s.time.dt(),
                     "xpbd " + what + " iterations " + std::to_string(iterations));
      }
    }
}

TEST_F(Gpu, OneFrameOfAMillionParticlesAgreesToo) {
  // 6.3 million constraints are 98 000 workgroups, more than a row of a dispatch holds.
  const Scene s = deformed(with_bending(sheet(1024, 1024)));
  Model m = start(s);
  paper_frame(s, m, 1, 0.8);
  const auto paper = make("paper", {{"iterations", 1}});
  paper->load(s);
  expect_close(m, after(*paper, s, 1), 1 / s.time.dt(), "paper 1024x1024");
}

TEST_F(Gpu, TheSecondLayerOfADoubledClothFollowsTheFirst) {
  Scene s = with_pins(sheet(9, 7)), doubled = s;
  doubled.cloth.sides = Sides::DoubleDuplicated;
  doubled.needs.add(Feature::DuplicatedLayer);
  const auto one = make("paper"), two = make("paper");
  one->load(s);
  two->load(doubled);
  const ClothState a = after(*one, s, 10), b = after(*two, doubled, 10);
  ASSERT_EQ(a.position.size(), b.position.size()) << "the state is the first layer";
  for (std::size_t k = 0; k < b.position.size(); ++k) EXPECT_TRUE(std::isfinite(b.position[k]));
  EXPECT_GT(two->plan().buffers.front().bytes, one->plan().buffers.front().bytes);
}

}  // namespace
}  // namespace clothbench::pbd_gpu
