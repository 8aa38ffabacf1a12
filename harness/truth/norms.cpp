#include "truth/norms.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "clothbench/error.hpp"

namespace clothbench::truth {
namespace {

constexpr int kSide = MaterialLattice::kSide;

/// Lattice indices that [low, high] covers, with room for rounding.
std::array<int, 2> covered(double low, double high, double side) {
  const double cell = side / (kSide - 1);
  const auto clamp = [](double i) { return static_cast<int>(std::clamp(i, -1.0, 1.0 * kSide)); };
  return {std::max(0, clamp(std::floor(low / cell - 1e-6))), std::min(kSide - 1, clamp(std::ceil(high / cell + 1e-6)))};
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Infinity counts as NaN: a mean with one infinite part says nothing.
double finite_or_nan(double value) { return std::isfinite(value) ? value : kNan; }

double square_distance(std::span<const double> a, std::span<const double> b, std::size_t point) {
  double sum = 0;
  for (std::size_t k = 3 * point; k < 3 * point + 3; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return sum;
}

}  // namespace

MaterialLattice::MaterialLattice(double width, double height) : width_(width), height_(height) {
  const double cell = width / (kSide - 1) * height / (kSide - 1);
  const auto share = [](int i) { return i == 0 || i == kSide - 1 ? 0.5 : 1.0; };
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      points_.push_back({width * i / (kSide - 1), height * j / (kSide - 1)});
      areas_.push_back(cell * share(i) * share(j));
    }
}

double MaterialLattice::longer_side_m() const { return std::max(width_, height_); }

LatticeSampler::LatticeSampler(const MaterialLattice& lattice, std::span<const double> rest,
                               std::span<const std::uint32_t> triangles)
    : points_(lattice.size()) {
  const double width = lattice.points_m().back()[0], height = lattice.points_m().back()[1];
  // How far a point lies outside the best triangle so far, as its smallest barycentric weight.
  std::vector<double> inside(lattice.size(), -std::numeric_limits<double>::infinity());
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
    std::array<std::array<double, 2>, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t v = triangles[t + k];
      p[k] = {rest[2 * v], rest[2 * v + 1]};
    }
    const auto cross = [](const auto& a, const auto& b, const auto& c) {
      return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    };
    const double area = cross(p[0], p[1], p[2]);
    if (!(area != 0)) continue;
    const auto [u0, u1] = std::minmax({p[0][0], p[1][0], p[2][0]});
    const auto [v0, v1] = std::minmax({p[0][1], p[1][1], p[2][1]});
    const auto columns = covered(u0, u1, width), rows = covered(v0, v1, height);
    for (int j = rows[0]; j <= rows[1]; ++j)
      for (int i = columns[0]; i <= columns[1]; ++i) {
        const auto at = static_cast<std::size_t>(j * kSide + i);
        const auto& x = lattice.points_m()[at];
        const std::array<double, 3> w{cross(x, p[1], p[2]) / area, cross(p[0], x, p[2]) / area,
                                      cross(p[0], p[1], x) / area};
        const double least = std::min({w[0], w[1], w[2]});
        if (inside[at] >= 0 || !(least > inside[at])) continue;
        inside[at] = least;
        points_[at] = {{triangles[t], triangles[t + 1], triangles[t + 2]}, w};
      }
  }
  // A weight of -1e-9 is at most that part of a triangle's height, no greater than the longer side.
  for (std::size_t s = 0; s < inside.size(); ++s)
    if (!(inside[s] >= -1e-9))
      throw Error("argument triangles: expected to cover the rest rectangle; the point (" +
                  std::to_string(lattice.points_m()[s][0]) + ", " + std::to_string(lattice.points_m()[s][1]) +
                  ") m is in none");
}

std::vector<double> LatticeSampler::sample(std::span<const double> values) const {
  std::vector<double> out(3 * points_.size());
  for (std::size_t s = 0; s < points_.size(); ++s)
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t corner = 0; corner < 3; ++corner)
        out[3 * s + k] += points_[s].weight[corner] * values[3 * points_[s].vertex[corner] + k];
  return out;
}

double lattice_rms_error(const MaterialLattice& lattice, std::span<const double> values, std::span<const double> truth,
                         double scale) {
  double sum = 0, area = 0;
  for (std::size_t s = 0; s < lattice.size(); ++s) {
    sum += lattice.areas_m2()[s] * square_distance(values, truth, s);
    area += lattice.areas_m2()[s];
  }
  return finite_or_nan(std::sqrt(sum / area) / scale);
}

double time_rms(std::span<const double> times, std::span<const double> errors) {
  double sum = 0;
  for (std::size_t i = 1; i < times.size(); ++i)
    sum += 0.5 * (times[i] - times[i - 1]) * (errors[i] * errors[i] + errors[i - 1] * errors[i - 1]);
  return finite_or_nan(std::sqrt(sum / (times.back() - times.front())));
}

double quantity_error(double value, double truth, double scale) {
  return finite_or_nan(std::abs(value - truth) / scale);
}

StretchError stretch_error(std::span<const double> strains, std::span<const double> truth) {
  std::vector<double> excess(strains.size());
  for (std::size_t i = 0; i < excess.size(); ++i) {
    excess[i] = strains[i] - truth[i];
    if (!std::isfinite(excess[i])) return {kNan, kNan};
  }
  std::sort(excess.begin(), excess.end());
  const auto rank = static_cast<std::size_t>(std::ceil(0.99 * static_cast<double>(excess.size())));
  return {excess[rank - 1], excess.back()};
}

}  // namespace clothbench::truth
