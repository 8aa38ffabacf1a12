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

/// The 33 x 33 material points at which any mesh is compared with its truth: a regular lattice over the rest rectangle
/// [0, width] x [0, height], u fastest, with Voronoi areas (half a cell at an edge, 1/4 at a corner).
struct MaterialLattice {
  static constexpr int kSide = 33;

  MaterialLattice(double width_m, double height_m);
  std::size_t size() const { return points_m.size(); }

  double longer_side_m;
  std::vector<std::array<double, 2>> points_m;
  std::vector<double> areas_m2;
};

/// Interpolates values at a mesh's vertices to the lattice's points, barycentrically in the rest rectangle. Made once
/// per mesh. A point on an edge belongs to the triangle listed first; either gives the same value.
class LatticeSampler {
 public:
  /// `rest_m`: u, v per vertex; `triangles`: 3 per triangle, of either orientation. Throws Error if a point
  /// of the lattice lies in no triangle (by more than 1e-9 of the longer side).
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

// Distances between a run and its truth, with one definition for every scene. A value that is not finite gives NaN,
// never a small error. Both sides have the same points, edges or times.

/// e2: area-weighted RMS distance of the lattice's points (x, y, z each) over `scale`. The scale is the longer side.
double lattice_rms_error(const MaterialLattice&, std::span<const double> values, std::span<const double> truth,
                         double scale);

/// E2 over a run: sqrt of the mean square over time, e2^2 linear between the times (ascending, 2 or more).
double time_rms(std::span<const double> times_s, std::span<const double> errors);

/// Error of one quantity over the scale that its reference case states.
double quantity_error(double value, double truth, double scale);

/// Statistics of (strain - true strain) over edges, signed: the 99th percentile (nearest rank) and the maximum.
std::array<double, 2> stretch_error(std::span<const double> strains, std::span<const double> truth);

/// The exact solution of one scene with a `truth` block; all parameters are the scene's. Reference cases are strips
/// along u (or sheets) whose rows move alike. So a solution is one position for each column of the grid, on the middle
/// line of the sheet; a vertex lies at its column's position plus its offset along axis_v. A triangle mesh has no exact
/// solution of its own; it is compared with the continuum's at its vertices, and the material lattice provides its
/// columns.
///
/// `columns` is the solution for the same mesh, if there is one (a chain of as many links, springs, hinges); a run's
/// distance from it has no spatial discretisation error. `continuum` is the solution without a mesh, or on a mesh so
/// fine that the mesh's error does not matter.
struct ReferenceCase {
  std::string name;
  bool settles = false;       ///< the solution is the shape at rest: only a run's end is compared
  bool by_quantity = false;   ///< runs are ranked by the quantity's error; otherwise by the distance of the positions
  bool smooth_law = false;    ///< `columns` move by the continuum's law, so their own mesh adds an error
  double quantity_scale = 1;  ///< divisor of errors of the quantity, same unit

  std::function<std::vector<Vec3>(int frame)> columns;     ///< [m]
  std::function<std::vector<double>(int frame)> vertices;  ///< [m], 3 each; null: `columns` say all
  std::function<Vec3(double share, int frame)> continuum;  ///< at a share 0..1 of the width; null: as `columns`
  std::function<double(const std::vector<Vec3>& columns)> quantity;  ///< of a run's columns (means over the rows)
};

/// The reference case that a scene names, or none. Throws Error if the scene does not meet its requirements.
std::optional<ReferenceCase> reference_case_of(const Scene&);

/// The tolerance of a reference case, for any parameters: how far a run may be from the exact solution and still be
/// right (errors of mesh and float32 come on top, metrics/truth_errors.hpp), and the error by which runs are ranked.
struct Tolerance {
  std::string reference_case;
  /// Tolerance as a fraction of the exact motion (cloth that keeps its start has the error 1), at any parameters. Too
  /// small a motion fails by the same amount as too large a one.
  double of_motion = 0;
  double at_rest = 0;  ///< share of the longer side, for cloth that the exact solution does not move; 0: always moves
  std::string why, ranking;
};

/// One entry per reference case.
const std::vector<Tolerance>& tolerances();

/// Throws Error if there is none of that name.
const Tolerance& tolerance_of(const std::string& reference_case);

/// Means over the rows of `values` (3 per vertex), one per column. For a mesh: over the rows of the material lattice.
std::vector<Vec3> column_means(const Cloth&, const std::vector<double>& values);

/// Positions of all vertices (3 each) of a reference case in a frame [m].
std::vector<double> vertex_positions(const Cloth&, const ReferenceCase&, int frame);

/// Vertex positions (3 per vertex) from the middle of each column; each row adds its position along axis_v.
std::vector<double> vertex_values(const Cloth&, const std::vector<Vec3>& columns);

/// From a cloth's vertices to the material lattice. Throws Error if its triangles do not cover the rectangle.
LatticeSampler sampler_of(const Cloth&);

}  // namespace clothbench::truth
