#pragma once
#include <optional>
#include <span>

#include "render/camera.hpp"
#include "render/motion.hpp"
#include "render/surfaces.hpp"

namespace clothbench::render {

/// The region that the pictures of some frames show, all from one camera.
struct Framing {
  Bounds near;                 ///< of the cloth, with a margin; colliders beyond are cut off
  Vec3 origin_m{};             ///< centre of the cloth's bounds
  std::vector<double> points;  ///< points that must be in the picture, xyz interleaved [m]
  /// The vertex that the camera follows, if nothing holds the cloth and it leaves its initial place.
  std::optional<std::uint32_t> followed;
  double turn_deg = 0;  ///< turn of the views front and corner, a multiple of 90: see best_turn
};

/// Ignores vertices that are not finite. Of a cloth that is held or meets colliders, also ignores vertices that left
/// the initial bounds by more than the cloth's size, since they would make the rest tiny. With no vertex left, frames
/// the initial bounds.
Framing framing_of(const Motion&, std::span<const std::size_t> frames);

/// The quarter turn whose corner view shows the most cloth, in m^2 of the picture plane summed over `frames`, if static
/// colliders hide some of it: a cloth over the far edge of a desk is shown from the far side. 0 unless another turn
/// shows a fifth more; 0 if colliders move or there are none.
double best_turn(const Motion&, std::span<const std::size_t> frames, const Bounds& near);

/// Frames that determine the camera for the pictures of `wanted`. If the cloth is held: `wanted` and a sample of all
/// frames, so that every picture of a motion has the same camera. If nothing holds the cloth and the camera follows it:
/// `wanted` alone.
std::vector<std::size_t> framed_by(const Motion&, std::span<const std::size_t> wanted);

}  // namespace clothbench::render
