#pragma once

namespace clothbench::xr {

/// Handles that OpenXR runtimes on Android require: Java VM and activity (a global reference). Null elsewhere.
struct AndroidContext {
  void* vm = nullptr;
  void* activity = nullptr;
};
/// Context of the process; the owner of the activity sets it before a session begins.
void set_android_context(const AndroidContext&);
const AndroidContext& android_context();

}  // namespace clothbench::xr
