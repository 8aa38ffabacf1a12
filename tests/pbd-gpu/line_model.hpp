#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include "xpbd/lines/line_layout.hpp"

namespace clothbench::pbd_gpu {

using V = std::array<double, 3>;

inline V operator+(V a, V b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline V operator-(V a, V b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline V operator*(double s, V a) { return {s * a[0], s * a[1], s * a[2]}; }
inline double length(V a) { return std::hypot(a[0], a[1], a[2]); }

struct Model {
  std::vector<V> x, v;
  std::vector<double> w;
};

/// Solves a x = b by elimination; a is symmetric and positive definite, so without exchanges. b: one V a row.
inline std::vector<V> solved(std::vector<std::vector<double>> a, std::vector<V> b) {
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

inline double dot(V a, V b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

struct Method {
  bool tethered, uses_bdf2, tension, corrects_splitting = false;
};

/// XPBD on whole lines in double: both diagonals, columns with bending before stretch, rows likewise.
class LineModel {
 public:
  LineModel(const Scene& s, Model& m, Method method)
      : s_(s),
        m_(m),
        uses_bdf2_(method.uses_bdf2),
        tension_(method.tension),
        corrects_splitting_(method.corrects_splitting),
        over_constrained_(over_constrained_lines(s)),
        shift_(m.x.size()) {
    if (method.tethered) tethers_ = tethers_of(s);
  }

  void frame(int substeps) {
    const int colours = s_.needs.has(Feature::Shear) ? 4 : 2;
    rate_ = std::min(0.04, 0.2 / substeps);
    for (int n = 0; n < substeps; ++n) {
      begin(s_.time.dt() / substeps);
      integrate();
      for (int turn = 0; turn < colours; ++turn) colour(colours - 1 - turn);
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
    const bool second = uses_bdf2_ && !before_.x.empty();
    h_ = second ? 2 * h / 3 : h;
    carry_ = second ? 1.0 / 3 : 0;
    keep_ = uses_bdf2_ ? 1 / (1 + damping * h_) : 1;
    loss_ = uses_bdf2_ ? 1 - keep_ : -std::expm1(-damping * h_);
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

  void colour(int f) {
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
        stretch(f, line, border,
                over_constrained_[static_cast<std::size_t>(f) * most + static_cast<std::size_t>(chain)] != 0);
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

  /// Share of the compliance that acts at once: 1 / (1 + K/3 / (K + s^2/21)), K = h^2 Y/m, over s links.
  double at_once() const {
    if (!corrects_splitting_) return 1;
    const double mass = s_.cloth.areal_density_kg_per_m2 * s_.cloth.du() * s_.cloth.dv(),
                 waves = 4.0 / 3 / (mass * compliance(0) / (h_ * h_ * keep_)),
                 links = std::min(s_.cloth.columns, s_.cloth.rows) - 1;
    return 1 / (1 + waves / 3 / (waves + links * links / 21));
  }

  /// By how much what columns and rows will do lengthens a diagonal from vertex a to b, by smoothed displacements.
  double predicted_lengthening(int f, std::size_t a, std::size_t b) const {
    if (f < 2 || !corrects_splitting_) return 0;
    const double du = s_.cloth.du(), dv = s_.cloth.dv();
    const auto along = [&](std::size_t i) {
      return m_.w[i] > 0
                 ? 0.995 * h_ * h_ * ((f == 2 ? du : -du) * shift_[i][0] + dv * shift_[i][1]) / std::hypot(du, dv)
                 : 0;
    };
    return along(b) - along(a);
  }

  /// `lambda`: the multipliers of all links of a line in this substep.
  void remember(int f, const std::vector<std::size_t>& line, double alpha, const std::vector<double>& lambda) {
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
      double& creep = creep_[{f, line[k]}];
      creep += rate_ * ((1 - at_once()) * alpha * lambda[k] - creep);
    }
    for (std::size_t k = 0; k < line.size() && f < 2; ++k) {
      const double before = k > 0 ? lambda[k - 1] : 0, after = k + 1 < line.size() ? lambda[k] : 0,
                   moved = m_.w[line[k]] * (before - after) / (h_ * h_),
                   most = 0.25 * (f == 0 ? s_.cloth.du() : s_.cloth.dv()) / (h_ * h_);
      double &second = shift_[line[k]][static_cast<std::size_t>(f)],
             &first = shift_[line[k]][2 + static_cast<std::size_t>(f)];
      second = std::clamp(second + rate_ * (first - second), -most, most);
      first += rate_ * (moved - first);
    }
  }

  struct Links {
    std::vector<V> along;                ///< unit vectors
    std::vector<double> length, lambda;  ///< lambda: multipliers that solve them
  };
  /// Solves the links of a line that carry `pull` (tension over length) already, and moves nothing.
  Links solved_links(int f, const std::vector<std::size_t>& line, double alpha, bool over_constrained,
                     std::vector<double> pull) {
    const double du = s_.cloth.du(), dv = s_.cloth.dv(), rest = f == 0 ? du : f == 1 ? dv : std::hypot(du, dv);
    const std::size_t n = line.size() - 1;
    std::vector<std::vector<double>> a(n, std::vector<double>(n, 0));
    std::vector<V> b(n, V{});
    Links out{std::vector<V>(n, V{}), std::vector<double>(n, 1), std::vector<double>(n, 0)};
    const auto w = [&](std::size_t k) { return m_.w[line[k]]; };
    const bool elastic = s_.material.membrane_stiffness_N_per_m.has_value(),
               strip = elastic && !s_.needs.has(Feature::Shear);
    for (std::size_t k = 0; k < n; ++k) {
      a[k][k] = 1;
      if (w(k) + w(k + 1) == 0) continue;
      const V e = m_.x[line[k + 1]] - m_.x[line[k]];
      out.length[k] = length(e);
      out.along[k] = (1 / length(e)) * e;
      const double torn = length(e) / rest, firm = tension_ ? 0 : strip ? torn - 1 : elastic ? 0 : 4 * (torn - 5);
      const bool yields = over_constrained && !(tension_ && elastic);
      const double soft = std::max(alpha, yields ? std::max(1e-3, firm) * std::max(w(k), w(k + 1)) : 0.0);
      a[k][k] = w(k) + w(k + 1) + soft;
      b[k][0] = rest - length(e) + soft * pull[k] * length(e);
      b[k][0] -= creep_[{f, line[k]}] + predicted_lengthening(f, line[k], line[k + 1]);
    }
    for (std::size_t k = 0; k + 1 < n; ++k) a[k][k + 1] = a[k + 1][k] = -w(k + 1) * dot(out.along[k], out.along[k + 1]);
    const std::vector<V> lambda = solved(a, b);
    for (std::size_t k = 0; k < n; ++k) out.lambda[k] = lambda[k][0];
    return out;
  }

  /// Implicit tension: vertices on zero-length springs of the line's tension, (M + h^2 K) d = -h^2 K x.
  std::vector<double> turn(const std::vector<std::size_t>& line, const Links& links) {
    const std::size_t n = line.size();
    std::vector<double> pull(n - 1);
    std::vector<std::vector<double>> a(n, std::vector<double>(n, 0));
    std::vector<V> b(n, V{});
    for (std::size_t k = 0; k < n; ++k) a[k][k] = m_.w[line[k]] > 0 ? 1 / m_.w[line[k]] : 1;
    for (std::size_t k = 0; k + 1 < n; ++k) {
      const double t = pull[k] = std::max(0.0, -links.lambda[k]) / links.length[k];
      const V e = t * (m_.x[line[k + 1]] - m_.x[line[k]]);
      for (const auto& [i, j, sign] : {std::tuple{k, k + 1, 1.0}, {k + 1, k, -1.0}}) {
        if (m_.w[line[i]] == 0) continue;
        a[i][i] += t;
        if (m_.w[line[j]] > 0) a[i][j] -= t;
        b[i] = b[i] + sign * e;
      }
    }
    const std::vector<V> d = solved(a, b);
    for (std::size_t k = 0; k < n; ++k)
      if (m_.w[line[k]] > 0) move(line[k], d[k]);
    return pull;
  }

  void stretch(int f, const std::vector<std::size_t>& line, bool border, bool over_constrained) {
    if (line.size() < 2) return;
    const double whole = (border ? 2 : 1) * compliance(f) / (h_ * h_ * keep_), alpha = at_once() * whole;
    const std::vector<double> none(line.size() - 1, 0);
    const auto carried = tension_ ? turn(line, solved_links(f, line, alpha, over_constrained, none)) : none;
    const Links links = solved_links(f, line, alpha, over_constrained, carried);
    std::vector<double> all = links.lambda;
    for (std::size_t k = 0; k < all.size(); ++k) all[k] -= carried[k] * links.length[k];
    if (corrects_splitting_) remember(f, line, whole, all);
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
      move(line[k], (-m_.w[line[k]] * links.lambda[k]) * links.along[k]);
      move(line[k + 1], (m_.w[line[k + 1]] * links.lambda[k]) * links.along[k]);
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
      b[k] = -1.0 * C;
    }
    const std::vector<V> lambda = solved(a, b);
    for (std::size_t k = 0; k < n; ++k) {
      move(line[k], w(k) * lambda[k]);
      move(line[k + 1], -2 * w(k + 1) * lambda[k]);
      move(line[k + 2], w(k + 2) * lambda[k]);
    }
  }

  const Scene& s_;
  Model &m_, last_{}, before_{};  ///< now; before the last substep; before this one
  const bool uses_bdf2_, tension_, corrects_splitting_;
  const std::vector<std::uint8_t> over_constrained_;
  Tethers tethers_;
  std::vector<std::array<double, 4>> shift_;  ///< over h^2: along rows, along columns, and the filter's first stage
  std::map<std::pair<int, std::size_t>, double> creep_;
  double h_ = 0, carry_ = 0, keep_ = 1, loss_ = 0, rate_ = 0;
};

}  // namespace clothbench::pbd_gpu
