#include "truth/norms.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "clothbench/error.hpp"
#include "truth/checks.hpp"

namespace clothbench::truth {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

void same_size(std::size_t got, std::size_t expected, const char* argument) {
  if (got != expected)
    throw Error(std::string("argument ") + argument + ": expected " + std::to_string(expected) + " values, got " +
                std::to_string(got));
}

/// Infinity counts as NaN: a mean with one infinite part says nothing.
double finite_or_nan(double value) { return std::isfinite(value) ? value : kNan; }

double max_or_nan(double a, double b) { return std::isnan(a) || a > b ? a : b; }

double square_distance(std::span<const double> a, std::span<const double> b, std::size_t point) {
  double sum = 0;
  for (std::size_t k = 3 * point; k < 3 * point + 3; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return sum;
}

void check(const MaterialLattice& lattice, std::span<const double> values, std::span<const double> truth,
           double scale) {
  same_size(values.size(), 3 * lattice.size(), "values");
  same_size(truth.size(), 3 * lattice.size(), "truth");
  positive(scale, "scale");
}

}  // namespace

double lattice_rms_error(const MaterialLattice& lattice, std::span<const double> values, std::span<const double> truth,
                         double scale) {
  check(lattice, values, truth, scale);
  double sum = 0, area = 0;
  for (std::size_t s = 0; s < lattice.size(); ++s) {
    sum += lattice.areas_m2()[s] * square_distance(values, truth, s);
    area += lattice.areas_m2()[s];
  }
  return finite_or_nan(std::sqrt(sum / area) / scale);
}

double lattice_greatest_error(const MaterialLattice& lattice, std::span<const double> values,
                              std::span<const double> truth, double scale) {
  check(lattice, values, truth, scale);
  double greatest = 0;
  for (std::size_t s = 0; s < lattice.size(); ++s) greatest = max_or_nan(greatest, square_distance(values, truth, s));
  return finite_or_nan(std::sqrt(greatest) / scale);
}

double time_rms(std::span<const double> times, std::span<const double> errors) {
  same_size(errors.size(), times.size(), "errors");
  if (times.size() < 2) throw Error("argument times_s: expected 2 times or more");
  double sum = 0;
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (!(times[i] > times[i - 1])) throw Error("argument times_s: expected ascending times");
    sum += 0.5 * (times[i] - times[i - 1]) * (errors[i] * errors[i] + errors[i - 1] * errors[i - 1]);
  }
  return finite_or_nan(std::sqrt(sum / (times.back() - times.front())));
}

double quantity_error(double value, double truth, double scale) {
  return finite_or_nan(std::abs(value - truth) / positive(scale, "scale"));
}

StretchError stretch_error(std::span<const double> strains, std::span<const double> truth) {
  same_size(truth.size(), strains.size(), "truth");
  if (strains.empty()) throw Error("argument strains: expected 1 or more");
  std::vector<double> excess(strains.size());
  double squares = 0;
  for (std::size_t i = 0; i < excess.size(); ++i) {
    excess[i] = strains[i] - truth[i];
    if (!std::isfinite(excess[i])) return {kNan, kNan, kNan};
    squares += excess[i] * excess[i];
  }
  std::sort(excess.begin(), excess.end());
  const auto rank = static_cast<std::size_t>(std::ceil(0.99 * static_cast<double>(excess.size())));
  return {std::sqrt(squares / static_cast<double>(excess.size())), excess[rank - 1], excess.back()};
}

}  // namespace clothbench::truth
