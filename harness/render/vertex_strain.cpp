#include <cmath>

#include "render/vertex_values.hpp"

namespace clothbench::render {

std::vector<float> vertex_strain(const Cloth& cloth, std::span<const double> x) {
  std::vector<float> out(cloth.vertex_count(), 0);
  const auto apart = [&](std::uint32_t a, std::uint32_t b) {
    return std::hypot(x[3 * a] - x[3 * b], x[3 * a + 1] - x[3 * b + 1], x[3 * a + 2] - x[3 * b + 2]);
  };
  for (const Edge& e : edges(cloth, EdgeKind::Structural)) {
    const auto strain = static_cast<float>(apart(e.a, e.b) / e.rest_m - 1);
    for (const std::uint32_t v : {e.a, e.b})
      if (!(std::abs(strain) <= std::abs(out[v]))) out[v] = std::isnan(out[v]) ? out[v] : strain;
  }
  return out;
}

}  // namespace clothbench::render
