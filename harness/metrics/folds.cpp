// Smoothness of the folds: the part of the angle between neighbouring cells that alternates from line to line.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "clothbench/vector.hpp"
#include "metrics/collider_contact.hpp"
#include "metrics/reduction.hpp"

namespace clothbench {
namespace {

constexpr int kFoldCells = 6;  // the filter looks at five neighbouring angles

/// A sheet with an RMS angle [rad] below this is flat, and its remaining angles are rounding.
constexpr double kFlat_rad = 1e-4;

/// Sums of squares: of the angle between neighbouring cells, everywhere and where the filter has all its inputs, and of
/// the filter's output.
struct Angles {
  double everywhere = 0, all = 0, rough = 0;
  long steps = 0, count = 0;
};

std::array<double, 3> cell_normal(const Cloth& c, const std::vector<double>& x, int i, int j) {
  const auto at = [&](int a, int b) { return vertex_at(x, static_cast<std::size_t>(b * c.columns + a)); };
  Vec3 n = cross(minus(at(i + 1, j + 1), at(i, j)), minus(at(i, j + 1), at(i + 1, j)));
  const double area = length(n);
  // A cell without area has no normal; it counts as folded, not as flat.
  for (double& v : n) v = area == 0 ? 0 : v / area;
  return n;
}

/// Adds one grid line of cells: the steps of the normal from cell to cell (for small angles their length is the angle),
/// and those steps after a high-pass filter that removes all variations up to third order. Its weights (1, -4, 6, -4,
/// 1)/16 pass a zigzag of two cells fully, 1/4 of a wavelength of 4 cells and 2 % of one of 8.
void add_line(const std::vector<std::array<double, 3>>& normals, Angles& sum) {
  std::vector<std::array<double, 3>> steps;
  for (std::size_t k = 1; k < normals.size(); ++k) steps.push_back(minus(normals[k], normals[k - 1]));
  for (const auto& s : steps) sum.everywhere += dot(s, s);
  sum.steps += static_cast<long>(steps.size());
  for (std::size_t k = 2; k + 2 < steps.size(); ++k) {
    for (std::size_t a = 0; a < 3; ++a) {
      const double rough =
          (steps[k - 2][a] - 4 * steps[k - 1][a] + 6 * steps[k][a] - 4 * steps[k + 1][a] + steps[k + 2][a]) / 16;
      sum.rough += rough * rough;
      sum.all += steps[k][a] * steps[k][a];
    }
    ++sum.count;
  }
}

Angles angles(const MetricFrame& f) {
  const Cloth& c = f.context.scene.cloth;
  const std::vector<double>& x = f.state.position;
  Angles sum;
  const auto line = [&](int lines, int length, auto cell) {
    for (int l = 0; l < lines; ++l) {
      std::vector<std::array<double, 3>> normals;
      for (int k = 0; k < length; ++k) normals.push_back(cell(l, k));
      add_line(normals, sum);
    }
  };
  line(c.rows - 1, c.columns - 1, [&](int l, int k) { return cell_normal(c, x, k, l); });
  line(c.columns - 1, c.rows - 1, [&](int l, int k) { return cell_normal(c, x, l, k); });
  return sum;
}

double fold_angle_rms(const MetricFrame& f) {
  const Angles a = angles(f);
  return std::sqrt(a.everywhere / static_cast<double>(a.steps));
}

double fold_roughness(const MetricFrame& f) {
  const Angles a = angles(f);
  const double all = std::sqrt(a.all / static_cast<double>(a.count));
  return all < kFlat_rad ? 0 * a.rough : std::sqrt(a.rough / a.all);
}

bool folds(const Scene& s) { return kColliders.met(s) && std::min(s.cloth.columns, s.cloth.rows) >= kFoldCells + 1; }

}  // namespace

MetricGroup folds_metrics() {
  static constexpr Gate kRough{0.1, SlackUnit::One, 0.25, false,
                               "which folds there are is chaotic, how rough they are is not"};
  constexpr Needs kFolds{"colliders, 7 × 7 vertices", folds};
  return {{{"fold_angle_rms_rad", "rad", "root mean square angle between the normals of neighbouring cells", kFolds,
            fold_angle_rms},
           {"fold_roughness", "1", "share of that angle at wavelengths of up to two cells", kFolds, fold_roughness}},
          {{"fold_roughness_end", last("fold_roughness"), Expect::Yes, &kRough, 290},
           {"fold_angle_rms_end_rad", last("fold_angle_rms_rad"), Expect::No, nullptr, 300}}};
}

}  // namespace clothbench
