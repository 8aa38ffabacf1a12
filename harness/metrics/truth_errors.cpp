#include "metrics/truth_errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clothbench/error.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

truth::ReferenceCase required_case(const Scene& scene) {
  auto known = truth::reference_case_of(scene);
  if (!known) throw Error(scene.source + ": /truth: missing");
  return *known;
}

/// Strain of every edge along u, row by row; for a mesh, of every edge.
std::vector<double> strains(const Cloth& c, const std::vector<double>& x) {
  std::vector<double> out;
  for (const Edge& e : edges(c, EdgeKind::Structural))
    if (c.mesh || e.b == e.a + 1) out.push_back(length(minus(vertex_at(x, e.b), vertex_at(x, e.a))) / e.rest_m - 1);
  return out;
}

constexpr double kMore = 1.1;
constexpr int kFrames = 4;

double change(const TruthJudge& judge, const Scene& scene, const std::string& key, double value) {
  const Scene other = scene_from_json(json_from(scene.json), scene.source, {fmt::format("{}={}", key, kMore * value)});
  const auto known = truth::reference_case_of(other);
  const int last = scene.time.frames();
  double most = 0;
  for (int k = known->settles ? kFrames : 1; k <= kFrames; ++k) {
    const int frame = last * k / kFrames;
    ClothState state;
    state.position = truth::vertex_positions(other.cloth, *known, frame);
    state.velocity.assign(state.position.size(), 0);
    const TruthErrors e = judge.judge(frame, state);
    most = max_or_nan(most, judge.reference_case().by_quantity ? e.quantity_error : e.e2);
  }
  return most / std::log(kMore);
}

constexpr double kNothing = 1e-12;  // displacement that is rounding error only

/// Error of the mesh as a fraction of the exact motion. A triangle mesh is compared with the continuum; its linear
/// elements, irregular and perhaps locking, have errors of first order in their size. A strip that slides by a smooth
/// law differs from that law by space_error. Other grids have their own exact solution.
double mesh_error(const TruthJudge& judge, double moved_quantity) {
  const Cloth& c = judge.scene().cloth;
  if (c.mesh) return c.mesh->edge_m / c.width_m;
  return judge.reference_case().smooth_law ? judge.space_error() / moved_quantity : 0;
}

/// Half a unit in the last place [m], in float32, of the coordinate with the maximum magnitude.
double rounding_m(const std::vector<Vec3>& columns) {
  double largest_m = 0;
  for (const Vec3& x : columns)
    for (const double coordinate : x) largest_m = std::max(largest_m, std::abs(coordinate));
  return std::exp2(-24) * largest_m;
}

/// Three standard deviations of the quantity, over its scale, if every coordinate is rounded (uniformly, by at most
/// `by_m`). Each column is a mean over the vertices across the strip.
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

TruthJudge::TruthJudge(const Scene& scene)
    : scene_(scene),
      case_(required_case(scene)),
      lattice_(scene.cloth.width_m, scene.cloth.height_m),
      sampler_(truth::sampler_of(scene.cloth)) {}

double TruthJudge::lattice_e2(const std::vector<double>& a, const std::vector<double>& b) const {
  return truth::lattice_rms_error(lattice_, a, b, lattice_.longer_side_m);
}

TruthErrors TruthJudge::judge(int frame, const ClothState& state) const {
  const Cloth& c = scene_.cloth;
  TruthErrors out;
  if (!finite(state.position) || !finite(state.velocity)) return out;
  const std::vector<Vec3> columns = case_.columns(frame);
  const std::vector<double> vertices = truth::vertex_positions(c, case_, frame);
  const auto here = sampler_.sample(state.position), there = sampler_.sample(vertices);
  out.e2 = lattice_e2(here, there);
  out.quantity = case_.quantity(truth::column_means(c, state.position));
  out.quantity_error = truth::quantity_error(out.quantity, case_.quantity(columns), case_.quantity_scale);
  const auto [p99, most] = truth::stretch_error(strains(c, state.position), strains(c, vertices));
  out.stretch_p99 = p99;
  out.stretch_max = most;
  return out;
}

double TruthJudge::ranking_error(const std::vector<double>& times_s, const std::vector<TruthErrors>& errors) const {
  std::vector<double> by;
  for (const TruthErrors& e : errors) by.push_back(case_.by_quantity ? e.quantity_error : e.e2);
  return case_.settles || by.size() < 2 ? by.back() : truth::time_rms(times_s, by);
}

double TruthJudge::space_error(int frame) const {
  const Cloth& c = scene_.cloth;
  const std::vector<Vec3> columns = case_.columns(frame);
  if (case_.by_quantity) {
    std::vector<Vec3> smooth;
    for (int i = 0; i < c.columns; ++i)
      smooth.push_back(case_.continuum(static_cast<double>(i) / (c.columns - 1), frame));
    return truth::quantity_error(case_.quantity(columns), case_.quantity(smooth), case_.quantity_scale);
  }
  std::vector<double> smooth;
  for (const auto& [u, v] : lattice_.points_m) {
    const Vec3 x = case_.continuum(u / c.width_m, frame);
    for (std::size_t k = 0; k < 3; ++k) smooth.push_back(x[k] + (v - c.height_m / 2) * c.axis_v[k]);
  }
  return lattice_e2(sampler_.sample(truth::vertex_values(c, columns)), smooth);
}

double TruthJudge::space_error() const {
  if (case_.vertices) return kMissing;
  if (!case_.continuum) return 0;
  const int last = scene_.time.frames();
  if (case_.settles) return space_error(last);
  std::vector<double> times, errors;
  for (int f = 0; f <= last; ++f) {
    times.push_back(scene_.time.at(f));
    errors.push_back(space_error(f));
  }
  return truth::time_rms(times, errors);
}

bool keeps_energy(const Scene& s) {
  const FeatureSet loses =
      FeatureSet{Feature::Damping, Feature::Shear, Feature::Bend, Feature::MovingPins, Feature::ClothMesh} |
      kColliderFeatures;
  return (s.needs & loses).empty() && s.gravity_m_per_s2 != Vec3{} && s.cloth.span_m == 0 &&
         s.cloth.drape_radius_m == 0;
}

std::map<std::string, double> truth_dependence(const Scene& scene) {
  if (scene.reference_case.empty()) return {};
  const TruthJudge judge(scene);
  std::map<std::string, double> out = {{"truth_dependence_Y", 0}, {"truth_dependence_B", 0}};
  if (const auto Y = scene.material.membrane_stiffness_N_per_m)
    out["truth_dependence_Y"] = change(judge, scene, "material.membrane_stiffness_N_per_m", *Y);
  if (const double B = scene.material.bending_rigidity_N_m; B > 0)
    out["truth_dependence_B"] = change(judge, scene, "material.bending_rigidity_N_m", B);
  return out;
}

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
