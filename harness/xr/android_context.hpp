#pragma once

namespace clothbench::xr {

/// What Android's runtimes ask for: the Java machine and the activity (a global reference). Null elsewhere.
struct AndroidContext {
  void* vm = nullptr;
  void* activity = nullptr;
};
/// Of the process; set by whoever has an activity, before a session begins.
void set_android_context(const AndroidContext&);
const AndroidContext& android_context();

}  // namespace clothbench::xr
