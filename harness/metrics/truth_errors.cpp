#include "metrics/truth_errors.hpp"

#include "clothbench/error.hpp"
#include "clothbench/vector.hpp"
#include "metrics/metric.hpp"

namespace clothbench {
namespace {

truth::ReferenceCase required_case(const Scene& scene) {
  auto known = truth::reference_case_of(scene);
  if (!known) throw Error(scene.source + ": /truth: missing");
  return *known;
}

/// Strain of every edge along u, row by row; of every edge of a mesh.
std::vector<double> strains(const Cloth& c, const std::vector<double>& x) {
  std::vector<double> out;
  const auto strain = [&](std::size_t a, std::size_t b, double rest_m) {
    return length(minus(vertex_at(x, b), vertex_at(x, a))) / rest_m - 1;
  };
  if (c.mesh) {
    for (const Edge& e : c.mesh->edges) out.push_back(strain(e.a, e.b, e.rest_m));
    return out;
  }
  for (int j = 0; j < c.rows; ++j)
    for (int i = 0; i + 1 < c.columns; ++i) {
      const auto a = static_cast<std::size_t>(j * c.columns + i);
      out.push_back(strain(a, a + 1, c.du()));
    }
  return out;
}

}  // namespace

TruthJudge::TruthJudge(const Scene& scene)
    : scene_(scene),
      case_(required_case(scene)),
      lattice_(scene.cloth.width_m, scene.cloth.height_m),
      sampler_(truth::sampler_of(scene.cloth)) {}

double TruthJudge::lattice_e2(const std::vector<double>& a, const std::vector<double>& b) const {
  return truth::lattice_rms_error(lattice_, a, b, lattice_.longer_side_m());
}

TruthErrors TruthJudge::judge(int frame, const ClothState& state) const {
  const Cloth& c = scene_.cloth;
  TruthErrors out;
  if (!finite(state.position) || !finite(state.velocity)) return out;
  const std::vector<Vec3> columns = case_.columns(frame);
  const std::vector<double> vertices = truth::vertex_positions(c, case_, frame);
  const auto here = sampler_.sample(state.position), there = sampler_.sample(vertices);
  out.e2 = lattice_e2(here, there);
  if (case_.column_speeds && case_.speed_scale_m_per_s > 0)
    out.speed = truth::lattice_rms_error(lattice_, sampler_.sample(state.velocity),
                                         sampler_.sample(truth::vertex_values(c, case_.column_speeds(frame), false)),
                                         case_.speed_scale_m_per_s);
  out.quantity = case_.quantity(truth::column_means(c, state.position));
  out.quantity_error = truth::quantity_error(out.quantity, case_.quantity(columns), case_.quantity_scale);
  const truth::StretchError stretch = truth::stretch_error(strains(c, state.position), strains(c, vertices));
  out.stretch_p99 = stretch.p99;
  out.stretch_max = stretch.greatest;
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
  for (const auto& [u, v] : lattice_.points_m()) {
    const Vec3 x = case_.continuum(u / c.width_m, frame);
    for (std::size_t k = 0; k < 3; ++k) smooth.push_back(x[k] + (v - c.height_m / 2) * c.axis_v[k]);
  }
  return lattice_e2(sampler_.sample(truth::vertex_values(c, columns, true)), smooth);
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

}  // namespace clothbench
