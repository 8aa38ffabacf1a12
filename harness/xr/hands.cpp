#include "xr/hands.hpp"

#include <algorithm>

namespace clothbench::xr {
namespace {

using assets::Side;

static_assert(assets::kRecordedJointCount == XR_HAND_JOINT_COUNT_EXT);
static_assert(std::extent_v<decltype(XrHandTrackingCapsulesStateFB::capsules)> == assets::kCapsuleCount);

/// Whether position and orientation are known.
bool is_known(XrSpaceLocationFlags flags) {
  constexpr XrSpaceLocationFlags kKnown =
      XR_SPACE_LOCATION_POSITION_VALID_BIT | XR_SPACE_LOCATION_ORIENTATION_VALID_BIT;
  return (flags & kKnown) == kKnown;
}

std::array<float, 3> three(const XrVector3f& v) { return {v.x, v.y, v.z}; }

assets::RecordedJoint joint(const XrPosef& p, float radius) {
  return {three(p.position), {p.orientation.x, p.orientation.y, p.orientation.z, p.orientation.w}, radius};
}

/// The runtime's arrays, sized by a first call.
struct MeshArrays {
  std::vector<XrPosef> bind;
  std::vector<float> radii;
  std::vector<XrHandJointEXT> parents;
  std::vector<XrVector3f> positions, normals;
  std::vector<XrVector2f> uvs;
  std::vector<XrVector4sFB> joints;
  std::vector<XrVector4f> weights;
  std::vector<std::int16_t> indices;

  void attach(XrHandTrackingMeshFB& m) {
    const auto joint_count = m.jointCountOutput, vertices = m.vertexCountOutput, corners = m.indexCountOutput;
    bind.resize(joint_count), radii.resize(joint_count), parents.resize(joint_count);
    positions.resize(vertices), normals.resize(vertices), uvs.resize(vertices), joints.resize(vertices),
        weights.resize(vertices);
    indices.resize(corners);
    m.jointCapacityInput = joint_count;
    m.jointBindPoses = bind.data();
    m.jointRadii = radii.data();
    m.jointParents = parents.data();
    m.vertexCapacityInput = vertices;
    m.vertexPositions = positions.data();
    m.vertexNormals = normals.data();
    m.vertexUVs = uvs.data();
    m.vertexBlendIndices = joints.data();
    m.vertexBlendWeights = weights.data();
    m.indexCapacityInput = corners;
    m.indices = indices.data();
  }
};

}  // namespace

Hands::Hands(const Session& session) : session_(session) {
  const Instance& xr = session.instance();
  capsules_ = xr.has(XR_FB_HAND_TRACKING_CAPSULES_EXTENSION_NAME);
  locate_ = xr.function<PFN_xrLocateHandJointsEXT>("xrLocateHandJointsEXT");
  const auto create = xr.function<PFN_xrCreateHandTrackerEXT>("xrCreateHandTrackerEXT");
  for (const Side side : {Side::Left, Side::Right}) {
    auto info = blank<XrHandTrackerCreateInfoEXT>(XR_TYPE_HAND_TRACKER_CREATE_INFO_EXT);
    info.hand = side == Side::Left ? XR_HAND_LEFT_EXT : XR_HAND_RIGHT_EXT;
    info.handJointSet = XR_HAND_JOINT_SET_DEFAULT_EXT;
    xr.check(create(session.handle(), &info, &trackers_[static_cast<std::size_t>(side)]), "xrCreateHandTrackerEXT");
  }
}

Hands::~Hands() {
  const auto destroy = session_.instance().function<PFN_xrDestroyHandTrackerEXT>("xrDestroyHandTrackerEXT");
  for (const XrHandTrackerEXT t : trackers_)
    if (t != XR_NULL_HANDLE) destroy(t);
}

std::optional<assets::RecordedHand> Hands::at(Side side, XrTime time) const {
  auto info = blank<XrHandJointsLocateInfoEXT>(XR_TYPE_HAND_JOINTS_LOCATE_INFO_EXT);
  info.baseSpace = session_.space();
  info.time = time;
  auto shapes = blank<XrHandTrackingCapsulesStateFB>(XR_TYPE_HAND_TRACKING_CAPSULES_STATE_FB);
  std::array<XrHandJointLocationEXT, XR_HAND_JOINT_COUNT_EXT> joints{};
  auto found = blank<XrHandJointLocationsEXT>(XR_TYPE_HAND_JOINT_LOCATIONS_EXT);
  // The headers of 1.0.20 chain this struct to the input; the specification chains it to the output.
  found.next = capsules_ ? &shapes : nullptr;
  found.jointCount = static_cast<std::uint32_t>(joints.size());
  found.jointLocations = joints.data();
  session_.instance().check(locate_(trackers_[static_cast<std::size_t>(side)], &info, &found), "xrLocateHandJointsEXT");
  if (found.isActive != XR_TRUE) return std::nullopt;
  assets::RecordedHand hand;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    if (!is_known(joints[k].locationFlags)) return std::nullopt;
    hand.joints[k] = joint(joints[k].pose, joints[k].radius);
  }
  if (capsules_)
    for (std::size_t k = 0; k < hand.capsules.size(); ++k)
      hand.capsules[k] = {three(shapes.capsules[k].points[0]), three(shapes.capsules[k].points[1]),
                          shapes.capsules[k].radius};
  if (!assets::usable(hand)) return std::nullopt;
  return hand;
}

std::optional<assets::RecordedMesh> Hands::mesh(Side side) const {
  const Instance& xr = session_.instance();
  if (!xr.has(XR_FB_HAND_TRACKING_MESH_EXTENSION_NAME)) return std::nullopt;
  const auto get = xr.function<PFN_xrGetHandMeshFB>("xrGetHandMeshFB");
  const XrHandTrackerEXT tracker = trackers_[static_cast<std::size_t>(side)];
  auto m = blank<XrHandTrackingMeshFB>(XR_TYPE_HAND_TRACKING_MESH_FB);
  xr.check(get(tracker, &m), "xrGetHandMeshFB");
  MeshArrays arrays;
  arrays.attach(m);
  xr.check(get(tracker, &m), "xrGetHandMeshFB");
  if (arrays.bind.size() != assets::kRecordedJointCount || arrays.indices.size() % 3 != 0)
    throw Error("xrGetHandMeshFB: " + std::to_string(arrays.bind.size()) + " joints and " +
                std::to_string(arrays.indices.size()) + " corners; expected 26 and a multiple of 3");
  assets::RecordedMesh mesh;
  for (std::size_t k = 0; k < mesh.bind.size(); ++k) mesh.bind[k] = joint(arrays.bind[k], arrays.radii[k]);
  for (std::size_t v = 0; v < arrays.positions.size(); ++v) {
    const auto p = three(arrays.positions[v]);
    mesh.positions_m.insert(mesh.positions_m.end(), p.begin(), p.end());
    const XrVector4sFB& j = arrays.joints[v];
    const XrVector4f& w = arrays.weights[v];
    // A joint that is none is one too many, which `welded` refuses.
    const auto index = [](std::int16_t i) { return static_cast<std::uint8_t>(i >= 0 && i < 255 ? i : 255); };
    mesh.joints.push_back({index(j.x), index(j.y), index(j.z), index(j.w)});
    mesh.weights.push_back({w.x, w.y, w.z, w.w});
    // Unused slots may name anything.
    for (std::size_t k = 0; k < 4; ++k)
      if (mesh.weights.back()[k] == 0) mesh.joints.back()[k] = 0;
  }
  for (std::size_t i = 0; i < arrays.indices.size(); i += 3) {
    const auto corner = [&](std::size_t k) {
      return static_cast<std::uint32_t>(static_cast<std::uint16_t>(arrays.indices[i + k]));
    };
    mesh.triangles.push_back({corner(0), corner(1), corner(2)});
  }
  return assets::welded(std::move(mesh), "xrGetHandMeshFB");
}

}  // namespace clothbench::xr
