#pragma once
#include <optional>

#include "assets/room.hpp"
#include "xr/session.hpp"

namespace clothbench::xr {

/// The mesh of the room that the headset's user has scanned (XR_FB_spatial_entity_query, XR_META_spatial_entity_mesh).
class RoomScanner {
 public:
  static bool offered(const Instance&);
  /// Queries the mesh. Sets Session::on_event for its lifetime.
  explicit RoomScanner(Session&);
  ~RoomScanner();
  RoomScanner(const RoomScanner&) = delete;
  RoomScanner& operator=(const RoomScanner&) = delete;

  /// The mesh in its local frame, and that frame in the scene's space; empty until both are available. Throws Error if
  /// the runtime has no room.
  std::optional<assets::RoomScan> at(XrTime);

 private:
  void take(const XrEventDataBuffer&);
  void retrieve();
  bool locatable(XrSpace);
  bool locate(XrTime, assets::RoomScan&) const;
  void read_mesh(assets::RoomScan&) const;

  Session& session_;
  RequestId request_ = 0;
  bool complete_ = false, asked_to_locate_ = false;
  XrSpace room_ = XR_NULL_HANDLE;
  std::string uuid_;
};

}  // namespace clothbench::xr
