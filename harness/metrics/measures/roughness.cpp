// Whether a fold is smooth at the size of the mesh's cells, or shows the triangles.
#include <algorithm>
#include <cmath>
#include <set>

#include "metrics/registry.hpp"

namespace clothbench {
namespace {

/// The graph Laplacian at a vertex is the mean of its neighbours minus the vertex (Sorkine et al. 2004, Laplacian
/// Surface Editing, section 3). The measure is the difference between a vertex's Laplacian and the mean Laplacian of
/// its neighbours: RMS over the vertices whose neighbours all lie inside, divided by the mean edge length. On a
/// smooth surface, this difference relative to the Laplacian vanishes with the square of the cell size.
double roughness(const RunView& r) {
  const Cloth& cloth = r.scene.cloth;
  const std::size_t n = cloth.vertex_count();
  if (!r.whole() || r.pass.position.size() < 3 * n) return kMissing;
  const std::size_t first = r.pass.position.size() / 3 - n;
  const auto x = [&](std::size_t v) { return vertex_at(r.pass.position, first + v); };
  std::vector<std::set<std::uint32_t>> beside(n);
  std::vector<std::size_t> triangles_at(n, 0);
  for (const auto& t : triangles(cloth))
    for (const std::uint32_t v : t) beside[v].insert(t.begin(), t.end()), ++triangles_at[v];
  std::vector<Vec3> laplacian(n);
  double edges_m = 0, edges = 0;
  for (std::uint32_t v = 0; v < n; ++v) {
    beside[v].erase(v);
    for (const std::uint32_t w : beside[v]) {
      const Vec3 edge = minus(x(w), x(v));
      laplacian[v] = plus(laplacian[v], scaled(1.0 / static_cast<double>(beside[v].size()), edge));
      edges_m += length(edge), ++edges;
    }
  }
  const auto inner = [&](std::uint32_t v) { return triangles_at[v] == beside[v].size(); };
  double squares = 0, count = 0;
  for (std::uint32_t v = 0; v < n; ++v) {
    if (!inner(v) || !std::all_of(beside[v].begin(), beside[v].end(), inner)) continue;
    Vec3 d = laplacian[v];
    for (const std::uint32_t w : beside[v])
      d = minus(d, scaled(1.0 / static_cast<double>(beside[v].size()), laplacian[w]));
    squares += dot(d, d), ++count;
  }
  return std::sqrt(squares / count) / (edges_m / edges);
}

}  // namespace

MetricGroup roughness_metrics() {
  return {
      {},
      {{.name = "roughness_end",
        .from = own(
            {},
            "variation of the surface's Laplacian between neighbouring vertices, RMS, over the mean edge, at the end",
            roughness, "1"),
        .present = [](const RunView& r) { return !r.scene.colliders.empty(); }}}};
}

}  // namespace clothbench
