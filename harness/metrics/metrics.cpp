#include <algorithm>

#include "metrics/collider_contact.hpp"
#include "metrics/collider_passage.hpp"
#include "metrics/metric.hpp"
#include "metrics/stability/judge.hpp"
#include "metrics/truth_errors.hpp"

namespace clothbench {
namespace {

constexpr int kFoldCells = 6;  // the filter looks at five neighbouring angles

/// 1: every odd number of crossings with the wake, but for free ends. 2: nor what a finger pushes aside within a frame,
/// nor borders laid over it.
constexpr int kWrongSide = 2;

bool always(const Scene&) { return true; }

bool has_gravity(const Scene& s) { return s.gravity_m_per_s2 != Vec3{}; }

bool touches_nothing(const Scene& s) {
  return s.pins.vertices.empty() && s.grips.vertices.empty() && s.colliders.empty();
}

/// An integrator declares its fall for even frames.
bool falls_freely(const Scene& s) {
  return touches_nothing(s) && has_gravity(s) && s.time.ends_s.empty() && s.cloth.spin_rad_per_s == Vec3{};
}

bool keeps_momentum(const Scene& s) {
  const bool has_scale = has_gravity(s) || s.cloth.initial_velocity_m_per_s != Vec3{};
  return touches_nothing(s) && !s.needs.has(Feature::Damping) && has_scale;
}

bool touches(const Scene& s) { return kWithContactMetrics && !s.colliders.empty(); }

bool can_tunnel(const Scene& s) {
  return kWithContactMetrics && std::any_of(s.colliders.begin(), s.colliders.end(), counts_crossings);
}

bool has_depth(const Scene& s) {
  return kWithContactMetrics && std::any_of(s.colliders.begin(), s.colliders.end(), has_inside);
}

auto contact(double SceneContact::*field) {
  return [field](const MetricFrame& f) { return f.contact->*field; };
}

bool can_be_passed(const Scene& s) {
  return kWithContactMetrics && std::any_of(s.colliders.begin(), s.colliders.end(), has_centre_line);
}

bool has_friction(const Scene& s) {
  return kWithContactMetrics &&
         std::any_of(s.colliders.begin(), s.colliders.end(), [](const Collider& c) { return c.friction > 0; });
}

auto passage(double ScenePassage::*field) {
  return [field](const MetricFrame& f) { return f.passage->*field; };
}

bool touches_itself(const Scene& s) { return kWithContactMetrics && s.needs.has(Feature::SelfCollision); }

auto of_itself(double SelfContact::*field) {
  return [field](const MetricFrame& f) { return f.self_contact->*field; };
}

bool folds(const Scene& s) { return touches(s) && std::min(s.cloth.columns, s.cloth.rows) >= kFoldCells + 1; }

bool has_truth(const Scene& s) { return !s.truth_card.empty(); }

auto from_truth(double TruthErrors::*field) {
  return [field](const MetricFrame& f) { return f.truth->*field; };
}

bool is_judged(const Scene& s) { return !s.stability.name.empty(); }

auto from_judge(double StabilityFrame::*field) {
  return [field](const MetricFrame& f) { return f.stability->*field; };
}

bool truth_keeps_energy(const Scene& s) { return has_truth(s) && keeps_energy(s); }

}  // namespace

const std::vector<Metric>& metrics() {
  using C = SceneContact;
  using T = TruthErrors;
  using S = StabilityFrame;
  static const std::vector<Metric> all = {
      {"free_fall_error", "1", "greatest distance from free fall over g T^2 / 2", falls_freely, free_fall_error_max},
      {"free_fall_error_rms", "1", "root mean square distance from free fall over g T^2 / 2", falls_freely,
       free_fall_error_rms},
      {"stretch_max", "1", "greatest strain of the structural edges", always, stretch_max},
      {"stretch_rms", "1", "root mean square strain of the structural edges", always, stretch_rms},
      {"stretch_mean", "1", "mean strain of the structural edges", always, stretch_mean},
      {"stretch_mean_positive", "1", "mean strain of the structural edges, those that are short counted as 0", always,
       stretch_mean_positive},
      {"momentum_error", "1", "momentum beside gravity's share, over M (sqrt(g L) + v0)", keeps_momentum,
       momentum_error},
      {"speed_max", "m s-1", "greatest vertex speed", always, speed_max},
      {"kinetic_energy_J", "J", "kinetic energy", always, kinetic_energy},
      {"gravity_energy_J", "J", "work done against gravity since the start", has_gravity, gravity_energy},
      {"contact_length_m", "m", "length of the curves in which cloth and colliders cross", touches,
       contact(&C::length_m)},
      {"contact_pairs", "1", "pairs of cloth triangle and collider triangle or capsule that meet", touches,
       contact(&C::pairs)},
      {"contact_cloth_fraction", "1", "share of the cloth's triangles in such a pair", touches,
       contact(&C::cloth_fraction)},
      {"tunnelled_fraction", "1", "share of the cloth on the other side of a mesh than it began", can_tunnel,
       contact(&C::tunnelled_fraction)},
      {"tunnelled_depth_m", "m", "greatest distance of a tunnelled vertex from the mesh", can_tunnel,
       contact(&C::tunnelled_depth_m)},
      {"depth_m", "m", "greatest depth in a collider, between the vertices too", has_depth, contact(&C::depth_m)},
      {"depth_vertex_m", "m", "greatest depth of a vertex in a collider", has_depth, contact(&C::depth_vertex_m)},
      {"depth_p99_m", "m", "depth that 99 % of the penetrating area keeps below", has_depth, contact(&C::depth_p99_m)},
      {"depth_mean_m", "m", "mean depth of the penetrating area", has_depth, contact(&C::depth_mean_m)},
      {"penetrating_area_m2", "m2", "area of the cloth inside colliders", has_depth, contact(&C::area_m2)},
      {"wrong_side_fraction", "1", "share of the cloth on the wrong side of a moving collider's centre line",
       can_be_passed, passage(&ScenePassage::wrong_side_fraction), kWrongSide},
      {"wrong_side_samples", "1", "vertices and cell centres on the wrong side", can_be_passed,
       passage(&ScenePassage::wrong_side_samples), kWrongSide},
      {"touching_fraction", "1", "share of the cloth within the margin of a collider", touches,
       passage(&ScenePassage::touching_fraction)},
      {"slip_m", "m", "mean way that touching vertices slid on the surface in the frame", has_friction,
       passage(&ScenePassage::slip_m)},
      {"self_contact_length_m", "m", "length of the curves in which the cloth crosses itself", touches_itself,
       of_itself(&SelfContact::length_m)},
      {"self_contact_pairs", "1", "pairs of triangles of the cloth that meet and share no vertex", touches_itself,
       of_itself(&SelfContact::pairs)},
      {"grip_error_m", "m", "greatest distance of a held vertex from where it is held",
       [](const Scene& s) { return !s.grips.vertices.empty(); }, grip_error},
      {"fold_angle_rms_rad", "rad", "root mean square angle between the normals of neighbouring cells", folds,
       fold_angle_rms},
      {"fold_roughness", "1", "share of that angle at wavelengths of up to two cells", folds, fold_roughness},
      {"truth_error_e2", "1", "RMS distance from the truth on the material lattice, over the longer side", has_truth,
       from_truth(&T::e2)},
      {"truth_error_max", "1", "greatest distance from the truth on the material lattice, over the longer side",
       has_truth, from_truth(&T::greatest)},
      {"truth_speed_error", "1", "RMS error of speed on the material lattice, over the card's scale", has_truth,
       from_truth(&T::speed)},
      {"truth_quantity", "1", "the card's quantity, in SI units", has_truth, from_truth(&T::quantity)},
      {"truth_quantity_error", "1", "error of the card's quantity, over its scale", has_truth,
       from_truth(&T::quantity_error)},
      {"truth_stretch_rms", "1", "RMS of strain less true strain, edges along u", has_truth,
       from_truth(&T::stretch_rms)},
      {"truth_stretch_p99", "1", "99th percentile of strain less true strain", has_truth, from_truth(&T::stretch_p99)},
      {"truth_stretch_max", "1", "greatest strain less true strain", has_truth, from_truth(&T::stretch_max)},
      {"energy_rise", "1", "energy less that at the start, over M g L", truth_keeps_energy, energy_rise},
      {"stability_classes", "1", "outcome classes of the frame: sum of 2^k over F0 to F7", is_judged,
       [](const MetricFrame& f) { return static_cast<double>(f.stability->classes); }},
      {"stability_speed", "1", "greatest vertex speed over the greatest that physics allows", is_judged,
       from_judge(&S::speed)},
      {"stability_energy_gain", "1", "energy gained over M g L", is_judged, from_judge(&S::energy_gain)},
      {"stability_strain_excess", "1", "greatest strain beyond the truth", is_judged, from_judge(&S::strain_excess)},
      {"stability_strain_p99", "1", "99th percentile of strain beyond the truth", is_judged,
       from_judge(&S::strain_p99)},
      {"stability_bad_geometry", "1", "share of triangles squashed or blown up, or of folds over 170 degrees",
       is_judged, from_judge(&S::bad_geometry)},
      {"stability_depth", "1", "depth in a collider over its limit; infinite once it has passed through", is_judged,
       from_judge(&S::depth)},
      {"stability_unrest", "1", "RMS speed over sqrt(g L), once settled", is_judged, from_judge(&S::unrest)},
      {"stability_fall_error", "1", "error of the centre of mass's fall over g T^2 / 2", is_judged,
       from_judge(&S::fall_error)},
  };
  return all;
}

}  // namespace clothbench
