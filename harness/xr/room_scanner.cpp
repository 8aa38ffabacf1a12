#include "xr/room_scanner.hpp"

#include <fmt/format.h>

namespace clothbench::xr {
namespace {

std::string text_of(const Uuid& uuid) {
  std::string text;
  for (std::size_t k = 0; k < std::size(uuid.data); ++k)
    text += fmt::format("{}{:02x}", k == 4 || k == 6 || k == 8 || k == 10 ? "-" : "", uuid.data[k]);
  return text;
}

}  // namespace

bool RoomScanner::offered(const Instance& xr) {
  return xr.has(kSpatialEntity) && xr.has(kSpatialEntityQuery) && xr.has(kSpatialEntityMesh);
}

RoomScanner::RoomScanner(Session& session) : session_(session) {
  session.on_event = [this](const XrEventDataBuffer& e) { take(e); };
  const SpaceComponentFilter with_mesh{kTypeSpaceComponentFilter, nullptr, kComponentTriangleMesh};
  constexpr std::uint32_t kMostRooms = 16;
  const SpaceQuery query{kTypeSpaceQuery, nullptr, 0, kMostRooms, XR_NO_DURATION, &with_mesh, nullptr};
  const Instance& xr = session.instance();
  xr.check(xr.function<QuerySpaces>("xrQuerySpacesFB")(session.handle(), &query, &request_), "xrQuerySpacesFB");
}

RoomScanner::~RoomScanner() {
  session_.on_event = nullptr;
  if (room_ != XR_NULL_HANDLE) session_.instance().xr().xrDestroySpace(room_);
}

void RoomScanner::take(const XrEventDataBuffer& event) {
  if (event.type == kTypeSpaceQueryAvailable &&
      reinterpret_cast<const EventSpaceQueryAvailable&>(event).request == request_)
    retrieve();
  if (event.type == kTypeSpaceQueryComplete) {
    const auto& done = reinterpret_cast<const EventSpaceQueryComplete&>(event);
    if (done.request != request_) return;
    session_.instance().check(done.result, "xrQuerySpacesFB");
    complete_ = true;
  }
}

void RoomScanner::retrieve() {
  const Instance& xr = session_.instance();
  const auto get = xr.function<RetrieveSpaceQueryResults>("xrRetrieveSpaceQueryResultsFB");
  SpaceQueryResults results{kTypeSpaceQueryResults, nullptr, 0, 0, nullptr};
  xr.check(get(session_.handle(), request_, &results), "xrRetrieveSpaceQueryResultsFB");
  std::vector<SpaceQueryResult> found(results.count);
  results.capacity = results.count;
  results.results = found.data();
  xr.check(get(session_.handle(), request_, &results), "xrRetrieveSpaceQueryResultsFB");
  for (const SpaceQueryResult& r : found) {
    // A scan has one mesh for all of the room; further ones are not ours to choose from.
    if (room_ != XR_NULL_HANDLE) {
      xr.xr().xrDestroySpace(r.space);
      continue;
    }
    room_ = r.space;
    uuid_ = text_of(r.uuid);
  }
}

bool RoomScanner::locatable(XrSpace space) {
  const Instance& xr = session_.instance();
  ComponentStatus status{kTypeComponentStatus, nullptr, XR_FALSE, XR_FALSE};
  xr.check(xr.function<GetSpaceComponentStatus>("xrGetSpaceComponentStatusFB")(space, kComponentLocatable, &status),
           "xrGetSpaceComponentStatusFB");
  if (status.enabled == XR_TRUE && status.change_pending == XR_FALSE) return true;
  if (!asked_to_locate_ && status.change_pending == XR_FALSE) {
    const ComponentStatusSet set{kTypeComponentStatusSet, nullptr, kComponentLocatable, XR_TRUE, XR_NO_DURATION};
    RequestId id = 0;
    xr.check(xr.function<SetSpaceComponentStatus>("xrSetSpaceComponentStatusFB")(space, &set, &id),
             "xrSetSpaceComponentStatusFB");
    asked_to_locate_ = true;
  }
  return false;
}

std::optional<assets::RoomScan> RoomScanner::at(XrTime time) {
  if (room_ == XR_NULL_HANDLE) {
    if (complete_)
      throw Error(
          "the headset has no mesh of this room; scan the room in the headset's settings (Space Setup) and "
          "give this app access to the scan",
          ExitCode::CheckFailed);
    return std::nullopt;
  }
  assets::RoomScan scan;
  scan.uuid = uuid_;
  if (!locatable(room_) || !locate(time, scan)) return std::nullopt;
  read_mesh(scan);
  return scan;
}

bool RoomScanner::locate(XrTime time, assets::RoomScan& scan) const {
  const auto pose = session_.locate(room_, time);
  if (!pose) return false;
  scan.position_m = {pose->position.x, pose->position.y, pose->position.z};
  scan.orientation = {pose->orientation.x, pose->orientation.y, pose->orientation.z, pose->orientation.w};
  return true;
}

void RoomScanner::read_mesh(assets::RoomScan& scan) const {
  const Instance& xr = session_.instance();
  const auto get = xr.function<GetSpaceTriangleMesh>("xrGetSpaceTriangleMeshMETA");
  const TriangleMeshGetInfo info{kTypeTriangleMeshGetInfo, nullptr};
  TriangleMeshOutput mesh{kTypeTriangleMesh, nullptr, 0, 0, nullptr, 0, 0, nullptr};
  xr.check(get(room_, &info, &mesh), "xrGetSpaceTriangleMeshMETA");
  std::vector<XrVector3f> vertices(mesh.vertex_count);
  scan.indices.resize(mesh.index_count);
  mesh.vertex_capacity = mesh.vertex_count;
  mesh.vertices = vertices.data();
  mesh.index_capacity = mesh.index_count;
  mesh.indices = scan.indices.data();
  xr.check(get(room_, &info, &mesh), "xrGetSpaceTriangleMeshMETA");
  for (const XrVector3f& v : vertices) scan.vertices_m.insert(scan.vertices_m.end(), {v.x, v.y, v.z});
}

}  // namespace clothbench::xr
