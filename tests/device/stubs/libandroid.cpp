// Stub of Android's libandroid: assets from $FAKE_ASSETS, and a record of the requests.
#include <android/asset_manager.h>
#include <android/input.h>
#include <android/looper.h>
#include <android/native_activity.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <string>

extern "C" {
std::atomic<int> fake_finishes{0};

void ANativeActivity_finish(ANativeActivity*) { ++fake_finishes; }
void ANativeActivity_setWindowFlags(ANativeActivity*, uint32_t, uint32_t) {}

AAsset* AAssetManager_open(AAssetManager*, const char* name, int) {
  const char* folder = std::getenv("FAKE_ASSETS");
  return reinterpret_cast<AAsset*>(std::fopen((std::string(folder) + "/" + name).c_str(), "rb"));
}
off64_t AAsset_getLength64(AAsset* asset) {
  auto* file = reinterpret_cast<FILE*>(asset);
  std::fseek(file, 0, SEEK_END);
  const long length = std::ftell(file);
  std::rewind(file);
  return length;
}
// Returns small pieces, as for a compressed asset.
int AAsset_read(AAsset* asset, void* to, size_t count) {
  return static_cast<int>(std::fread(to, 1, count < 1000 ? count : 1000, reinterpret_cast<FILE*>(asset)));
}
void AAsset_close(AAsset* asset) { std::fclose(reinterpret_cast<FILE*>(asset)); }

int32_t AInputQueue_getEvent(AInputQueue*, AInputEvent**) { return -1; }
int32_t AInputQueue_preDispatchEvent(AInputQueue*, AInputEvent*) { return 0; }
void AInputQueue_finishEvent(AInputQueue*, AInputEvent*, int) {}
void AInputQueue_attachLooper(AInputQueue*, ALooper*, int, ALooper_callbackFunc, void*) {}
void AInputQueue_detachLooper(AInputQueue*) {}
ALooper* ALooper_forThread() { return nullptr; }
}
