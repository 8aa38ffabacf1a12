// A fake Android around the activity's library: loads it, passes it an ANativeActivity with the few JNI calls it makes,
// and executes a sequence of life-cycle steps.
//   fake_host LIBRARY FILES INTERNAL ARGS STEP...
// STEP: create | resume | pause | destroy | finish (wait until the activity asks to end) |
//       result (wait until it logs a result) | <number> (wait, ms)
#include <android/native_activity.h>
#include <dlfcn.h>
#include <jni.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>

extern "C" std::atomic<int> fake_finishes, fake_results;

namespace {

std::string intent_args;
int object, intent, klass, text;
int get_intent_method, get_extra_method;

template <class T>
T as(int& thing) {
  return reinterpret_cast<T>(&thing);
}

[[noreturn]] void refuse(const char* what) {
  std::fprintf(stderr, "fake host: %s\n", what);
  std::_Exit(9);
}

jobject call(JNIEnv*, jobject who, jmethodID method, va_list words) {
  if (method == as<jmethodID>(get_intent_method) && who == as<jobject>(object)) return as<jobject>(intent);
  if (method != as<jmethodID>(get_extra_method) || who != as<jobject>(intent))
    refuse("a method called on the wrong object");
  const auto* name = reinterpret_cast<const char*>(va_arg(words, jobject));
  if (std::strcmp(name, "args") != 0) refuse("asked for another extra than args");
  return intent_args.empty() ? nullptr : as<jobject>(text);
}

JNINativeInterface functions() {
  JNINativeInterface f{};
  f.GetObjectClass = [](JNIEnv*, jobject) { return as<jclass>(klass); };
  f.GetMethodID = [](JNIEnv*, jclass, const char* name, const char* signature) -> jmethodID {
    if (std::strcmp(name, "getIntent") == 0 && std::strcmp(signature, "()Landroid/content/Intent;") == 0)
      return as<jmethodID>(get_intent_method);
    if (std::strcmp(name, "getStringExtra") == 0 &&
        std::strcmp(signature, "(Ljava/lang/String;)Ljava/lang/String;") == 0)
      return as<jmethodID>(get_extra_method);
    refuse(name);
  };
  f.CallObjectMethodV = call;
  f.NewGlobalRef = [](JNIEnv*, jobject it) { return it; };
  f.NewStringUTF = [](JNIEnv*, const char* s) { return reinterpret_cast<jstring>(const_cast<char*>(s)); };
  f.GetStringUTFChars = [](JNIEnv*, jstring, jboolean*) { return intent_args.c_str(); };
  f.ReleaseStringUTFChars = [](JNIEnv*, jstring, const char*) {};
  return f;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 6) return 2;
  void* library = dlopen(argv[1], RTLD_NOW);
  if (library == nullptr) refuse(dlerror());
  const auto create = reinterpret_cast<ANativeActivity_createFunc*>(dlsym(library, "ANativeActivity_onCreate"));
  if (create == nullptr) refuse("no ANativeActivity_onCreate");
  intent_args = argv[4];
  const JNINativeInterface table = functions();
  JNIEnv env{};
  env.functions = &table;
  ANativeActivityCallbacks callbacks{};
  ANativeActivity activity{};
  activity.callbacks = &callbacks;
  activity.env = &env;
  activity.clazz = as<jobject>(object);
  int machine = 0;
  activity.vm = as<JavaVM*>(machine);
  activity.externalDataPath = argv[2];
  activity.internalDataPath = argv[3];
  activity.sdkVersion = 34;
  for (int k = 5; k < argc; ++k) {
    const std::string step = argv[k];
    if (step == "create") {
      callbacks = {};
      create(&activity, nullptr, 0);
    } else if (step == "resume") {
      callbacks.onResume(&activity);
    } else if (step == "pause") {
      callbacks.onPause(&activity);
    } else if (step == "destroy") {
      callbacks.onDestroy(&activity);
    } else if (step == "finish" || step == "result") {
      while ((step == "finish" ? fake_finishes : fake_results).exchange(0) == 0)
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    } else {
      std::this_thread::sleep_for(std::chrono::milliseconds(std::atoi(step.c_str())));
    }
  }
  return 0;
}
