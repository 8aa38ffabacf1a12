#pragma once
// Triangle meshes made without a scene file, and closed forms of isotropic sheets and beams to compare them with.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "scenario/cloth_mesh.hpp"
#include "sheets.hpp"

namespace clothbench {

inline Scene of_mesh(ClothMesh mesh, std::vector<std::uint32_t> pins) {
  Scene s = sheet(2, 2);
  const auto [longest, second] = longest_sides(mesh);
  s.cloth.columns = static_cast<int>(mesh.vertices.size());
  s.cloth.rows = 1;
  s.cloth.width_m = longest;
  s.cloth.height_m = second;
  s.cloth.mesh = std::make_shared<const ClothMesh>(std::move(mesh));
  s.needs = {Feature::Stretch, Feature::ClothMesh};
  s.pins.vertices = std::move(pins);
  if (!s.pins.vertices.empty()) s.needs.add(Feature::Pins);
  return s;
}

/// A level strip of irregular triangles, 1 m along x and 0.25 m wide, with `cells` cells along x; the first is clamped.
inline Scene clamped_strip(int cells, double share, unsigned seed, double rigidity_N_m) {
  ClothMesh mesh = drawn_mesh({1, 0.25, cells, 0.5, share, seed, true});
  std::vector<std::uint32_t> clamp = mesh.groups.at("clamp");
  std::sort(clamp.begin(), clamp.end());
  Scene s = of_mesh(std::move(mesh), std::move(clamp));
  s.material.bending_rigidity_N_m = rigidity_N_m;
  s.needs.add(Feature::Bend);
  return s;
}

inline Eigen::VectorXd masses_of(const Scene& s) {
  const std::vector<double> m = vertex_masses(s);
  return Eigen::VectorXd::Map(m.data(), static_cast<Eigen::Index>(m.size()));
}

inline std::vector<Eigen::Index> free_vertices(const Scene& s) {
  std::vector<Eigen::Index> out;
  for (std::uint32_t v = 0; v < s.cloth.vertex_count(); ++v)
    if (!std::binary_search(s.pins.vertices.begin(), s.pins.vertices.end(), v)) out.push_back(v);
  return out;
}

/// Mean deflection of the free end of a clamped strip under a load of 1 N/m2, divided by a beam's, L^4 / (8 B).
inline double tip_over_beam(const Scene& s, int cells, const Eigen::VectorXd& deflection_m) {
  double tip = 0;
  const std::vector<std::uint32_t>& end = s.cloth.mesh->groups.at("u1");
  for (const std::uint32_t v : end) tip += deflection_m[v] / static_cast<double>(end.size());
  return tip / (std::pow((cells - 1.0) / cells, 4) / (8 * s.material.bending_rigidity_N_m));
}

/// The same ratio, with the deflection computed from the matrix of the strip's bending energy.
inline double tip_over_beam(const Scene& s, int cells, const Eigen::MatrixXd& bending) {
  const std::vector<Eigen::Index> free = free_vertices(s);
  Eigen::VectorXd deflection = Eigen::VectorXd::Zero(bending.rows());
  const Eigen::VectorXd load = masses_of(s)(free) / s.cloth.areal_density_kg_per_m2;
  const Eigen::VectorXd solved = Eigen::MatrixXd(bending(free, free)).ldlt().solve(load);
  deflection(free) = solved;
  return tip_over_beam(s, cells, deflection);
}

/// The same ratio, with the deflection at the end of a motion under gravity.
inline double tip_over_beam_at_end(const Scene& s, int cells, ClothSolver& solver) {
  solver.load(s);
  const std::vector<double> start = initial_positions(s), end = after(solver, s, s.time.frames()).position;
  Eigen::VectorXd deflection(s.cloth.vertex_count());
  for (Eigen::Index v = 0; v < deflection.size(); ++v)
    deflection[v] = start[static_cast<std::size_t>(3 * v + 1)] - end[static_cast<std::size_t>(3 * v + 1)];
  return tip_over_beam(s, cells,
                       Eigen::VectorXd(deflection / (s.cloth.areal_density_kg_per_m2 * -s.gravity_m_per_s2[1])));
}

/// Energy of a triangle under constant strain (xx, yy, xy), computed from the stiffness of its edges 0-1, 1-2 and 2-0,
/// divided by the energy of an isotropic sheet (plane stress, Poisson's ratio 1/3).
inline double energy_over_sheet(const std::array<Eigen::Vector2d, 3>& corners, const Eigen::Matrix3d& stiffness,
                                double membrane_stiffness_N_per_m, const Eigen::Vector3d& strain) {
  const double nu = 1.0 / 3, trace = strain[0] + strain[1];
  Eigen::Vector3d longer;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector2d side = corners[(k + 1) % 3] - corners[k];
    longer[static_cast<Eigen::Index>(k)] =
        (strain[0] * side.x() * side.x() + strain[1] * side.y() * side.y() + 2 * strain[2] * side.x() * side.y()) /
        side.norm();
  }
  const Eigen::Vector2d p = corners[1] - corners[0], q = corners[2] - corners[0];
  const double area = std::abs(p.x() * q.y() - p.y() * q.x()) / 2,
               squares = strain[0] * strain[0] + strain[1] * strain[1] + 2 * strain[2] * strain[2];
  return 0.5 * longer.dot(stiffness * longer) /
         (area * membrane_stiffness_N_per_m / (2 * (1 - nu * nu)) * (nu * trace * trace + (1 - nu) * squares));
}

}  // namespace clothbench
