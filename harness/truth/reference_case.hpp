#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::truth {

/// The 33 x 33 material points at which any mesh is compared with its exact solution: a regular lattice over the rest
/// rectangle [0, width] x [0, height], u fastest, with Voronoi areas (half a cell at an edge, 1/4 at a corner).
struct MaterialLattice {
  static constexpr int kSide = 33;

  MaterialLattice(double width_m, double height_m);
  std::size_t size() const { return points_m.size(); }

  double longer_side_m;
  std::vector<std::array<double, 2>> points_m;
  std::vector<double> areas_m2;
};

/// Interpolates values at a mesh's vertices to the lattice's points, barycentrically in the rest rectangle. Made once
/// per mesh. A point on an edge belongs to the triangle listed first; both triangles give the same value.
class LatticeSampler {
 public:
  /// `rest_m`: u, v per vertex; `triangles`: 3 indices per triangle, with any winding. Throws Error if a point of the
  /// lattice is outside every triangle by more than 1e-9 of the longer side.
  LatticeSampler(const MaterialLattice&, std::span<const double> rest_m, std::span<const std::uint32_t> triangles);

  /// `values`: x, y, z per vertex; returns x, y, z per point of the lattice.
  std::vector<double> sample(std::span<const double> values) const;

 private:
  struct Weights {
    std::array<std::uint32_t, 3> vertex;
    std::array<double, 3> weight;
  };
  std::vector<Weights> points_;
};

// Distances between a run and its exact solution, defined alike for every scene. Both inputs have the same points,
// edges or times. A value that is not finite gives NaN, never a small error.

/// e2: area-weighted RMS distance of the lattice's points (x, y, z each), divided by `scale`, the longer side.
double lattice_rms_error(const MaterialLattice&, std::span<const double> values, std::span<const double> truth,
                         double scale);

/// E2 of a run: square root of the time average of e2^2, linear between the times (ascending, at least 2).
double time_rms(std::span<const double> times_s, std::span<const double> errors);

/// Error of a quantity divided by the scale that its reference case states.
double quantity_error(double value, double truth, double scale);

/// Statistics of (strain - exact strain) over edges, signed: the 99th percentile (nearest rank) and the maximum.
std::array<double, 2> stretch_error(std::span<const double> strains, std::span<const double> truth);

/// The exact solution of one scene with a `truth` block; all parameters come from the scene. Reference cases are strips
/// along u (or sheets) whose rows move alike. So a solution is one position per column of the grid, on the sheet's
/// middle line; a vertex is at its column's position plus its offset along axis_v. A triangle mesh has no exact
/// solution of its own; its vertices are compared with the continuum's solution, and the material lattice provides its
/// columns.
///
/// `columns` is the solution on the same grid, if there is one (a chain with the same number of links, springs,
/// hinges); a run's distance from it has no spatial discretisation error. `continuum` is the solution without a grid,
/// or on a grid so fine that its error does not matter.
struct ReferenceCase {
  std::string name;
  bool settles = false;       ///< the solution is a shape at rest: only a run's end is compared
  bool by_quantity = false;   ///< runs are ranked by the quantity's error; otherwise by the distance of the positions
  bool smooth_law = false;    ///< `columns` follow the continuum's law, so their grid adds an error
  double quantity_scale = 1;  ///< divisor of errors of the quantity, same unit

  std::function<std::vector<Vec3>(int frame)> columns;     ///< [m]
  std::function<std::vector<double>(int frame)> vertices;  ///< [m], 3 each; null: `columns` suffice
  std::function<Vec3(double share, int frame)> continuum;  ///< at a fraction 0..1 of the width; null: use `columns`
  std::function<double(const std::vector<Vec3>& columns)> quantity;  ///< of a run's columns (means over the rows)
};

/// The reference case that a scene names, or none. Throws Error if the scene does not meet the case's requirements.
std::optional<ReferenceCase> reference_case_of(const Scene&);

/// The tolerance of a reference case: the largest distance from the exact solution at which a run is correct (errors of
/// mesh and float32 are added, metrics/truth_errors.hpp), and the error by which runs are ranked.
struct Tolerance {
  std::string reference_case;
  /// Tolerance as a fraction of the exact motion (cloth that stays at its start has the error 1). A motion that is too
  /// small fails by the same amount as one that is too large.
  double of_motion = 0;
  double at_rest = 0;  ///< fraction of the longer side, if the exact solution does not move; 0: it always moves
  std::string why, ranking;
};

/// One entry per reference case.
const std::vector<Tolerance>& tolerances();

/// Throws Error if there is none with that name.
const Tolerance& tolerance_of(const std::string& reference_case);

/// Means of `values` (3 per vertex) over the rows, one per column. For a mesh: over the rows of the material lattice.
std::vector<Vec3> column_means(const Cloth&, const std::vector<double>& values);

/// Positions [m] of all vertices (3 each) of a reference case in a frame.
std::vector<double> vertex_positions(const Cloth&, const ReferenceCase&, int frame);

/// Vertex positions (3 per vertex) from points on the middle line, one per column, plus each row's offset along axis_v.
std::vector<double> vertex_values(const Cloth&, const std::vector<Vec3>& columns);

/// Sampler from a cloth's vertices to the material lattice. Throws Error if its triangles do not cover the rectangle.
LatticeSampler sampler_of(const Cloth&);

}  // namespace clothbench::truth
