#include "crumpled.hpp"

#include <algorithm>
#include <cstdint>

#include "clothbench/vector.hpp"
#include "constraints.hpp"

namespace clothbench::pbd_gpu {
namespace {

constexpr double kShort = 0.5, kLong = 1.5;  // of a link's rest length
constexpr double kAside = 1e-3;              // of a cell; far above float32's rounding, far below what is visible

/// Pseudo-random number in [-1, 1) from a counter (SplitMix64; Steele, Lea & Flood 2014).
double scattered(std::uint64_t n) {
  std::uint64_t z = (n + 1) * 0x9E3779B97F4A7C15u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1;
}

}  // namespace

bool starts_crumpled(const Scene& scene) {
  if (scene.cloth.start.at_rest()) return false;
  const std::vector<double> x = initial_positions(scene);
  const std::vector<Edge> links = edges(scene.cloth, EdgeKind::Structural);
  return std::any_of(links.begin(), links.end(), [&](const Edge& e) {
    const double l = norm(minus(vertex_at(x, e.a), vertex_at(x, e.b)));
    return l < kShort * e.rest_m || l > kLong * e.rest_m;
  });
}

void break_symmetry(const Scene& scene, const std::vector<float>& inverse_mass, std::vector<double>& x) {
  const double aside = kAside * std::min(scene.cloth.du(), scene.cloth.dv());
  for (std::size_t k = 0; k < x.size(); ++k)
    if (inverse_mass[k / 3] > 0) x[k] += aside * scattered(k);
}

}  // namespace clothbench::pbd_gpu
