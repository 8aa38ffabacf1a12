#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "clothbench/collider.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {

/// How a bar or a capsule moves. Speeds up as sin^2(pi t / 2 ramp_s), then keeps its velocity until it stops; jumps
/// come on top, within the frame in which they fall.
struct Path {
  Vec3 velocity_m_per_s{};
  double ramp_s = 0, start_s = 0;
  std::optional<double> stop_s, release_s;
  struct At {
    double time_s = 0;
    Vec3 by_m{};
  };
  std::vector<At> jumps;

  /// Of what the completed JSON has of velocity_m_per_s, ramp_s, start_s, stop_s, release_s, jumps.
  static Path read(const nlohmann::json&);
  /// How far it has come at `time_s` [m].
  Vec3 way(double time_s) const;
  bool held(double time_s) const { return !release_s || time_s < *release_s; }
};

/// The scene's jumps of this path, by the frames in which they fall.
void note_jumps(const Path&, Scene&);

/// A capsule about `center_m` at a time: `length_m` along `axis` (a unit vector), turned by `spin_rad_per_s` x time.
Capsule moved_capsule(const Path&, const Vec3& center_m, const Vec3& axis, double length_m, double radius_m,
                      const Vec3& spin_rad_per_s, double time_s);

}  // namespace clothbench
