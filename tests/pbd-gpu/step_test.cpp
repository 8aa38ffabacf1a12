// One frame of each method against the same method in double on the CPU, written from the papers, not from the shaders.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "gpu_fixture.hpp"
#include "line_plan.hpp"

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

/// Solves a x = b by elimination; a is symmetric and positive definite, so without exchanges. b: one V a row.
std::vector<V> solved(std::vector<std::vector<double>> a, std::vector<V> b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = k + 1; i < n; ++i) {
      const double f = a[i][k] / a[k][k];
      if (f == 0) continue;
      for (std::size_t j = k; j < n; ++j) a[i][j] -= f * a[k][j];
      b[i] = b[i] - f * b[k];
    }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] = b[k] - a[k][j] * b[j];
    b[k] = (1 / a[k][k]) * b[k];
  }
  return b;
}

double dot(V a, V b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// XPBD on whole lines in double: both diagonals, columns with bending before stretch, rows likewise.
class LineModel {
 public:
  LineModel(const Scene& s, Model& m, bool tethered, bool predicts)
      : s_(s), m_(m), predicts_(predicts), taut_(taut_chains(s)) {
    if (tethered) tethers_ = tethers_of(s);
  }

  void frame(int substeps, int iterations) {
    const int families = s_.needs.has(Feature::Shear) ? 4 : 2;
    for (int n = 0; n < substeps; ++n) {
      begin(s_.time.dt() / substeps);
      integrate();
      multipliers_.clear();
      for (int it = 0; it < iterations; ++it)
        for (int turn = 0; turn < families; ++turn) family(families - 1 - turn);
    }
  }

 private:
  std::size_t at(int i, int j) const { return static_cast<std::size_t>(j * s_.cloth.columns + i); }

  void move(std::size_t i, V d) {
    m_.x[i] = m_.x[i] + d;
    m_.v[i] = m_.v[i] + (1 / h_) * d;
  }

  /// Backward Euler, or BDF2 after a first substep of backward Euler: x'' from (3 v - 4 v_last + v_before) / 2 h.
  void begin(double h) {
    const double damping = s_.needs.has(Feature::Damping) ? s_.material.damping_per_s : 0;
    const bool second = predicts_ && !before_.x.empty();
    h_ = second ? 2 * h / 3 : h;
    carry_ = second ? 1.0 / 3 : 0;
    keep_ = predicts_ ? 1 / (1 + damping * h_) : 1;
    loss_ = predicts_ ? 1 - keep_ : -std::expm1(-damping * h_);
    last_ = second ? before_ : m_;
    before_ = m_;
  }

  void integrate() {
    const Cloth& c = s_.cloth;
    for (int j = 0; j < c.rows; ++j)
      for (int i = 0; i < c.columns; ++i) {
        const std::size_t k = at(i, j);
        if (m_.w[k] == 0) continue;
        m_.v[k] = m_.v[k] + carry_ * (m_.v[k] - last_.v[k]);
        m_.v[k] = m_.v[k] + keep_ * h_ * s_.gravity_m_per_s2 - loss_ * m_.v[k];
        m_.x[k] = m_.x[k] + carry_ * (m_.x[k] - last_.x[k]) + h_ * m_.v[k];
        for (const PinnedRectangle& r : tethers_.to) {
          const int a = std::clamp(i, static_cast<int>(r.first_column), static_cast<int>(r.last_column)),
                    b = std::clamp(j, static_cast<int>(r.first_row), static_cast<int>(r.last_row));
          const double u = std::abs(i - a) * c.du(), v = std::abs(j - b) * c.dv();
          const double reach = tethers_.stretch * (s_.needs.has(Feature::Shear) ? std::hypot(u, v) : u + v);
          const V e = m_.x[k] - m_.x[at(a, b)];
          if (length(e) > reach) move(k, (reach / length(e) - 1) * e);
        }
      }
  }

  void family(int f) {
    const Cloth& c = s_.cloth;
    const int di = f == 3 ? -1 : f == 1 ? 0 : 1, dj = f == 0 ? 0 : 1;
    for (int j = 0; j < c.rows; ++j)
      for (int i = 0; i < c.columns; ++i) {
        const bool begins = f == 0 ? i == 0 : j == 0 || (f == 2 && i == 0) || (f == 3 && i == c.columns - 1);
        if (!begins) continue;
        std::vector<std::size_t> line;
        for (int a = i, b = j; a >= 0 && a < c.columns && b < c.rows; a += di, b += dj) line.push_back(at(a, b));
        const int chain = f == 0   ? j
                          : f == 1 ? i
                          : f == 2 ? ((i - j) % c.columns + c.columns) % c.columns
                                   : (i + j) % c.columns;
        const bool border = (f == 0 && (j == 0 || j == c.rows - 1)) || (f == 1 && (i == 0 || i == c.columns - 1));
        if (f < 2 && s_.needs.has(Feature::Bend)) bend(f, line, border);
        const auto most = static_cast<std::size_t>(std::max(c.columns, c.rows));
        stretch(f, line, border, taut_[static_cast<std::size_t>(f) * most + static_cast<std::size_t>(chain)] != 0);
      }
  }

  double compliance(int f) const {
    if (!s_.material.membrane_stiffness_N_per_m) return 0;
    const double Y = *s_.material.membrane_stiffness_N_per_m, du = s_.cloth.du(), dv = s_.cloth.dv();
    if (f > 1) return 1 / (3.0 / 16 * Y * (du * du + dv * dv) / (du * dv));
    const double along = f == 0 ? du : dv, across = f == 0 ? dv : du;
    return 1 / (s_.needs.has(Feature::Shear) ? Y * (9.0 / 8 * across / along - 3.0 / 8 * along / across)
                                             : Y * across / along);
  }

  void stretch(int f, const std::vector<std::size_t>& line, bool border, bool taut) {
    if (line.size() < 2) return;
    const double du = s_.cloth.du(), dv = s_.cloth.dv(), rest = f == 0 ? du : f == 1 ? dv : std::hypot(du, dv);
    const double alpha = (border ? 2 : 1) * compliance(f) / (h_ * h_ * keep_);
    const std::size_t n = line.size() - 1;
    std::vector<std::vector<double>> a(n, std::vector<double>(n, 0));
    std::vector<V> g(n, V{}), b(n, V{});
    const auto w = [&](std::size_t k) { return m_.w[line[k]]; };
    for (std::size_t k = 0; k < n; ++k) {
      a[k][k] = 1;
      if (w(k) + w(k + 1) == 0) continue;
      const V e = m_.x[line[k + 1]] - m_.x[line[k]];
      g[k] = (1 / length(e)) * e;
      const bool elastic = s_.material.membrane_stiffness_N_per_m.has_value(),
                 strip = elastic && !s_.needs.has(Feature::Shear);
      const double torn = length(e) / rest, firm = strip ? torn - 1 : elastic ? 0 : 4 * (torn - 5);
      const double soft = std::max(alpha, taut ? std::max(1e-3, firm) * std::max(w(k), w(k + 1)) : 0.0);
      a[k][k] = w(k) + w(k + 1) + soft;
      b[k][0] = rest - length(e) - (strip ? soft : alpha) * multipliers_[{f, line[k]}][0];
    }
    for (std::size_t k = 0; k + 1 < n; ++k) a[k][k + 1] = a[k + 1][k] = -w(k + 1) * dot(g[k], g[k + 1]);
    const std::vector<V> lambda = solved(a, b);
    for (std::size_t k = 0; k < n; ++k) {
      multipliers_[{f, line[k]}][0] += lambda[k][0];
      move(line[k], (-w(k) * lambda[k][0]) * g[k]);
      move(line[k + 1], (w(k + 1) * lambda[k][0]) * g[k]);
    }
  }

  void bend(int f, const std::vector<std::size_t>& line, bool border) {
    if (line.size() < 3) return;
    const double du = s_.cloth.du(), dv = s_.cloth.dv(), along = f == 0 ? du : dv, across = f == 0 ? dv : du;
    const double inside = along * along * along / (s_.material.bending_rigidity_N_m * across) / (h_ * h_ * keep_);
    const std::size_t n = line.size() - 2;
    std::vector<std::vector<double>> a(n, std::vector<double>(n, 0));
    std::vector<V> b(n, V{});
    const auto w = [&](std::size_t k) { return m_.w[line[k]]; };
    for (std::size_t k = 0; k < n; ++k) {
      const bool clamp = w(k + 1) == 0 && (w(k) == 0) != (w(k + 2) == 0);  // a clamp is twice as stiff
      const double alpha = (border ? 2 : 1) * (clamp ? 0.5 : 1) * inside;
      a[k][k] = w(k) + 4 * w(k + 1) + w(k + 2) + alpha;
      if (k + 1 < n) a[k][k + 1] = a[k + 1][k] = -2 * (w(k + 1) + w(k + 2));
      if (k + 2 < n) a[k][k + 2] = a[k + 2][k] = w(k + 2);
      const V C = m_.x[line[k]] - 2.0 * m_.x[line[k + 1]] + m_.x[line[k + 2]];
      b[k] = -1.0 * (C + alpha * multipliers_[{4 + f, line[k + 1]}]);
    }
    const std::vector<V> lambda = solved(a, b);
    for (std::size_t k = 0; k < n; ++k) {
      V& kept = multipliers_[{4 + f, line[k + 1]}];
      kept = kept + lambda[k];
      move(line[k], w(k) * lambda[k]);
      move(line[k + 1], -2 * w(k + 1) * lambda[k]);
      move(line[k + 2], w(k + 2) * lambda[k]);
    }
  }

  const Scene& s_;
  Model &m_, last_{}, before_{};  ///< now; before the last substep; before this one
  const bool predicts_;
  const std::vector<std::uint8_t> taut_;
  Tethers tethers_;
  double h_ = 0, carry_ = 0, keep_ = 1, loss_ = 0;
  std::map<std::pair<int, std::size_t>, V> multipliers_;
};

/// 3e-5 for lines: a system of 32 rows takes some digits of single precision, most if the line is pulled taut.
void expect_close(const Model& m, const ClothState& state, double speed_scale, const std::string& what,
                  double tolerance = 1e-5) {
  for (std::size_t i = 0; i < m.x.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(state.position[3 * i + k], m.x[i][k], tolerance) << what << " vertex " << i;
      EXPECT_NEAR(state.velocity[3 * i + k], m.v[i][k], tolerance * speed_scale) << what << " vertex " << i;
    }
}

/// One dispatch and many, exchange by shuffles (where lines fit this device's subgroups) and through shared memory.
std::vector<nlohmann::json> variants() {
  return {
      nlohmann::json::object(),
      {{"tuning", {{"shuffles", false}}}},
      {{"one_dispatch", false}},
      {{"one_dispatch", false}, {"tuning", {{"shuffles", false}}}},
      {{"tuning", {{"vertices_a_thread", 2}}}},
      {{"one_dispatch", false}, {"tuning", {{"vertices_a_thread", 8}}}},
      {{"one_dispatch", false}, {"tuning", {{"vertices_a_thread", 2}, {"lines_beside", 2}}}},
      {{"one_dispatch", false}, {"tuning", {{"vertices_a_thread", 2}, {"lines_beside", 4}, {"threads_a_group", 128}}}}};
}

TEST_F(Gpu, OneFrameAgreesWithDoublePrecision) {
  std::size_t number = 0;
  for (const auto& [columns, rows] : {std::pair{2, 2}, {3, 2}, {2, 5}, {7, 5}, {33, 17}})
    for (int features : {0, 1, 2, 3, 4, 5, 6, 7, 8, 15, 18, 26, 31}) {  // bits, as below
      std::size_t turn = 2 * number;
      if (!in_turn(number++)) continue;
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
      // The sheet, let go from 7 % of stretch, may be back and buckling by the end of the frame. How far a last bit of
      // single precision at the start then moves it in double is the least error that can be demanded.
      for (const auto& [substeps, iterations] : {std::pair{10, 1}, {4, 2}}) {
        m = start(s);
        Model nudged = m;
        for (std::size_t i = 0; i < m.x.size(); ++i)
          for (std::size_t k = 0; k < 3; ++k)
            if (m.w[i] > 0) nudged.x[i][k] += ((i + k) % 2 == 0 ? 6e-8 : -6e-8) * std::abs(nudged.x[i][k]);
        const bool predicts = turn % 2 == 1;
        LineModel(s, m, false, predicts).frame(substeps, iterations);
        LineModel(s, nudged, false, predicts).frame(substeps, iterations);
        double moved = 0;
        for (std::size_t i = 0; i < m.x.size(); ++i) moved = std::max(moved, length(m.x[i] - nudged.x[i]));
        ASSERT_LE(moved, 1e-3) << what << ": nothing would be tested";
        // In turns: a pipeline takes a CPU device a good part of a second to make.
        nlohmann::json settings = {{"substeps", substeps}, {"iterations", iterations}};
        settings.update(variants()[turn / 2 % variants().size()]);
        settings["tuning"]["prediction"] = predicts ? "always" : "auto";
        ++turn;
        const auto xpbd = make("xpbd", settings);
        xpbd->load(s);
        expect_close(m, after(*xpbd, s, 1), substeps / s.time.dt(), "xpbd " + what + settings.dump(),
                     std::max(3e-5, 10 * moved));
      }
    }
}

TEST_F(Gpu, TethersAgreeWithDoublePrecision) {
  std::size_t turn = 0;
  for (const auto& [columns, rows] : {std::pair{2, 2}, {9, 7}, {5, 20}, {33, 17}})
    for (const bool shear : {true, false})
      for (const bool edge : {false, true}) {
        Scene s = with_damping(with_pins(sheet(columns, rows)));
        s.material.membrane_stiffness_N_per_m.reset();
        if (!shear) s.needs = s.needs - FeatureSet{Feature::Shear};
        if (edge) s.pins.vertices = edge_vertices(s.cloth, "v0");
        ASSERT_FALSE(tethers_of(s).to.empty());
        Model m = start(s);
        const bool predicts = turn % 2 == 0;
        LineModel(s, m, true, predicts).frame(4, 1);
        nlohmann::json settings = {{"substeps", 4}};
        settings.update(variants()[turn++ % variants().size()]);
        settings["tuning"]["prediction"] = predicts ? "always" : "auto";
        const auto xpbd = make("xpbd", settings);
        xpbd->load(s);
        expect_close(m, after(*xpbd, s, 1), 4 / s.time.dt(),
                     std::to_string(columns) + "x" + std::to_string(rows) + settings.dump());
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
