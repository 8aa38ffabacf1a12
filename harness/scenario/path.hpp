#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "clothbench/collider.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {

/// Motion of a bar or a capsule. The speed rises as sin^2(pi t / 2 ramp_s), then stays constant until `stop_s`. Jumps
/// are added to this, each within the frame that contains its time.
struct Path {
  Vec3 velocity_m_per_s{};
  double ramp_s = 0, start_s = 0;
  std::optional<double> stop_s, release_s;
  struct At {
    double time_s = 0;
    Vec3 by_m{};
  };
  std::vector<At> jumps;

  /// Reads velocity_m_per_s from completed JSON, and ramp_s, start_s, stop_s, release_s, jumps where present.
  static Path read(const nlohmann::json&);
  /// Displacement [m] at `time_s`.
  Vec3 displacement(double time_s) const;
  bool held(double time_s) const { return !release_s || time_s < *release_s; }
};

/// Adds this path's jumps to the scene, each with the frame that contains it.
void note_jumps(const Path&, Scene&);

/// A capsule about `center_m` at a time: `length_m` along `axis` (a unit vector), turned by `spin_rad_per_s` x time.
Capsule moved_capsule(const Path&, const Vec3& center_m, const Vec3& axis, double length_m, double radius_m,
                      const Vec3& spin_rad_per_s, double time_s);

}  // namespace clothbench
