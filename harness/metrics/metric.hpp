#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/scene.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {

/// Inputs of a metric in addition to the state: the scene and the solver's declarations, never the solver itself.
struct MetricContext {
  const Scene& scene;
  const SolverEntry& entry;
  const nlohmann::json&
      settings;  ///< complete; only for the solver's free_fall_m, because no metric may use a setting by name
  std::vector<double> contact_margins_m = {};  ///< copied from the solver's Plan
};

/// Contact of the cloth with all colliders in one frame (collider_contact.hpp). NaN if the cloth is not finite.
struct SceneContact {
  double length_m;  ///< length of the curves in which cloth and colliders cross
  double depth_m;   ///< NaN if no collider has an inside
};

/// Touch and slip of the cloth on colliders in one frame (collider_contact.hpp). NaN if the cloth is not finite.
struct SceneTouch {
  double touching_fraction;  ///< fraction of the cloth's rest area
  double slip_m;  ///< mean distance slid on the surface by vertices that touch in this and the previous frame
};

/// Self-intersection of the cloth in one frame; NaN if it is not finite.
struct SelfContact {
  double length_m;  ///< length of the curves in which the cloth crosses itself
  double pairs;     ///< number of intersecting pairs of triangles that share no vertex
};

/// Distance of one frame from the scene's exact solution. Positions are compared on the fixed 33 x 33 material lattice,
/// relative to the longer side. NaN if the state is not finite or the reference case gives no value.
struct TruthErrors {
  double e2 = kMissing;                                   ///< positions: RMS
  double quantity = kMissing;                             ///< the reference case's quantity, computed from this state
  double quantity_error = kMissing;                       ///< |quantity - exact| over the reference case's scale
  double stretch_p99 = kMissing, stretch_max = kMissing;  ///< strain minus exact strain, edges along u
};

/// Outcome classes of one frame: F0 not finite or unbounded, F1 energy gain, F2 strain beyond the load. The runner sets
/// F3 (time limit, device). Thresholds: stability/judge.cpp. NaN: not defined, or not yet evaluated.
struct StabilityFrame {
  unsigned classes = 0;             ///< bit k: class Fk occurred; only classes that the scene evaluates
  double speed = kMissing;          ///< maximum vertex speed over v_char
  double energy_gain = kMissing;    ///< divided by M g L (M v_char^2 without gravity)
  double strain_excess = kMissing;  ///< maximum strain beyond the exact or load strain
  /// Whether the run has failed for good (F0 or F1).
  bool lost() const { return (classes & 3u) != 0; }
};

/// One frame of an accuracy pass.
struct MetricFrame {
  const MetricContext& context;
  int index;  ///< 0 = initial state
  const ClothState& state;
  std::optional<SceneContact> contact = {};      ///< none if the scene has no collider
  std::optional<SceneTouch> touch = {};          ///< none if the scene has no collider
  std::optional<SelfContact> self_contact = {};  ///< none if the scene's cloth has no self-collision
  std::optional<TruthErrors> truth = {};         ///< none if the scene names no exact solution
  std::optional<StabilityFrame> stability = {};  ///< none if the scene has no stability rules
};

/// Condition on scenes under which an entry of the registry is defined.
struct Needs {
  const char* words;  ///< as documents print it, such as "colliders"
  bool (*met)(const Scene&);
};

inline constexpr Needs kAlways{"every scene", [](const Scene&) { return true; }};
/// Whether the scene has no pins, no grips and no colliders.
inline bool touches_nothing(const Scene& s) {
  return s.pins.vertices.empty() && s.grips.vertices.empty() && s.colliders.empty();
}

inline constexpr Needs kGravity{"gravity", [](const Scene& s) { return s.gravity_m_per_s2 != Vec3{}; }};

/// One number per frame, computed only for scenes that fulfil `needs`. A state that is not finite gives NaN.
struct Metric {
  std::string name, units;
  std::string long_name;  ///< one plain phrase: help, result files, documents and the page show it
  Needs needs;
  std::function<double(const MetricFrame&)> value;
  int series_column = 0;  ///< column in series.csv, from 1; 0: not a column
  bool applies(const Scene& s) const { return needs.met(s); }
};

inline bool finite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace clothbench
