#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace clothbench::truth {

/// The 33 x 33 material points at which every mesh is compared with its truth, at any resolution: a regular lattice
/// over the rest rectangle [0, width] x [0, height], row by row (u fastest), with Voronoi areas (half a cell on an
/// edge, a quarter at a corner).
class MaterialLattice {
 public:
  static constexpr int kSide = 33;

  MaterialLattice(double width_m, double height_m);
  std::size_t size() const { return points_.size(); }
  const std::vector<std::array<double, 2>>& points_m() const { return points_; }
  const std::vector<double>& areas_m2() const { return areas_; }
  double longer_side_m() const;

 private:
  double width_, height_;
  std::vector<std::array<double, 2>> points_;
  std::vector<double> areas_;
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
struct StretchError {
  double p99, greatest;
};
StretchError stretch_error(std::span<const double> strains, std::span<const double> truth);

}  // namespace clothbench::truth
