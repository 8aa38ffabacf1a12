#pragma once
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clothbench/scene.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {

/// What a metric may look at besides the state: the scene and the solver's declarations, never the solver.
struct MetricContext {
  const Scene& scene;
  const SolverEntry& entry;
  const nlohmann::json&
      settings;  ///< complete; only for the solver's own free_fall_m, for no metric knows a setting by its name
  std::vector<double> contact_margins_m = {};  ///< as in the solver's Plan
};

/// How the cloth touches all colliders of the scene in one frame; collider_contact.hpp says how they are put together.
/// All are NaN if the cloth is not finite, and those that no collider of the scene defines always.
struct SceneContact {
  double length_m, pairs, cloth_fraction;
  double tunnelled_fraction, tunnelled_depth_m;
  double depth_m, depth_vertex_m, depth_p99_m, depth_mean_m, area_m2;
};

/// Where the cloth went past the colliders and how it slides on them, in one frame; collider_passage.hpp. All are NaN
/// if the cloth is not finite, the first two also if it ever was not, and where no collider has a centre line.
struct ScenePassage {
  double wrong_side_fraction;  ///< of the samples' area
  double wrong_side_samples;   ///< how many vertices and cell centres
  double touching_fraction;    ///< of the vertices' area
  double slip_m;               ///< mean way that vertices which touch, now and a frame before, slid on the surface
};

/// How the cloth crosses itself in one frame; NaN if it is not finite.
struct SelfContact {
  double length_m;  ///< of the curves in which it does
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
  const ScenePassage* passage = nullptr;      ///< the same
  const TruthErrors* truth = nullptr;         ///< null where the scene states no truth
  const StabilityFrame* stability = nullptr;  ///< null where the scene is not judged
  const SelfContact* self_contact = nullptr;  ///< null where the scene's cloth does not touch itself
};

/// One number a frame. A scene pays for a metric only if `applies` says so. A state that is not finite gives NaN.
struct Metric {
  std::string name, units, long_name;
  std::function<bool(const Scene&)> applies;
  std::function<double(const MetricFrame&)> value;
  int version = 1;  ///< of its rule: to be raised by whoever changes what it counts, so that no table mixes the two
};

/// All metrics: one file and one row each (metrics.cpp).
const std::vector<Metric>& metrics();

/// Version of the rule of a metric of this program; 0 if it has none of that name.
int metric_version(const std::string& name);

/// The metrics that a value of a result's summary is computed from, "expect.<value>" as the value itself; none for what
/// is measured otherwise (times, bytes, counts).
std::vector<std::string> metrics_behind(const std::string& summary_name);

/// Greater of two numbers, and NaN if either is: std::max would lose it.
inline double max_or_nan(double a, double b) { return b <= a || a != a ? a : b; }

inline bool finite(const std::vector<double>& values) {
  for (double v : values)
    if (!std::isfinite(v)) return false;
  return true;
}

/// Length of a vector. Not std::hypot(x, y, z): libstdc++'s gives 0 for (0, NaN, 0).
inline double norm(double x, double y, double z) { return std::sqrt(x * x + y * y + z * z); }

/// Greatest (or root mean square) distance of a vertex from the free fall of the solver's own integrator, over
/// |g| T^2 / 2; NaN at T = 0.
double free_fall_error_max(const MetricFrame&);
double free_fall_error_rms(const MetricFrame&);

/// (|x| - l)/l over the structural edges: greatest, root mean square, mean; mean of what is above 0.
double stretch_max(const MetricFrame&);
double stretch_rms(const MetricFrame&);
double stretch_mean(const MetricFrame&);
double stretch_mean_positive(const MetricFrame&);

/// |P - P0 - M g t| / (M (sqrt(|g| L) + |v0|)), L the longer side, v0 the initial velocity.
double momentum_error(const MetricFrame&);

/// Greatest vertex speed [m/s].
double speed_max(const MetricFrame&);

/// Sum over the vertices of m v^2 / 2 [J].
double kinetic_energy(const MetricFrame&);

/// Work done against gravity since the start, the sum of -m g . (x - x0) [J].
double gravity_energy(const MetricFrame&);

/// Greatest distance [m] of a held vertex from where the hand that holds it has it.
double grip_error(const MetricFrame&);

/// Root mean square angle [rad] between the normals of neighbouring cells.
double fold_angle_rms(const MetricFrame&);

/// Of that angle the share at wavelengths of up to two cells, which no smooth fold has: 0 smooth, 1 creased at every
/// line.
double fold_roughness(const MetricFrame&);

/// Energy less that at the start, over M g L, of scenes that keep it: see energy_rise in truth_errors.hpp.
double energy_rise(const MetricFrame&);

}  // namespace clothbench
