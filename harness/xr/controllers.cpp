#include "xr/controllers.hpp"

#include <cstring>

#include "clothbench/vector.hpp"
#include "xr/pose.hpp"

namespace clothbench::xr {
namespace {

constexpr float kPulled = 0.5f;  // half of the trigger's travel

/// The aim pose points along its -z.
Ray ray_of(const XrPosef& p) {
  const Vec3 back = axes_of(p.orientation)[2];
  return {vector_of(p.position), scaled(-1 / length(back), back)};
}

}  // namespace

Controllers::Controllers(const Session& session) : session_(session) {
  const Instance& xr = session.instance();
  hands_ = {xr.path("/user/hand/left"), xr.path("/user/hand/right")};
  auto info = blank<XrActionSetCreateInfo>(XR_TYPE_ACTION_SET_CREATE_INFO);
  std::strcpy(info.actionSetName, "room");
  std::strcpy(info.localizedActionSetName, "Room");
  xr.check(xr.xr().xrCreateActionSet(xr.handle(), &info, &set_), "xrCreateActionSet");
  show_ = action("show_room", "Show the room", XR_ACTION_TYPE_BOOLEAN_INPUT, false);
  pick_ = action("pick_point", "Pick a point", XR_ACTION_TYPE_FLOAT_INPUT, true);
  aim_ = action("aim", "Aim", XR_ACTION_TYPE_POSE_INPUT, true);
  bind();
  auto attach = blank<XrSessionActionSetsAttachInfo>(XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO);
  attach.countActionSets = 1;
  attach.actionSets = &set_;
  xr.check(xr.xr().xrAttachSessionActionSets(session.handle(), &attach), "xrAttachSessionActionSets");
  for (std::size_t hand = 0; hand < 2; ++hand) {
    auto space = blank<XrActionSpaceCreateInfo>(XR_TYPE_ACTION_SPACE_CREATE_INFO);
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
  auto info = blank<XrActionCreateInfo>(XR_TYPE_ACTION_CREATE_INFO);
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
    auto info = blank<XrInteractionProfileSuggestedBinding>(XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING);
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
  auto info = blank<XrActionStateGetInfo>(XR_TYPE_ACTION_STATE_GET_INFO);
  info.action = which;
  auto state = blank<XrActionStateBoolean>(XR_TYPE_ACTION_STATE_BOOLEAN);
  session_.instance().check(session_.instance().xr().xrGetActionStateBoolean(session_.handle(), &info, &state),
                            "xrGetActionStateBoolean");
  return state.isActive == XR_TRUE && state.currentState == XR_TRUE;
}

bool Controllers::is_pulled(std::size_t hand) const {
  auto info = blank<XrActionStateGetInfo>(XR_TYPE_ACTION_STATE_GET_INFO);
  info.action = pick_;
  info.subactionPath = hands_[hand];
  auto state = blank<XrActionStateFloat>(XR_TYPE_ACTION_STATE_FLOAT);
  session_.instance().check(session_.instance().xr().xrGetActionStateFloat(session_.handle(), &info, &state),
                            "xrGetActionStateFloat");
  return state.isActive == XR_TRUE && state.currentState >= kPulled;
}

std::optional<Ray> Controllers::aim(std::size_t hand, XrTime time) const {
  const auto pose = session_.locate(aims_[hand], time);
  return pose ? std::optional(ray_of(*pose)) : std::nullopt;
}

Pressed Controllers::read(XrTime time) {
  const XrActiveActionSet active{set_, XR_NULL_PATH};
  auto sync = blank<XrActionsSyncInfo>(XR_TYPE_ACTIONS_SYNC_INFO);
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
