/// The engine's callbacks and devices. A library contains one device: a CPU core, or with NVCLOTH_CUDA a GPU.
#pragma once

#include <NvCloth/Callbacks.h>
#include <NvCloth/Factory.h>
#include <NvCloth/Solver.h>
#include <foundation/PxAllocatorCallback.h>
#include <foundation/PxErrorCallback.h>
#ifdef NVCLOTH_CUDA
#include <cuda.h>
#endif

#include "peer.hpp"

namespace clothbench::nvcloth {

/// The engine's allocator, error callback and assertion handler in one object.
struct Callbacks : physx::PxAllocatorCallback, physx::PxErrorCallback, nv::cloth::PxAssertHandler {
  Callbacks() { nv::cloth::InitializeNvCloth(this, this, this, nullptr); }
  std::string message;
  void* allocate(std::size_t size, const char*, const char*, int) override {
    return std::aligned_alloc(16, (size + 15) / 16 * 16);
  }
  void deallocate(void* at) override { std::free(at); }
  void reportError(physx::PxErrorCode::Enum, const char* text, const char*, int) override { message = text; }
  void operator()(const char*, const char*, int, bool& ignore) override { ignore = true; }
};

inline Callbacks& engine() {
  static Callbacks only;
  return only;
}

template <typename Made>
Made* require(Made* made, const char* what) {
  if (made == nullptr) throw std::runtime_error(std::string("NvCloth: ") + what + " failed: " + engine().message);
  return made;
}

/// A CPU core, or the first CUDA device, in the primary context, which other users of CUDA in the process share.
struct Device {
  std::string obstacle, name, api;  ///< obstacle: why there is no device, or empty
  nv::cloth::Factory* factory = nullptr;
  double frame_s = std::nan("");  ///< GPU time of the last frame
#ifndef NVCLOTH_CUDA
  static constexpr bool kOnGpu = false;
  Device() : factory((engine(), NvClothCreateFactoryCPU())) {}
  void start() {}
  void stop() {}
  bool finish() { return true; }
#else
  static constexpr bool kOnGpu = true;
  CUcontext context = nullptr;
  CUevent begin = nullptr, end = nullptr;
  Device() {
    CUdevice gpu = 0;
    char text[256] = "";
    int version = 0;
    for (const CUresult result : {cuInit(0), cuDeviceGet(&gpu, 0), cuDeviceGetName(text, sizeof text, gpu),
                                  cuDriverGetVersion(&version), cuDevicePrimaryCtxRetain(&context, gpu),
                                  cuCtxSetCurrent(context), cuEventCreate(&begin, 0), cuEventCreate(&end, 0)})
      if (result != CUDA_SUCCESS) {
        const char* why = "unknown error";
        cuGetErrorString(result, &why);
        obstacle = std::string("there is no CUDA device: ") + why;
        return;
      }
    name = text;
    api = "CUDA " + std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 10);
    engine().message.clear();
    factory = NvClothCreateFactoryCUDA(context);
    // A kernel that does not fit the GPU is only reported to the callback.
    if (!engine().message.empty()) obstacle = "NvCloth cannot use " + name + ": " + engine().message;
  }
  /// Times the work that the GPU gets before stop(). The engine's stream and the legacy stream wait for each other.
  void start() {
    cuCtxSetCurrent(context);
    cuEventRecord(begin, nullptr);
  }
  void stop() { cuEventRecord(end, nullptr); }
  /// Waits for the GPU; false: it failed.
  bool finish() {
    float ms = 0;
    const bool done = cuEventSynchronize(end) == CUDA_SUCCESS && cuEventElapsedTime(&ms, begin, end) == CUDA_SUCCESS;
    frame_s = done ? static_cast<double>(ms) / 1000 : std::nan("");
    return done;
  }
#endif
};

/// Never freed: the engine allows one CUDA factory per process, and the driver ends before static objects do.
inline Device& device() {
  static Device& only = *new Device;
  return only;
}

}  // namespace clothbench::nvcloth
