#pragma once
#include <array>
#include <optional>

#include "clothbench/collider.hpp"
#include "xr/session.hpp"

namespace clothbench::xr {

struct Ray {
  Vec3 from_m{}, along{};  ///< `along` is unit
};

/// Controller input: A (X on the left, menu on a simple controller) shows the room, the trigger picks a point.
struct Pressed {
  bool show = false;        ///< A was pressed since the last read
  std::optional<Ray> pick;  ///< ray of the controller whose trigger was pulled since the last read
};

/// The OpenXR actions of the app. A session has one action set.
class Controllers {
 public:
  explicit Controllers(const Session&);
  ~Controllers();
  Controllers(const Controllers&) = delete;
  Controllers& operator=(const Controllers&) = delete;
  Pressed read(XrTime);

 private:
  XrAction action(const char* name, const char* title, XrActionType, bool by_hand) const;
  void bind() const;
  bool is_pressed(XrAction) const;
  bool is_pulled(std::size_t hand) const;
  std::optional<Ray> aim(std::size_t hand, XrTime) const;

  const Session& session_;
  XrActionSet set_ = XR_NULL_HANDLE;
  XrAction show_ = XR_NULL_HANDLE, pick_ = XR_NULL_HANDLE, aim_ = XR_NULL_HANDLE;
  std::array<XrPath, 2> hands_{};
  std::array<XrSpace, 2> aims_{};
  bool showed_ = false;
  std::array<bool, 2> pulled_{};
};

}  // namespace clothbench::xr
