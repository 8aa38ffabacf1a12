#include "report/trajectories.hpp"

#include <cmath>

#include "results/store.hpp"

namespace clothbench {
namespace {

std::vector<float> positions(const CellRecord& c) {
  if (!c.accuracy.position.empty() || c.file.empty()) return c.accuracy.position;
  return read_cell(c.file).accuracy.position;
}

/// NaN if either is.
double greater(double a, double b) { return b <= a || std::isnan(a) ? a : b; }

}  // namespace

Apart trajectories_apart(const CellRecord& one, const CellRecord& other) {
  const std::vector<float> a = positions(one), b = positions(other);
  const std::size_t frame = 3 * static_cast<std::size_t>(one.header.vertices);
  if (a.empty() || a.size() != b.size() || frame == 0 || a.size() % frame != 0) return {};
  Apart out{0, 0};
  for (std::size_t k = 0; k < a.size(); k += 3) {
    if (k % frame == 0) out.end_m = 0;
    double squared = 0;
    for (std::size_t x = k; x < k + 3; ++x) squared += (double{a[x]} - b[x]) * (double{a[x]} - b[x]);
    const double d = std::sqrt(squared);
    out.end_m = greater(out.end_m, d);
    out.max_m = greater(out.max_m, d);
  }
  return out;
}

}  // namespace clothbench
