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

/// Inputs of a metric besides the state: the scene and the solver's declarations, never the solver itself.
struct MetricContext {
  const Scene& scene;
  const SolverEntry& entry;
  const nlohmann::json&
      settings;  ///< complete; only passed to the solver's free_fall_m, as no metric may depend on a setting by name
  std::vector<double> contact_margins_m = {};  ///< as in the solver's Plan
};

/// Contact of the cloth with all colliders in one frame (collider_contact.hpp). NaN if the cloth is not finite.
struct SceneContact {
  double length_m;  ///< of the curves in which cloth and colliders cross
  double depth_m;   ///< NaN if no collider has an inside
};

/// Where the cloth touches and slides on colliders in one frame (collider_contact.hpp). NaN if the cloth is not finite.
struct SceneTouch {
  double touching_fraction;  ///< of the triangles' rest area
  double slip_m;  ///< mean distance slid on the surface by vertices that touch in this and the previous frame
};

/// Self-intersection of the cloth in one frame; NaN if it is not finite.
struct SelfContact {
  double length_m;  ///< of the curves of self-intersection
  double pairs;     ///< of triangles that meet and share no vertex
};

/// Distance of one frame from the scene's truth. Positions are compared on the fixed 33 x 33 material lattice, relative
/// to the longer side. NaN if the state is not finite or the reference case has no answer.
struct TruthErrors {
  double e2 = kMissing;                                   ///< positions: RMS
  double quantity = kMissing;                             ///< the reference case's quantity of this state
  double quantity_error = kMissing;                       ///< |quantity - true| over the reference case's scale
  double stretch_p99 = kMissing, stretch_max = kMissing;  ///< strain less true strain, edges along u
};

/// One frame rated by the outcome classes F0 not finite or unbounded, F1 energy gained, F2 strain beyond the load (F3,
/// budget and device, is the runner's). Thresholds: stability/judge.cpp. NaN: not defined, or not yet counted.
struct StabilityFrame {
  unsigned classes = 0;             ///< bit k: Fk, only classes that the scene judges
  double speed = kMissing;          ///< maximum vertex speed over v_char
  double energy_gain = kMissing;    ///< over M g L (M v_char^2 without gravity)
  double strain_excess = kMissing;  ///< maximum
  /// Whether the run cannot recover.
  bool lost() const { return (classes & 3u) != 0; }
};

/// One frame of an accuracy pass.
struct MetricFrame {
  const MetricContext& context;
  int index;  ///< 0 = initial state
  const ClothState& state;
  std::optional<SceneContact> contact = {};      ///< none where the scene has no collider
  std::optional<SceneTouch> touch = {};          ///< the same
  std::optional<SelfContact> self_contact = {};  ///< none where the scene's cloth does not touch itself
  std::optional<TruthErrors> truth = {};         ///< none where the scene states no truth
  std::optional<StabilityFrame> stability = {};  ///< none where the scene is not judged
};

/// Which scenes an entry of the registry is defined for.
struct Needs {
  const char* words;  ///< "colliders"
  bool (*met)(const Scene&);
};

inline constexpr Needs kAlways{"every scene", [](const Scene&) { return true; }};
/// Whether the scene has no pins, no grips and no colliders.
inline bool touches_nothing(const Scene& s) {
  return s.pins.vertices.empty() && s.grips.vertices.empty() && s.colliders.empty();
}

inline constexpr Needs kGravity{"gravity", [](const Scene& s) { return s.gravity_m_per_s2 != Vec3{}; }};

/// One number per frame, computed only for scenes that meet its needs. A state that is not finite gives NaN.
struct Metric {
  std::string name, units;
  std::string long_name;  ///< one plain phrase: help, result files, documents and the page show it
  Needs needs;
  std::function<double(const MetricFrame&)> value;
  int series_column = 0;  ///< place among the columns of series.csv, from 1; 0: not there
  bool applies(const Scene& s) const { return needs.met(s); }
};

inline bool finite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace clothbench
