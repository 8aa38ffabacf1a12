#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace clothbench::truth {

/// A sheet of point masses on a grid, with springs along the grid and on both diagonals of every cell: the homogenised
/// isotropic sheet of Poisson ratio 1/3 and uniaxial stiffness Y. With cells a x b (b across a spring along a), springs
/// along a have the stiffness Y max(9/8 b/a - 3/8 a/b, 0.1 b/a), half on the border, and diagonals 3/16 Y (a^2 +
/// b^2)/(a b). Masses are areal density times the area nearest to each vertex. It is the truth at equal resolution for
/// elastic cloth with shear. Vertex (i, j) has the index j * columns + i.
///
/// Source: Newton's second law with forces along the springs, stiffness times extension (any rotation). Integrated by
/// Boost.Odeint (Runge-Kutta-Fehlberg 7(8), adaptive). No damping, no bending stiffness.
struct SpringSheet {
  int columns = 2, rows = 2;
  double width_m = 1, height_m = 1;  ///< along columns and rows
  double areal_density_kg_per_m2 = 0.2;
  double membrane_stiffness_N_per_m = 1000;
  std::array<double, 3> gravity_m_per_s2{};
  std::vector<std::uint32_t> held;  ///< vertices whose motion is given
};

/// Position of `held[k]` at `times_s[time]`; linear in between.
using HeldPosition = std::function<std::array<double, 3>(std::size_t k, std::size_t time)>;

/// Positions [m], 3 a vertex, at `times_s` (ascending from 0), from `start_m` at rest. `tolerance`: error per step of
/// positions over the longer side, and of speeds over that of a stretch wave that crosses it in a cell's time. Throws
/// Error for bad arguments, or if the integrator cannot make progress.
std::vector<std::vector<double>> move_sheet(const SpringSheet&, std::span<const double> start_m,
                                            std::span<const double> times_s, const HeldPosition&,
                                            double tolerance = 1e-11);

}  // namespace clothbench::truth
