// The activity that Android calls: ANativeActivity callbacks around a Session. Code that can be tested without Android
// is in session.cpp.
#include <android/asset_manager.h>
#include <android/input.h>
#include <android/log.h>
#include <android/looper.h>
#include <android/native_activity.h>
#include <android/window.h>
#include <jni.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <thread>

#include "android/session.hpp"
#include "base/child_process.hpp"
#include "cli/command_line.hpp"
#include "clothbench/error.hpp"
#ifdef CLOTHBENCH_WITH_XR
#include "xr/instance.hpp"
#endif

namespace clothbench::android {
namespace {

constexpr const char* kTag = "clothbench";

void to_log(const std::string& line) { __android_log_write(ANDROID_LOG_INFO, kTag, line.c_str()); }

/// Sends the process's stdout and stderr to the log, line by line until the process ends, because Android discards
/// them.
void send_output_to_log() {
  static const bool once = [] {
    int ends[2];
    if (pipe(ends) != 0 || dup2(ends[1], STDOUT_FILENO) < 0 || dup2(ends[1], STDERR_FILENO) < 0)
      throw Error("stdout cannot be sent to the log", ExitCode::CheckFailed);
    close(ends[1]);
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    std::thread([from = fdopen(ends[0], "r")] {
      std::string line;
      for (int c = std::fgetc(from); c != EOF; c = std::fgetc(from)) {
        if (c != '\n') line += static_cast<char>(c);
        if (c != '\n' || line.empty()) continue;
        to_log(line);
        line.clear();
      }
    }).detach();
    return true;
  }();
  (void)once;
}

/// Prints to stdout, so that the line comes after everything printed before.
void print_line(const std::string& line) { std::printf("%s\n", line.c_str()); }

Session& session_of(ANativeActivity* a) { return *static_cast<Session*>(a->instance); }

/// getIntent().getStringExtra(name); empty if there is none.
std::string intent_extra(ANativeActivity* a, const char* name) {
  JNIEnv* env = a->env;
  const jmethodID get_intent =
      env->GetMethodID(env->GetObjectClass(a->clazz), "getIntent", "()Landroid/content/Intent;");
  jobject intent = env->CallObjectMethod(a->clazz, get_intent);
  if (intent == nullptr) return "";
  const jmethodID get_extra =
      env->GetMethodID(env->GetObjectClass(intent), "getStringExtra", "(Ljava/lang/String;)Ljava/lang/String;");
  const auto value = static_cast<jstring>(env->CallObjectMethod(intent, get_extra, env->NewStringUTF(name)));
  if (value == nullptr) return "";
  const char* text = env->GetStringUTFChars(value, nullptr);
  std::string result = text != nullptr ? text : "";
  env->ReleaseStringUTFChars(value, text);
  return result;
}

std::optional<std::string> read_asset(AAssetManager* manager, const std::string& path) {
  AAsset* asset = AAssetManager_open(manager, path.c_str(), AASSET_MODE_STREAMING);
  if (asset == nullptr) return std::nullopt;
  std::string content(static_cast<std::size_t>(AAsset_getLength64(asset)), '\0');
  std::size_t at = 0;
  while (at < content.size()) {
    const int n = AAsset_read(asset, content.data() + at, content.size() - at);
    if (n <= 0) break;
    at += static_cast<std::size_t>(n);
  }
  AAsset_close(asset);
  content.resize(at);
  return content;
}

/// Unpacks scenes and assets to plain files; results and relative paths go to the files folder.
void prepare(ANativeActivity* a, const std::string& files) {
  const std::filesystem::path packed = std::filesystem::path(a->internalDataPath) / "packed";
  unpack_assets([a](const std::string& path) { return read_asset(a->assetManager, path); }, packed);
  // An app is a library in a process of the system, so there is no executable for workers.
  run_solvers_in_process();
  setenv("CLOTHBENCH_SCENARIOS", (packed / "scenarios").c_str(), 1);
  if (std::filesystem::exists(packed / "assets")) setenv("CLOTHBENCH_ASSETS", (packed / "assets").c_str(), 1);
  std::filesystem::create_directories(files);
  if (chdir(files.c_str()) != 0) to_log("cannot change to " + files);
}

/// Empties the input queue; otherwise the system reports the activity as hung.
int drain_input(int, int, void* queue) {
  AInputEvent* event = nullptr;
  while (AInputQueue_getEvent(static_cast<AInputQueue*>(queue), &event) >= 0) {
    if (AInputQueue_preDispatchEvent(static_cast<AInputQueue*>(queue), event) == 0)
      AInputQueue_finishEvent(static_cast<AInputQueue*>(queue), event, 0);
  }
  return 1;
}

/// Runs a command line. In a live session the runtime uses the activity, which the session's thread may outlive
/// briefly.
std::function<int(const std::vector<std::string>&)> command_of([[maybe_unused]] ANativeActivity* a) {
#ifdef CLOTHBENCH_WITH_XR
  const xr::AndroidContext context{a->vm, a->env->NewGlobalRef(a->clazz)};
  return [context](const std::vector<std::string>& words) {
    xr::set_android_context(context);
    return run_command_line(words);
  };
#else
  return run_command_line;
#endif
}

void set_callbacks(ANativeActivityCallbacks& c) {
  c.onPause = [](ANativeActivity* a) { session_of(a).pause(); };
  c.onResume = [](ANativeActivity* a) { session_of(a).resume(); };
  c.onDestroy = [](ANativeActivity* a) {
    delete &session_of(a);
    a->instance = nullptr;
  };
  c.onInputQueueCreated = [](ANativeActivity*, AInputQueue* queue) {
    AInputQueue_attachLooper(queue, ALooper_forThread(), ALOOPER_POLL_CALLBACK, drain_input, queue);
  };
  c.onInputQueueDestroyed = [](ANativeActivity*, AInputQueue* queue) { AInputQueue_detachLooper(queue); };
}

}  // namespace
}  // namespace clothbench::android

extern "C" __attribute__((visibility("default"))) void ANativeActivity_onCreate(ANativeActivity* activity, void*,
                                                                                size_t) {
  using namespace clothbench::android;
  const char* external = activity->externalDataPath;
  Activity a;
  a.arguments = intent_extra(activity, "args");
  a.log = print_line;
  a.finish = [activity] { ANativeActivity_finish(activity); };
  a.command = command_of(activity);
  try {
    send_output_to_log();
    prepare(activity, external != nullptr && *external != '\0' ? external : activity->internalDataPath);
  } catch (const std::exception& e) {
    to_log(std::string("error: ") + e.what());
    a.command = [](const std::vector<std::string>&) { return 1; };
  }
  ANativeActivity_setWindowFlags(activity, AWINDOW_FLAG_KEEP_SCREEN_ON, 0);
  activity->instance = new Session(a);
  set_callbacks(*activity->callbacks);
}
