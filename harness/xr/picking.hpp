#pragma once
#include <optional>
#include <string>
#include <vector>

#include "assets/room.hpp"
#include "render/surfaces.hpp"
#include "xr/controllers.hpp"
#include "xr/room_scanner.hpp"

namespace clothbench::xr {

/// Set-up 2 of Kim, Ma & Hong (2025), section 3.2.4: the user shows the scanned room by pressing A and picks six points
/// of it with the trigger. The cloth meets the part of the room in the axis-aligned box round these points.
class Picking {
 public:
  explicit Picking(Session&);

  /// Processes the user's input up to this frame. True once the room is available and six points are picked.
  bool ready(XrTime);
  std::string waiting_for() const;
  const std::optional<assets::RoomScan>& scan() const { return scan_; }
  const std::vector<Vec3>& picked() const { return picked_; }

  /// Whether `surfaces` differs from its last result.
  bool changed() const { return changed_; }
  /// The room, if it is shown, and a mark at each picked point.
  render::Surfaces surfaces();

 private:
  RoomScanner scanner_;
  Controllers controllers_;
  std::optional<assets::RoomScan> scan_;
  assets::TriangleMesh room_;  ///< in the scene's space
  bool shown_ = false, changed_ = false;
  std::vector<Vec3> picked_;
};

/// Nearest intersection of a ray with the mesh, on either side of its triangles; empty if there is none.
std::optional<Vec3> hit(const assets::TriangleMesh&, const Ray&);

}  // namespace clothbench::xr
