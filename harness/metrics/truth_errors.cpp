#include "metrics/truth_errors.hpp"

#include <cmath>
#include <limits>

#include "clothbench/error.hpp"
#include "metrics/metric.hpp"

namespace clothbench {
namespace {

truth::Card required_card(const Scene& scene) {
  auto card = truth::card_of(scene);
  if (!card) throw Error(scene.source + ": /truth: missing");
  return *card;
}

truth::LatticeSampler sampler_of(const Scene& scene, const truth::MaterialLattice& lattice) {
  const Cloth& c = scene.cloth;
  std::vector<double> rest;
  for (int j = 0; j < c.rows; ++j)
    for (int i = 0; i < c.columns; ++i) {
      // The border exactly on the border, whatever rounding says.
      rest.push_back(i + 1 == c.columns ? c.width_m : i * c.du());
      rest.push_back(j + 1 == c.rows ? c.height_m : j * c.dv());
    }
  std::vector<std::uint32_t> corners;
  for (const auto& t : triangles(c)) corners.insert(corners.end(), t.begin(), t.end());
  return {lattice, rest, corners};
}

/// Strain of every edge along u, row by row.
std::vector<double> strains(const Cloth& c, const std::vector<double>& x) {
  std::vector<double> out;
  for (int j = 0; j < c.rows; ++j)
    for (int i = 0; i + 1 < c.columns; ++i) {
      const auto a = 3 * static_cast<std::size_t>(j * c.columns + i);
      out.push_back(norm(x[a + 3] - x[a], x[a + 4] - x[a + 1], x[a + 5] - x[a + 2]) / c.du() - 1);
    }
  return out;
}

}  // namespace

TruthJudge::TruthJudge(const Scene& scene)
    : scene_(scene),
      card_(required_card(scene)),
      lattice_(scene.cloth.width_m, scene.cloth.height_m),
      sampler_(sampler_of(scene, lattice_)) {}

double TruthJudge::lattice_e2(const std::vector<double>& a, const std::vector<double>& b) const {
  return truth::lattice_rms_error(lattice_, a, b, lattice_.longer_side_m());
}

TruthErrors TruthJudge::judge(int frame, const ClothState& state) const {
  const Cloth& c = scene_.cloth;
  TruthErrors out;
  if (!finite(state.position) || !finite(state.velocity)) return out;
  const std::vector<Vec3> columns = card_.columns(frame);
  const std::vector<double> vertices = truth::vertex_values(c, columns, true);
  const auto here = sampler_.sample(state.position), there = sampler_.sample(vertices);
  out.e2 = lattice_e2(here, there);
  out.greatest = truth::lattice_greatest_error(lattice_, here, there, lattice_.longer_side_m());
  if (card_.column_speeds && card_.speed_scale_m_per_s > 0)
    out.speed = truth::lattice_rms_error(lattice_, sampler_.sample(state.velocity),
                                         sampler_.sample(truth::vertex_values(c, card_.column_speeds(frame), false)),
                                         card_.speed_scale_m_per_s);
  out.quantity = card_.quantity(truth::column_means(c, state.position));
  out.quantity_error = truth::quantity_error(out.quantity, card_.quantity(columns), card_.quantity_scale);
  const truth::StretchError stretch = truth::stretch_error(strains(c, state.position), strains(c, vertices));
  out.stretch_rms = stretch.rms;
  out.stretch_p99 = stretch.p99;
  out.stretch_max = stretch.greatest;
  return out;
}

double TruthJudge::space_error(int frame) const {
  const Cloth& c = scene_.cloth;
  const std::vector<Vec3> columns = card_.columns(frame);
  if (card_.by_quantity) {
    std::vector<Vec3> smooth;
    for (int i = 0; i < c.columns; ++i)
      smooth.push_back(card_.continuum(static_cast<double>(i) / (c.columns - 1), frame));
    return truth::quantity_error(card_.quantity(columns), card_.quantity(smooth), card_.quantity_scale);
  }
  std::vector<double> smooth;
  for (const auto& [u, v] : lattice_.points_m()) {
    const Vec3 x = card_.continuum(u / c.width_m, frame);
    for (std::size_t k = 0; k < 3; ++k) smooth.push_back(x[k] + (v - c.height_m / 2) * c.axis_v[k]);
  }
  return lattice_e2(sampler_.sample(truth::vertex_values(c, columns, true)), smooth);
}

double TruthJudge::space_error() const {
  if (!card_.continuum) return 0;
  const int last = scene_.time.frames();
  if (card_.settles) return space_error(last);
  std::vector<double> times, errors;
  for (int f = 0; f <= last; ++f) {
    times.push_back(scene_.time.at(f));
    errors.push_back(space_error(f));
  }
  return truth::time_rms(times, errors);
}

bool keeps_energy(const Scene& s) {
  const FeatureSet loses =
      FeatureSet{Feature::Damping, Feature::Shear, Feature::Bend, Feature::MovingPins} | kColliderFeatures;
  return (s.needs & loses).empty() && s.gravity_m_per_s2 != Vec3{} && s.cloth.span_m == 0 &&
         s.cloth.drape_radius_m == 0;
}

double energy_rise(const MetricFrame& f) {
  const Scene& s = f.context.scene;
  const ClothState& state = f.state;
  const Cloth& c = s.cloth;
  const std::vector<double> mass = vertex_masses(s), start = initial_positions(s);
  std::vector<std::uint8_t> held(mass.size(), 0);
  for (std::uint32_t v : s.pins.vertices) held[v] = 1;
  double energy = 0, total = 0;
  for (std::size_t v = 0; v < mass.size(); ++v) {
    total += mass[v];
    for (std::size_t k = 0; k < 3; ++k) {
      const double v0 = held[v] != 0 ? 0 : s.cloth.initial_velocity_m_per_s[k], v1 = state.velocity[3 * v + k];
      energy += mass[v] *
                (0.5 * (v1 * v1 - v0 * v0) - s.gravity_m_per_s2[k] * (state.position[3 * v + k] - start[3 * v + k]));
    }
  }
  if (const auto Y = s.material.membrane_stiffness_N_per_m) {
    const auto border = [](int i, int n) { return i == 0 || i == n - 1 ? 0.5 : 1.0; };  // half the width
    for (const Edge& e : edges(c, EdgeKind::Structural)) {
      const bool along_u = e.b == e.a + 1;
      const int line = static_cast<int>(e.a) / c.columns, column = static_cast<int>(e.a) % c.columns;
      const double k =
          *Y * (along_u ? c.dv() / c.du() * border(line, c.rows) : c.du() / c.dv() * border(column, c.columns));
      const double* a = &state.position[3 * e.a];
      const double* b = &state.position[3 * e.b];
      const double longer = norm(b[0] - a[0], b[1] - a[1], b[2] - a[2]) - e.rest_m;
      energy += 0.5 * k * longer * longer;
    }
  }
  const Vec3 g = s.gravity_m_per_s2;
  return energy / (total * norm(g[0], g[1], g[2]) * std::max(c.width_m, c.height_m));
}

std::map<std::string, double> summarise_truth(const Scene& scene, const AccuracyPass& pass) {
  std::map<std::string, double> out;
  const auto card = truth::card_of(scene);
  if (!card) return out;
  const bool whole = pass.time_s.size() == static_cast<std::size_t>(scene.time.frames()) + 1;
  const auto series = [&](const char* name) {
    for (const MetricSeries& m : pass.metrics)
      if (m.name == name && whole && m.values.size() == pass.time_s.size()) return m.values;
    return std::vector<double>(1, kMissing);
  };
  const auto last = [&](const char* name) { return series(name).back(); };
  const auto greatest = [&](const char* name, bool absolute) {
    double most = absolute ? 0 : -std::numeric_limits<double>::infinity();
    for (double v : series(name)) most = max_or_nan(most, absolute ? std::abs(v) : v);
    return most;
  };
  const auto over_time = [&](const char* name) {
    const std::vector<double> values = series(name);
    return card->settles || values.size() < 2 ? values.back() : truth::time_rms(pass.time_s, values);
  };
  const auto worst = [&](const char* name) { return card->settles ? last(name) : greatest(name, true); };
  out["truth_e2"] = over_time("truth_error_e2");
  out["truth_max"] = worst("truth_error_max");
  out["truth_speed_error"] = over_time("truth_speed_error");
  out["truth_quantity"] = last("truth_quantity");
  out["truth_quantity_error"] = over_time("truth_quantity_error");
  out["truth_quantity_error_max"] = worst("truth_quantity_error");
  out["truth_stretch_rms"] = worst("truth_stretch_rms");
  out["truth_stretch_p99"] = worst("truth_stretch_p99");
  out["truth_stretch_max"] = worst("truth_stretch_max");
  out["truth_error"] = card->by_quantity ? out["truth_quantity_error"] : out["truth_e2"];
  if (keeps_energy(scene)) {
    out["energy_gain"] = max_or_nan(0, greatest("energy_rise", false));
    out["energy_drift"] = greatest("energy_rise", true);
  }
  return out;
}

}  // namespace clothbench
