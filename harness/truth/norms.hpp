#pragma once
#include <span>

#include "truth/lattice.hpp"

namespace clothbench::truth {

// Distances between a run and its truth, with one definition for every scene. A value that is not finite gives NaN,
// never a small error. Throws Error for sizes that do not match or a scale that is not positive.

/// e2: area-weighted RMS distance of the lattice's points (x, y, z each) over `scale`. The scale is the longer side for
/// positions, and sqrt(g * longer side) for speeds (ev).
double lattice_rms_error(const MaterialLattice&, std::span<const double> values, std::span<const double> truth,
                         double scale);

/// Greatest distance of any point over `scale`.
double lattice_greatest_error(const MaterialLattice&, std::span<const double> values, std::span<const double> truth,
                              double scale);

/// E2 over a run: sqrt of the mean square over time, e2^2 linear between the times (ascending, 2 or more).
double time_rms(std::span<const double> times_s, std::span<const double> errors);

/// Error of one quantity over the scale that its reference case states.
double quantity_error(double value, double truth, double scale);

/// Statistics of (strain - true strain) over edges: RMS and, signed, the 99th percentile (nearest rank) and the
/// maximum.
struct StretchError {
  double rms, p99, greatest;
};
StretchError stretch_error(std::span<const double> strains, std::span<const double> truth);

}  // namespace clothbench::truth
