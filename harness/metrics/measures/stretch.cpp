#include "metrics/registry.hpp"

namespace clothbench {
namespace {

/// Calls fn(strain) for every structural edge that has a length, and returns their number.
template <class Fn>
double for_each_strain(const Cloth& c, const ClothState& state, Fn fn) {
  double count = 0;
  const auto strain = [&](std::size_t a, std::size_t b, double rest) {
    if (!(rest > 0)) return;
    ++count;
    fn(length(minus(vertex_at(state.position, b), vertex_at(state.position, a))) / rest - 1);
  };
  if (c.mesh) {
    for (const Edge& e : c.mesh->edges) strain(e.a, e.b, e.rest_m);
    return count;
  }
  for (int j = 0; j < c.rows; ++j)
    for (int i = 0; i < c.columns; ++i) {
      const auto v = static_cast<std::size_t>(j * c.columns + i), below = v + static_cast<std::size_t>(c.columns);
      const bool even = c.column_factors.empty();
      if (i + 1 < c.columns) strain(v, v + 1, even ? c.du() : c.line_u_m(i + 1) - c.line_u_m(i));
      if (j + 1 < c.rows) strain(v, below, c.dv());
    }
  return count;
}

double stretch_max(const MetricFrame& f) {
  double most = -1;
  for_each_strain(f.context.scene.cloth, f.state, [&](double e) { most = max_or_nan(most, e); });
  return most;
}

double stretch_mean_positive(const MetricFrame& f) {
  double sum = 0;
  const double count = for_each_strain(f.context.scene.cloth, f.state, [&](double e) { sum += e <= 0 ? 0 : e; });
  return sum / count;
}

}  // namespace

MetricGroup stretch_metrics() {
  static constexpr Gate kWorstEdge{0.25, SlackUnit::One, 1, false,
                                   "the worst edge of thousands: 0.047 and 0.117 on two devices"};
  return {{{"stretch_max", "1", "maximum strain of the structural edges", kAlways, stretch_max, 3},
           {"stretch_mean_positive", "1", "mean strain of the structural edges; compressed edges count as 0", kAlways,
            stretch_mean_positive}},
          {{"stretch_max", greatest("stretch_max"), Expect::Yes, &kWorstEdge},
           {"stretch_max_end", last("stretch_max"), Expect::Yes, &kWorstEdge},
           {"stretch_max_last_second", greatest_last_second("stretch_max"), Expect::Yes, &kWorstEdge},
           {"stretch_mean_last_second", mean_last_second("stretch_mean_positive"), Expect::Yes}}};
}

}  // namespace clothbench
