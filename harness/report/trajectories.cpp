#include "report/trajectories.hpp"

#include <cmath>

#include "results/store.hpp"

namespace clothbench {
namespace {

std::vector<float> positions(const RunRecord& c) {
  if (!c.accuracy.position.empty() || c.file.empty()) return c.accuracy.position;
  return read_run(c.file).accuracy.position;
}

/// The greater of two values; NaN if either is NaN.
double greater(double a, double b) { return b <= a || std::isnan(a) ? a : b; }

}  // namespace

Apart trajectories_apart(const RunRecord& one, const RunRecord& other, std::size_t transposed_columns) {
  const std::vector<float> a = positions(one), b = positions(other);
  const std::size_t vertices = one.header.vertices, columns = transposed_columns;
  if (a.empty() || a.size() != b.size() || vertices == 0 || a.size() % (3 * vertices) != 0 ||
      (columns > 0 && vertices % columns != 0))
    return {};
  Apart out{0, 0};
  for (std::size_t first = 0; first < a.size(); first += 3 * vertices) {
    double sum = 0;
    out.end_m = 0;
    for (std::size_t v = 0; v < vertices; ++v) {
      const std::size_t there = columns == 0 ? v : (v % columns) * (vertices / columns) + v / columns;
      double squared = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double off = double{a[first + 3 * v + k]} - b[first + 3 * there + k];
        squared += off * off;
      }
      sum += squared;
      out.end_m = greater(out.end_m, std::sqrt(squared));
    }
    out.rms_m.push_back(std::sqrt(sum / static_cast<double>(vertices)));
    out.max_m = greater(out.max_m, out.end_m);
  }
  return out;
}

}  // namespace clothbench
