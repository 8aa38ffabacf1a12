#pragma once
#include <span>

#include "truth/lattice.hpp"

namespace clothbench::truth {

// Distances between a run and its truth: one definition for every scene. Anything that isn't finite gives NaN, never a
// small error. Throws Error where sizes don't fit or a scale isn't positive.

/// e2: area-weighted RMS distance of the lattice's points (x, y, z each) over `scale`; of positions over the longer
/// side, of speeds (ev) over sqrt(g * longer side).
double lattice_rms_error(const MaterialLattice&, std::span<const double> values, std::span<const double> truth,
                         double scale);

/// Greatest distance of a point over `scale`.
double lattice_greatest_error(const MaterialLattice&, std::span<const double> values, std::span<const double> truth,
                              double scale);

/// E2 over a run: sqrt of the mean square over time, e2^2 linear between the times (ascending, 2 or more).
double time_rms(std::span<const double> times_s, std::span<const double> errors);

/// Significant correct digits, -log10(error). Source: Hairer & Wanner, Solving Ordinary Differential Equations II.
double correct_digits(double error);

/// Error of one quantity over the scale its scene states.
double quantity_error(double value, double truth, double scale);

/// Of (strain - true strain) over edges: RMS, and, signed, the 99th percentile (nearest rank) and the greatest.
struct StretchError {
  double rms, p99, greatest;
};
StretchError stretch_error(std::span<const double> strains, std::span<const double> truth);

/// Of energies over a run, over `scale` = weight * length: greatest distance from the first; the last less the first;
/// the greatest rise above the first and what was put in by moving pins (`pin_work`, as many values, or none for static
/// pins).
struct EnergyError {
  double drift, end, gain;
};
EnergyError energy_error(std::span<const double> energies, std::span<const double> pin_work, double scale);

}  // namespace clothbench::truth
