#include "metrics/material_patch.hpp"

#include <cmath>

#include "clothbench/record.hpp"
#include "clothbench/vector.hpp"
#include "metrics/mesh_patch.hpp"
#include "truth/solutions.hpp"

namespace clothbench {
namespace {

/// A patch with its long side along s and its short side along t, which may be u and v or v and u.
struct Sheet {
  const Scene& scene;
  const std::vector<double>& x;
  bool along_v;

  Sheet(const Scene& s, const std::vector<double>& position)
      : scene(s), x(position), along_v(s.cloth.rows > s.cloth.columns) {}

  int n() const { return (along_v ? scene.cloth.rows : scene.cloth.columns) - 1; }
  int across() const { return (along_v ? scene.cloth.columns : scene.cloth.rows) - 1; }
  double length_m() const { return along_v ? scene.cloth.height_m : scene.cloth.width_m; }
  double cell_m() const { return length_m() / n(); }
  double cell_across_m() const { return (along_v ? scene.cloth.width_m : scene.cloth.height_m) / across(); }
  const Vec3& along() const { return along_v ? scene.cloth.axis_v : scene.cloth.axis_u; }
  const Vec3& aside() const { return along_v ? scene.cloth.axis_u : scene.cloth.axis_v; }
  double g() const { return std::sqrt(dot(scene.gravity_m_per_s2, scene.gravity_m_per_s2)); }
  double weight() const { return scene.cloth.areal_density_kg_per_m2 * g(); }

  /// Displacement of line s, row t, in a direction [m].
  double moved(int s, int t, const Vec3& direction) const {
    const int i = along_v ? t : s, j = along_v ? s : t;
    const Vec3 from = scene.rest_position(i, j);
    const auto k =
        3 * (static_cast<std::size_t>(j) * static_cast<std::size_t>(scene.cloth.columns) + static_cast<std::size_t>(i));
    return dot({x[k] - from[0], x[k + 1] - from[1], x[k + 2] - from[2]}, direction);
  }
};

/// A modulus is a load over a displacement; a displacement of zero or of the wrong sign gives none.
double over(double load, double moved) { return moved > 0 ? load / moved : kMissing; }

/// E of one line between s = L/2 and 7L/8, over the scene's Y.
double hang_modulus(const Sheet& p, int row) {
  const int first = p.n() / 2, last = p.n() * 7 / 8;
  const auto load = [&](int k) {
    const double s = k * p.cell_m();
    return p.weight() * (p.length_m() * s - s * s / 2);
  };
  const double stretch = p.moved(last, row, p.along()) - p.moved(first, row, p.along());
  return over(load(last) - load(first), stretch) / *p.scene.material.membrane_stiffness_N_per_m;
}

std::map<std::string, double> hang(const Sheet& p) {
  const int s = p.n() / 2, t = p.across(), m = t / 2;
  const double strain = (p.moved(s + 1, m, p.along()) - p.moved(s - 1, m, p.along())) / (2 * p.cell_m());
  const double contraction = -(p.moved(s, t, p.aside()) - p.moved(s, 0, p.aside())) / (t * p.cell_across_m());
  const double slope = (p.moved(s + 1, m, p.aside()) - p.moved(s - 1, m, p.aside())) / (2 * p.cell_m()) +
                       (p.moved(s, m + 1, p.along()) - p.moved(s, m - 1, p.along())) / (2 * p.cell_across_m());
  return {{"E_0", hang_modulus(p, m)},
          {"nu", strain > 0 ? contraction / strain : kMissing},
          {"skew", strain > 0 ? slope / strain : kMissing}};
}

/// Shear across the band between its held edges, at half their length: G v'' = -rho g.
double shear_modulus(const Sheet& p) {
  const int half = p.n() / 2, m = p.across() / 2, reach = m / 2;
  const double bulge =
      2 * p.moved(half, m, p.along()) - p.moved(half, m - reach, p.along()) - p.moved(half, m + reach, p.along());
  const double s = reach * p.cell_across_m();
  return over(p.weight() * s * s, bulge) / *p.scene.material.membrane_stiffness_N_per_m;
}

/// Gamma whose elastica drops by `drop` of its length; infinity above `most`.
double own_weight_of(double drop) {
  constexpr double kLeast = 1e-3, kMost = 100;
  const auto drops = [](double gamma) { return truth::cantilever_nodes(512, gamma).back()[1]; };
  if (!(drop < drops(kMost))) return INFINITY;
  double low = std::log(kLeast), high = std::log(kMost);
  if (!(drop > drops(kLeast))) return kMissing;
  constexpr int kHalvings = 34;  // to 1e-9
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = (low + high) / 2;
    (drops(std::exp(middle)) < drop ? low : high) = middle;
  }
  return std::exp((low + high) / 2);
}

double bend_modulus(const Sheet& p) {
  const double free_m = p.length_m() - p.cell_m();
  Vec3 down = p.scene.gravity_m_per_s2;
  for (double& d : down) d /= p.g();
  const double drop = p.moved(p.n(), p.across() / 2, down) / free_m;
  if (!std::isfinite(drop)) return kMissing;
  return p.weight() * free_m * free_m * free_m / own_weight_of(drop) / p.scene.material.bending_rigidity_N_m;
}

double diagonal_modulus(const Scene& scene, const std::vector<double>& x) {
  const Sheet p(scene, x);
  const int m = p.n() / 2;
  Vec3 down = scene.gravity_m_per_s2;
  for (double& d : down) d /= p.g();
  const auto w = [&](int k) { return p.moved(m + k, m - k, down); };
  const double s = std::sqrt(2.0) * p.cell_m();
  return over(p.weight() * s * s * s * s, w(-2) - 4 * w(-1) + 6 * w(0) - 4 * w(1) + w(2)) /
         scene.material.bending_rigidity_N_m;
}

std::map<std::string, double> mesh_moduli(Patch patch, const Scene& scene, const std::vector<double>& position) {
  const IsotropicModuli m = hanging_moduli(scene, position);
  if (patch == Patch::Mesh45) return {{"mesh_E_45", m.E}};
  if (patch == Patch::Mesh90) return {{"mesh_E_90", m.E}};
  return {{"mesh_E_0", m.E}, {"mesh_nu", m.nu}};
}

}  // namespace

std::map<std::string, double> patch_moduli(Patch patch, const Scene& scene, const std::vector<double>& position) {
  if (scene.cloth.mesh) return mesh_moduli(patch, scene, position);
  const Sheet p(scene, position);
  switch (patch) {
    case Patch::HangU:
      return hang(p);
    case Patch::HangV:
      return {{"E_90", hang(p).at("E_0")}};
    case Patch::HangStiffer:
      return {{"E_stiffer", hang(p).at("E_0")}};
    case Patch::HangStrip:
      return {{"E_strip", hang_modulus(p, p.across() / 2)},
              {"strip_border", hang_modulus(p, 0) / hang_modulus(p, p.across() / 2)}};
    case Patch::Shear:
      return {{"G", shear_modulus(p)}};
    case Patch::BendU:
      return {{"B_0", bend_modulus(p)}};
    case Patch::BendV:
      return {{"B_90", bend_modulus(p)}};
    case Patch::BendStiffer:
      return {{"B_stiffer", bend_modulus(p)}};
    default:
      return {{"B_45", diagonal_modulus(scene, position)}};
  }
}

double modulus_at_45(const std::map<std::string, double>& m) {
  constexpr double kSymmetric = 0.05;
  for (const char* name : {"E_0", "E_90", "nu", "skew", "G"})
    if (!m.contains(name)) return kMissing;
  if (!(std::abs(m.at("skew")) <= kSymmetric)) return kMissing;
  const double e = m.at("E_0");
  return 4 / (1 / e + 1 / m.at("E_90") - 2 * m.at("nu") / e + 1 / m.at("G"));
}

}  // namespace clothbench
