#pragma once
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clothbench/scene.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {

/// What a metric may look at besides the state: the scene and the solver's declaration, never the solver.
struct MetricContext {
  const Scene& scene;
  const SolverEntry& entry;
  const nlohmann::json& settings;  ///< complete
};

/// One number a frame. A scene pays for a metric only if `applies` says so. A state that is not finite gives NaN.
struct Metric {
  std::string name, units, long_name;
  std::function<bool(const Scene&)> applies;
  std::function<double(const MetricContext&, int frame, const ClothState&)> value;
};

/// All metrics: one file and one row each (metrics.cpp).
const std::vector<Metric>& metrics();

/// Greater of two numbers, and NaN if either is: std::max would lose it.
inline double max_or_nan(double a, double b) { return b <= a || a != a ? a : b; }

/// Length of a vector. Not std::hypot(x, y, z): libstdc++'s gives 0 for (0, NaN, 0).
inline double norm(double x, double y, double z) { return std::sqrt(x * x + y * y + z * z); }

/// Greatest (or root mean square) distance of a vertex from the free fall of the solver's own integrator, over
/// |g| T^2 / 2; NaN at T = 0.
double free_fall_error_max(const MetricContext&, int frame, const ClothState&);
double free_fall_error_rms(const MetricContext&, int frame, const ClothState&);

/// (|x| - l)/l over the structural edges: greatest, root mean square, mean.
double stretch_max(const MetricContext&, int frame, const ClothState&);
double stretch_rms(const MetricContext&, int frame, const ClothState&);
double stretch_mean(const MetricContext&, int frame, const ClothState&);

/// |P - P0 - M g t| / (M sqrt(|g| L)), L the longer side.
double momentum_error(const MetricContext&, int frame, const ClothState&);

/// Greatest vertex speed [m/s].
double speed_max(const MetricContext&, int frame, const ClothState&);

}  // namespace clothbench
