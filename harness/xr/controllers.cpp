#include "xr/controllers.hpp"

#include <cmath>
#include <cstring>

namespace clothbench::xr {
namespace {

constexpr float kPulled = 0.5f;  // half of the trigger's travel

Ray ray_of(const XrPosef& p) {
  const XrQuaternionf& q = p.orientation;
  const double x = static_cast<double>(q.x), y = static_cast<double>(q.y), z = static_cast<double>(q.z),
               w = static_cast<double>(q.w);
  // The aim pose points along its -z: minus the third column of its rotation.
  Vec3 along = {-2 * (x * z + w * y), -2 * (y * z - w * x), -(1 - 2 * (x * x + y * y))};
  const double length = std::sqrt(along[0] * along[0] + along[1] * along[1] + along[2] * along[2]);
  for (double& c : along) c /= length;
  return {{static_cast<double>(p.position.x), static_cast<double>(p.position.y), static_cast<double>(p.position.z)},
          along};
}

}  // namespace

Controllers::Controllers(const Session& session) : session_(session) {
  const Instance& xr = session.instance();
  hands_ = {xr.path("/user/hand/left"), xr.path("/user/hand/right")};
  XrActionSetCreateInfo info{};
  info.type = XR_TYPE_ACTION_SET_CREATE_INFO;
  std::strcpy(info.actionSetName, "room");
  std::strcpy(info.localizedActionSetName, "Room");
  xr.check(xr.xr().xrCreateActionSet(xr.handle(), &info, &set_), "xrCreateActionSet");
  show_ = action("show_room", "Show the room", XR_ACTION_TYPE_BOOLEAN_INPUT, false);
  pick_ = action("pick_point", "Pick a point", XR_ACTION_TYPE_FLOAT_INPUT, true);
  aim_ = action("aim", "Aim", XR_ACTION_TYPE_POSE_INPUT, true);
  bind();
  XrSessionActionSetsAttachInfo attach{};
  attach.type = XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO;
  attach.countActionSets = 1;
  attach.actionSets = &set_;
  xr.check(xr.xr().xrAttachSessionActionSets(session.handle(), &attach), "xrAttachSessionActionSets");
  for (std::size_t hand = 0; hand < 2; ++hand) {
    XrActionSpaceCreateInfo space{};
    space.type = XR_TYPE_ACTION_SPACE_CREATE_INFO;
    space.action = aim_;
    space.subactionPath = hands_[hand];
    space.poseInActionSpace.orientation.w = 1;
    xr.check(xr.xr().xrCreateActionSpace(session.handle(), &space, &aims_[hand]), "xrCreateActionSpace");
  }
}

Controllers::~Controllers() {
  for (const XrSpace s : aims_)
    if (s != XR_NULL_HANDLE) session_.instance().xr().xrDestroySpace(s);
  session_.instance().xr().xrDestroyActionSet(set_);
}

XrAction Controllers::action(const char* name, const char* title, XrActionType type, bool by_hand) const {
  XrActionCreateInfo info{};
  info.type = XR_TYPE_ACTION_CREATE_INFO;
  info.actionType = type;
  std::strcpy(info.actionName, name);
  std::strcpy(info.localizedActionName, title);
  info.countSubactionPaths = by_hand ? 2 : 0;
  info.subactionPaths = by_hand ? hands_.data() : nullptr;
  XrAction made = XR_NULL_HANDLE;
  session_.instance().check(session_.instance().xr().xrCreateAction(set_, &info, &made), "xrCreateAction");
  return made;
}

void Controllers::bind() const {
  const Instance& xr = session_.instance();
  const auto suggest = [&](const char* profile, std::vector<std::pair<XrAction, const char*>> bindings) {
    std::vector<XrActionSuggestedBinding> all;
    for (const auto& [to, source] : bindings) all.push_back({to, xr.path(source)});
    XrInteractionProfileSuggestedBinding info{};
    info.type = XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING;
    info.interactionProfile = xr.path(profile);
    info.countSuggestedBindings = static_cast<std::uint32_t>(all.size());
    info.suggestedBindings = all.data();
    xr.check(xr.xr().xrSuggestInteractionProfileBindings(xr.handle(), &info), "xrSuggestInteractionProfileBindings");
  };
  suggest("/interaction_profiles/oculus/touch_controller", {{show_, "/user/hand/right/input/a/click"},
                                                            {show_, "/user/hand/left/input/x/click"},
                                                            {pick_, "/user/hand/left/input/trigger/value"},
                                                            {pick_, "/user/hand/right/input/trigger/value"},
                                                            {aim_, "/user/hand/left/input/aim/pose"},
                                                            {aim_, "/user/hand/right/input/aim/pose"}});
  suggest("/interaction_profiles/khr/simple_controller", {{show_, "/user/hand/left/input/menu/click"},
                                                          {show_, "/user/hand/right/input/menu/click"},
                                                          {pick_, "/user/hand/left/input/select/click"},
                                                          {pick_, "/user/hand/right/input/select/click"},
                                                          {aim_, "/user/hand/left/input/aim/pose"},
                                                          {aim_, "/user/hand/right/input/aim/pose"}});
}

bool Controllers::is_pressed(XrAction which) const {
  XrActionStateGetInfo info{};
  info.type = XR_TYPE_ACTION_STATE_GET_INFO;
  info.action = which;
  XrActionStateBoolean state{};
  state.type = XR_TYPE_ACTION_STATE_BOOLEAN;
  session_.instance().check(session_.instance().xr().xrGetActionStateBoolean(session_.handle(), &info, &state),
                            "xrGetActionStateBoolean");
  return state.isActive == XR_TRUE && state.currentState == XR_TRUE;
}

bool Controllers::is_pulled(std::size_t hand) const {
  XrActionStateGetInfo info{};
  info.type = XR_TYPE_ACTION_STATE_GET_INFO;
  info.action = pick_;
  info.subactionPath = hands_[hand];
  XrActionStateFloat state{};
  state.type = XR_TYPE_ACTION_STATE_FLOAT;
  session_.instance().check(session_.instance().xr().xrGetActionStateFloat(session_.handle(), &info, &state),
                            "xrGetActionStateFloat");
  return state.isActive == XR_TRUE && state.currentState >= kPulled;
}

std::optional<Ray> Controllers::aim(std::size_t hand, XrTime time) const {
  XrSpaceLocation where{};
  where.type = XR_TYPE_SPACE_LOCATION;
  session_.instance().check(session_.instance().xr().xrLocateSpace(aims_[hand], session_.space(), time, &where),
                            "xrLocateSpace");
  constexpr XrSpaceLocationFlags kKnown =
      XR_SPACE_LOCATION_POSITION_VALID_BIT | XR_SPACE_LOCATION_ORIENTATION_VALID_BIT;
  if ((where.locationFlags & kKnown) != kKnown) return std::nullopt;
  return ray_of(where.pose);
}

Pressed Controllers::read(XrTime time) {
  const XrActiveActionSet active{set_, XR_NULL_PATH};
  XrActionsSyncInfo sync{};
  sync.type = XR_TYPE_ACTIONS_SYNC_INFO;
  sync.countActiveActionSets = 1;
  sync.activeActionSets = &active;
  session_.instance().check(session_.instance().xr().xrSyncActions(session_.handle(), &sync), "xrSyncActions");
  Pressed out;
  const bool showing = is_pressed(show_);
  out.show = showing && !showed_;
  showed_ = showing;
  for (std::size_t hand = 0; hand < 2; ++hand) {
    const bool pulling = is_pulled(hand);
    if (pulling && !pulled_[hand]) out.pick = aim(hand, time);
    pulled_[hand] = pulling;
  }
  return out;
}

}  // namespace clothbench::xr
