#pragma once
#include <optional>
#include <span>

#include "render/camera.hpp"
#include "render/motion.hpp"
#include "render/surfaces.hpp"

namespace clothbench::render {

/// What the pictures of some frames show, all from one camera.
struct Framing {
  Bounds near;                 ///< where the cloth is, and a margin: colliders beyond are cut off
  Vec3 origin_m{};             ///< in the middle of it
  std::vector<double> points;  ///< all that has to be in the picture, xyz interleaved [m]
  /// The vertex the camera goes with, of a cloth that nothing holds and that leaves its place.
  std::optional<std::uint32_t> followed;
  double turn_deg = 0;  ///< how far round the scene front and corner stand, in quarters: see best_turn
};

/// Cloth that has left its place (by more than its own size, of one that is held, or beside a collider) does not count:
/// it would make all the rest a dot. Not finite vertices do not either. With none left, the start's place.
Framing framing_of(const Motion&, std::span<const std::size_t> frames);

/// The quarter turn from whose corner the most cloth is seen, in m^2 of the picture plane over `frames`, where
/// static colliders hide some of it: a cloth over the far edge of a desk is shown from there. 0 unless another shows a
/// fifth more, and where colliders move or there are none.
double best_turn(const Motion&, std::span<const std::size_t> frames, const Bounds& near);

/// Frames that the pictures of `wanted` are framed by: some of all there are, so that every picture of a motion has the
/// same camera and shows what the cloth comes to; `wanted` alone where nothing holds the cloth and the camera goes with
/// it.
std::vector<std::size_t> framed_by(const Motion&, std::span<const std::size_t> wanted);

}  // namespace clothbench::render
