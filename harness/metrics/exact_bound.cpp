#include "metrics/exact_bound.hpp"

#include <algorithm>
#include <cmath>

#include "truth/reference_case.hpp"

namespace clothbench {
namespace {

constexpr double kNothing = 1e-12;  // a motion of rounding errors only

/// What the mesh changes, as a share of the exact motion. A triangle mesh has no exact solution of its own and is
/// compared with the continuum: linear triangles, irregular and perhaps locked, are of first order in their size. A
/// strip that slides by the law of a smooth one: its distance from that one. Other grids have the exact solution of
/// their own.
double mesh_error(const TruthJudge& judge, double moved_quantity) {
  const Cloth& c = judge.scene().cloth;
  if (c.mesh) return c.mesh->edge_m / c.width_m;
  return judge.reference_case().smooth_law ? judge.space_error() / moved_quantity : 0;
}

/// Half a unit in the last place of float32, of the coordinate that is farthest from the origin.
double rounding_m(const std::vector<Vec3>& columns) {
  double largest_m = 0;
  for (const Vec3& x : columns)
    for (const double coordinate : x) largest_m = std::max(largest_m, std::abs(coordinate));
  return std::exp2(-24) * largest_m;
}

/// Three standard deviations of the quantity if every coordinate is rounded (uniformly, by `by_m` at most), over its
/// scale. Each column is a mean over as many vertices as lie across the strip.
double rounding_of_quantity(const TruthJudge& judge, std::vector<Vec3> columns, double by_m) {
  const truth::ReferenceCase& known = judge.reference_case();
  const Cloth& c = judge.scene().cloth;
  const double exact = known.quantity(columns), across = c.mesh ? 1 + c.height_m / c.mesh->edge_m : c.rows;
  double squares = 0;
  for (Vec3& x : columns)
    for (double& coordinate : x) {
      const double kept = coordinate;
      coordinate += by_m;
      squares += std::pow(known.quantity(columns) - exact, 2);
      coordinate = kept;
    }
  return 3 * std::sqrt(squares / 3 / across) / known.quantity_scale;
}

}  // namespace

ExactBound exact_bound(const TruthJudge& judge) {
  const Scene& scene = judge.scene();
  const truth::ReferenceCase& known = judge.reference_case();
  const truth::Tolerance& tolerance = truth::tolerance_of(known.name);
  const int last = scene.time.frames();
  const ClothState start{initial_positions(scene), std::vector<double>(3 * scene.cloth.vertex_count())};
  std::vector<double> times_s, e2, quantity_error;
  for (int frame = known.settles ? last : 0; frame <= last; ++frame) {
    const TruthErrors moved = judge.judge(frame, start);
    times_s.push_back(scene.time.at(frame));
    e2.push_back(moved.e2);
    quantity_error.push_back(moved.quantity_error);
  }
  const auto norm = [&](const std::vector<double>& errors) {
    return errors.size() < 2 ? errors.back() : truth::time_rms(times_s, errors);
  };
  const bool moves = norm(e2) > kNothing;
  const double share = moves ? tolerance.of_motion + mesh_error(judge, norm(quantity_error)) : 0;
  const auto bound = [&](const std::vector<double>& errors, double at_rest, double rounding) {
    return (moves ? share * norm(errors) : at_rest) + rounding;
  };
  const std::vector<Vec3> columns = known.columns(last);
  const double longer_m = std::max(scene.cloth.width_m, scene.cloth.height_m), by_m = rounding_m(columns);
  return {bound(e2, tolerance.at_rest, by_m / longer_m),
          bound(quantity_error, tolerance.at_rest * longer_m / known.quantity_scale,
                rounding_of_quantity(judge, columns, by_m))};
}

}  // namespace clothbench
