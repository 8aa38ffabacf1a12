#pragma once
#include <optional>
#include <string>
#include <vector>

#include "assets/room.hpp"
#include "render/surfaces.hpp"
#include "xr/controllers.hpp"
#include "xr/room_scanner.hpp"

namespace clothbench::xr {

/// Set-up 2 of Kim, Ma & Hong (2025), section 3.2.4: the user sees the scanned room at the press of A and picks six
/// points of it by the trigger; the axis-aligned box round them says which part of it the cloth meets.
class Picking {
 public:
  explicit Picking(Session&);

  /// Takes what the user does until this frame. True once the room is there and six points are picked.
  bool ready(XrTime);
  std::string waiting_for() const;
  const std::optional<assets::RoomScan>& scan() const { return scan_; }
  const std::vector<Vec3>& picked() const { return picked_; }

  /// Whether `surfaces` differ from those given last.
  bool changed() const { return changed_; }
  /// The room where it is shown, and a mark at each point.
  render::Surfaces surfaces();

 private:
  RoomScanner scanner_;
  Controllers controllers_;
  std::optional<assets::RoomScan> scan_;
  assets::TriangleMesh room_;  ///< in the scene's space
  bool shown_ = false, changed_ = false;
  std::vector<Vec3> picked_;
};

/// Nearest point of the mesh on a ray, of either side of its triangles; empty if it meets none.
std::optional<Vec3> hit(const assets::TriangleMesh&, const Ray&);

}  // namespace clothbench::xr
