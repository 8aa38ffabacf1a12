#pragma once
#include <span>
#include <string>

namespace clothbench::truth {

/// A value with its source.
struct SourcedValue {
  double value = 0;
  double uncertainty = 0;     ///< half width; 0 if exact up to rounding
  bool interpolated = false;  ///< between the rows of a table, not evaluated
  std::string basis;          ///< in words, for captions
};

/// Critical load parameter q L^3/sqrt(EI GJ) of a narrow cantilever under its own weight q per length in the plane of
/// its greater stiffness, 6 j with j the first zero of J_{-1/6}: 12.853764. Source: Michell 1899, Prandtl 1899;
/// Timoshenko & Gere, Theory of Elastic Stability, ch. 6.
double michell_prandtl_constant();

/// Critical Gamma = rho g L^3/B at which a cantilever sheet with vertical width w buckles laterally, for w/L -> 0. With
/// EI = (1 - nu^2) B w and GJ = 2 (1 - nu) B w of an isotropic plate: 6 j (1 - nu) sqrt(2 (1 + nu)). Errors of rounding
/// only. Valid for -1 < nu <= 1/2, Error otherwise.
double narrow_lateral_buckling(double poisson_ratio);

struct LateralBucklingRow {
  double poisson_ratio, width_over_length, own_weight, uncertainty;
};
std::span<const LateralBucklingRow> lateral_buckling_table();

/// The same for a sheet of any width: the formula at w/L = 0, otherwise INTERPOLATED in a table and marked so. The
/// table (lateral_buckling_table.hpp) was computed for this project: Kirchhoff plate under the exact plane-stress
/// prestress of its weight, bicubic C1 finite elements on two meshes, whose difference is a row's uncertainty; its
/// limit w/L -> 0 agrees with Michell and Prandtl. The ratio to the narrow limit is interpolated by Hermite cubics
/// (makima) along w/L and polynomials along nu. The uncertainty is the sum of the rows' uncertainty, twice the
/// difference from linear interpolation along w/L, and the difference from one degree less along nu; this covers every
/// row when it is left out. Valid for 0 <= nu <= 1/3 with w/L <= 2, and nu <= 1/2 with w/L <= 1; Error otherwise.
/// `rows`: the table to interpolate, or part of it (a test of the interpolation leaves rows out), at least 3 for each
/// Poisson's ratio.
SourcedValue lateral_buckling(double width_over_length, double poisson_ratio,
                              std::span<const LateralBucklingRow> rows = lateral_buckling_table());

}  // namespace clothbench::truth
