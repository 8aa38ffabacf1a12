#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::motion_check {

/// The checks of every run of every scene, from stored positions only; README.md defines each statistic.
enum class Check : std::uint8_t {
  Kinematic,   ///< attached vertices and the start are at the scene's positions
  Dynamic,     ///< the motion obeys momentum, energy and the speeds that the scene can cause
  Continuous,  ///< nothing crosses a collider, also between stored frames
  Present      ///< contact that follows from the scene takes place
};

/// One number of a check.
struct Statistic {
  const char* name;
  Check check;
  const char* what;  ///< the value that is compared with its tolerance
};

inline constexpr std::size_t kStatistics = 26;
/// All statistics, in the order of the findings.
std::span<const Statistic> statistics();
const char* name_of(Check);

/// Allowed number of passages per frame: below one, so none.
inline constexpr double kCrossingTolerance = 0.5;

/// Result of one statistic: its largest value divided by its tolerance. The check fails unless ratio <= 1.
struct Finding {
  const Statistic* statistic = nullptr;
  double ratio = 0;
  int frame = 0;
};

/// Stored positions of one run.
struct Frames {
  std::span<const double> time_s;   ///< one per frame, from the start on
  std::span<const float> position;  ///< [m] (frames, vertices, 3)
};

/// Checks a motion of the scene's cloth. `contact_offsets_m`: the solver's contact offset for each collider, as in
/// Plan::contact_margins_m. A statistic that is not defined for the scene is omitted. Throws Error if the positions do
/// not fill whole frames of the scene's vertices.
std::vector<Finding> verify(const Scene& scene, const Frames& frames, std::span<const double> contact_offsets_m = {});

/// The finding with the largest ratio, NaN before all others; null if there are none.
const Finding* worst(std::span<const Finding> findings);

}  // namespace clothbench::motion_check
