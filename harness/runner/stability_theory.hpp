#pragma once
#include <string>

#include "clothbench/scene.hpp"

namespace clothbench {

/// Highest angular frequency of the flat, unstretched sheet's membrane [1/s]; infinite if inextensible.
///
/// Strips without shear are chains: 2 c/d, d the shorter cell. A sheet with shear consists of central springs k, whose
/// sum over a vertex is S = sum k n n^T. Then omega^2 = 2 lambda_max(S)/m, reached by the wave that changes sign from
/// vertex to vertex; on square cells of side a, omega is sqrt(4.5 Y/rho)/a.
double highest_frequency_rad_per_s(const Scene&);

/// The greatest x of a map's row according to a theory, computed from the row's scene; NaN where it gives none.
///   explicit-limit       x is the time step: omega_max dt = 2
///   float32-stagnation   x is the distance from the origin: g h^2 below half an ulp of it, h the substep
///   substep-per-cell     x is the displacement per frame over the cell: one cell a substep
/// Throws Error on another name.
double theory(const std::string& name, const Scene&, int substeps);

/// Label of the theory, for legends.
std::string theory_label(const std::string& name);

}  // namespace clothbench
