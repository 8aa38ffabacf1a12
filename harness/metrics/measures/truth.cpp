// Distance of a run from its scene's exact solution, per frame and overall; energy of scenes that conserve it.
#include <algorithm>
#include <cmath>

#include "metrics/registry.hpp"
#include "metrics/truth_errors.hpp"

namespace clothbench {
namespace {

bool has_truth(const Scene& s) { return !s.reference_case.empty(); }

bool truth_keeps_energy(const Scene& s) { return has_truth(s) && keeps_energy(s); }

auto truth_field(double TruthErrors::*field) {
  return [field](const MetricFrame& f) { return (*f.truth).*field; };
}

/// Energy minus the energy at the start, divided by M g L.
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
    for (const Edge& e : edges(c, EdgeKind::Structural)) {
      const double longer = length(minus(vertex_at(state.position, e.b), vertex_at(state.position, e.a))) - e.rest_m;
      energy += 0.5 * spring_N_per_m(s, e, *Y) * longer * longer;
    }
  }
  return energy / (total * length(s.gravity_m_per_s2) * std::max(c.width_m, c.height_m));
}

/// Null unless the run reaches its end: an incomplete pass has no error.
const std::vector<double>* whole_series(const RunView& r, const std::string& name) {
  return r.whole() ? r.series(name) : nullptr;
}

double greatest_amount(const std::vector<double>& values) {
  double most = 0;
  for (const double v : values) most = max_or_nan(most, std::abs(v));
  return most;
}

/// `moving` reduces the series of a moving exact solution; for a solution at rest only the last frame counts.
Reduction of_whole(const char* series, const char* how, double (*moving)(const RunView&, const std::vector<double>&)) {
  return {{series}, how, [=, name = std::string(series)](const RunView& r) {
            const std::vector<double>* v = whole_series(r, name);
            if (v == nullptr) return kMissing;
            return r.reference_case().settles ? v->back() : moving(r, *v);
          }};
}

Reduction at_the_end(const char* series) {
  return of_whole(series, "last frame", [](const RunView&, const std::vector<double>& v) { return v.back(); });
}

Reduction over_time(const char* series) {
  return of_whole(series, "RMS over time; at rest, the last frame", [](const RunView& r, const std::vector<double>& v) {
    return v.size() < 2 ? v.back() : truth::time_rms(r.pass.time_s, v);
  });
}

Reduction worst(const char* series) {
  return of_whole(series, "maximum over the frames; at rest, the last frame",
                  [](const RunView&, const std::vector<double>& v) { return greatest_amount(v); });
}

bool with_truth(const RunView& r) { return has_truth(r.scene); }

double truth_error(const RunView& r) {
  return over_time(r.reference_case().by_quantity ? "truth_quantity_error" : "truth_error_e2").value(r);
}

/// Upper bound on another scalar of a whole run.
Scalar bound_on(const std::string& scalar, double ExactBound::*bound) {
  const auto value = [bound](const RunView& r) { return r.whole() ? r.exact_bound().*bound : kMissing; };
  return {
      .name = scalar + kBound,
      .from = own({}, "bound on " + scalar + ": tolerance of the test case, error of the mesh, rounding", value, "1"),
      .present = with_truth,
      .better = Better::Neither};
}

/// Values that a study adds to the summaries of a scene's runs; see runner/reference.cpp and truth_dependence.
Scalar of_the_study(const char* name, const char* doc, const Gate* gate = nullptr) {
  return {.name = name, .from = own({}, doc, nullptr, "1"), .gate = gate, .better = Better::Neither};
}

bool with_energy(const RunView& r) { return truth_keeps_energy(r.scene); }

}  // namespace

MetricGroup truth_metrics() {
  using enum Expect;
  using T = TruthErrors;
  constexpr Needs kTruth{"an exact solution", has_truth},
      kEnergy{"an exact solution without damping, shear, bending, attachments and colliders", truth_keeps_energy};
  return {
      {{"truth_error_e2", "1",
        "RMS distance from the exact solution at the material points, divided by the longer side", kTruth,
        truth_field(&T::e2)},
       {"truth_quantity", "1", "quantity of the analytic test case, in SI units", kTruth, truth_field(&T::quantity)},
       {"truth_quantity_error", "1", "error of the quantity of the analytic test case, divided by its scale", kTruth,
        truth_field(&T::quantity_error)},
       {"energy_rise", "1", "energy minus the energy at the start, divided by M g L", kEnergy, energy_rise}},
      {{"truth_quantity_error_max", worst("truth_quantity_error"), Yes, &kErrorGate},
       {"truth_quantity_error", over_time("truth_quantity_error"), No, &kErrorGate, with_truth},
       {"truth_e2", over_time("truth_error_e2"), No, nullptr, with_truth},
       bound_on("truth_e2", &ExactBound::e2),
       bound_on("truth_quantity_error", &ExactBound::quantity_error),
       {"truth_quantity", at_the_end("truth_quantity"), No, nullptr, with_truth, "", "", Better::Neither},
       {"truth_error",
        own({"truth_error_e2", "truth_quantity_error"},
            "error by which runs are ranked: of the test case's quantity, or of positions", truth_error, "1"),
        No, &kErrorGate, with_truth},
       {"energy_gain",
        own(
            {"energy_rise"}, "maximum energy above the energy at the start, divided by M g L",
            [](const RunView& r) { return max_or_nan(0, greatest_of(whole_series(r, "energy_rise"))); }, "1"),
        No, nullptr, with_energy},
       of_the_study("truth_value", "exact quantity of the analytic test case, in SI units"),
       of_the_study("truth_space_error",
                    "error of the discretisation itself: distance of its exact or finest solution from the continuum, "
                    "measured as truth_error",
                    &kErrorGate),
       of_the_study("truth_dependence_*", "change of truth_error with the logarithm of a modulus"),
       of_the_study("reference_*",
                    "quantity of the test case as computed by the reference solver; uncertainty of the solution")}};
}

}  // namespace clothbench
