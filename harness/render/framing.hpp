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
};

/// Cloth that has left its place (by more than its own size, of one that is held, or beside a collider) does not count:
/// it would make all the rest a dot. Not finite vertices do not either. With none left, the start's place.
Framing framing_of(const Motion&, std::span<const std::size_t> frames);

}  // namespace clothbench::render
