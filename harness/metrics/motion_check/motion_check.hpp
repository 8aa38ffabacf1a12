#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::motion_check {

/// The check of every run of every scene, from stored positions only; README.md defines each statistic.
enum class Check : std::uint8_t {
  Kinematic,   ///< attached vertices and the start are where the scene puts them
  Dynamic,     ///< the motion obeys momentum, energy and the speeds that the scene can cause
  Continuous,  ///< nothing crosses a collider, also between stored frames
  Present      ///< contact that the scene implies takes place
};

/// One number of a check.
struct Statistic {
  const char* name;
  Check check;
  const char* what;  ///< what is compared with its tolerance
};

inline constexpr std::size_t kStatistics = 26;
/// All statistics, in the order of the findings.
std::span<const Statistic> statistics();
const char* name_of(Check);

/// Passing points in a frame: none are allowed.
inline constexpr double kCrossingTolerance = 0.5;

/// The outcome of one statistic: its largest value over its tolerance. The check fails unless ratio <= 1.
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

/// Checks a motion of the scene's cloth. `contact_offsets_m`: the distance at which the solver says that it keeps cloth
/// from each collider, as in Plan::contact_margins_m. A statistic that the scene does not define is left out. Throws
/// Error if the positions are not whole frames of the scene's vertices.
std::vector<Finding> verify(const Scene& scene, const Frames& frames, std::span<const double> contact_offsets_m = {});

/// The findings with the largest ratio, NaN before all others; null if there are none.
const Finding* worst(std::span<const Finding> findings);

}  // namespace clothbench::motion_check
