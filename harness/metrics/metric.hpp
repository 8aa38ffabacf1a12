#pragma once
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

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

/// Contact of the cloth with all colliders of the scene in one frame (collider_contact.hpp). NaN if the cloth is not
/// finite.
struct SceneContact {
  double length_m;  ///< of the curves in which cloth and colliders cross
  double depth_m;   ///< NaN if no collider has an inside
};

/// Where the cloth touches the colliders and how it slides on them, in one frame (collider_contact.hpp). NaN if the
/// cloth is not finite.
struct SceneTouch {
  double touching_fraction;  ///< of the triangles' rest area
  double slip_m;  ///< mean distance slid on the surface by vertices that touch in this and the previous frame
};

/// Self-intersection of the cloth in one frame; NaN if it is not finite.
struct SelfContact {
  double length_m;  ///< of the curves of self-intersection
  double pairs;     ///< of triangles that meet and share no vertex
};

struct TruthErrors;
struct StabilityFrame;

/// One frame of an accuracy pass.
struct MetricFrame {
  const MetricContext& context;
  int index;  ///< 0 = initial state
  const ClothState& state;
  const SceneContact* contact;                ///< null where the scene has no collider
  const SceneTouch* touch = nullptr;          ///< the same
  const TruthErrors* truth = nullptr;         ///< null where the scene states no truth
  const StabilityFrame* stability = nullptr;  ///< null where the scene is not judged
  const SelfContact* self_contact = nullptr;  ///< null where the scene's cloth does not touch itself
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

/// Greater of two numbers, and NaN if either is: std::max would lose it.
inline double max_or_nan(double a, double b) { return b <= a || a != a ? a : b; }

inline bool finite(const std::vector<double>& values) {
  for (double v : values)
    if (!std::isfinite(v)) return false;
  return true;
}

}  // namespace clothbench
