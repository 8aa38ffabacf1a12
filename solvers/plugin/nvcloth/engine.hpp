/// The engine's callbacks and devices. A library contains one device: a CPU core, or with NVCLOTH_CUDA a GPU.
#pragma once

#include <NvCloth/Callbacks.h>
#include <NvCloth/Factory.h>
#include <foundation/PxAllocatorCallback.h>
#include <foundation/PxErrorCallback.h>
#ifdef NVCLOTH_CUDA
#include <cuda.h>
#endif

#include "peer.hpp"

namespace clothbench::nvcloth {

/// The engine's allocator, error callback and assertion handler in one object.
struct Callbacks : physx::PxAllocatorCallback, physx::PxErrorCallback, nv::cloth::PxAssertHandler {
  std::string message;
  void* allocate(std::size_t size, const char*, const char*, int) override {
    return std::aligned_alloc(16, (size + 15) / 16 * 16);
  }
  void deallocate(void* at) override { std::free(at); }
  void reportError(physx::PxErrorCode::Enum, const char* text, const char*, int) override { message = text; }
  void operator()(const char*, const char*, int, bool& ignore) override { ignore = true; }
};

inline Callbacks& engine() {
  static Callbacks all;
  static const bool once = (nv::cloth::InitializeNvCloth(&all, &all, &all, nullptr), true);
  (void)once;
  return all;
}

template <typename Made>
Made* require(Made* made, const char* what) {
  if (made == nullptr) throw std::runtime_error(std::string("NvCloth: ") + what + " failed: " + engine().message);
  return made;
}

#ifndef NVCLOTH_CUDA
constexpr bool kOnGpu = false;
constexpr char kName[] = "nvcloth", kSummary[] = "NvCloth 1.1.6 on one CPU core (SSE2), lengths in cm";

struct Device {
  std::string obstacle;
  nv::cloth::Factory* factory = (engine(), NvClothCreateFactoryCPU());
  double frame_s = 0;  // a GPU has this and the next member
  ClothbenchDevice info{};
  template <typename Work>
  void time(Work work) {
    work();
  }
  bool finish() { return true; }
};
#else
constexpr bool kOnGpu = true;
constexpr char kName[] = "nvcloth-cuda", kSummary[] = "NvCloth 1.1.6 on a GPU (CUDA), lengths in cm";

/// The first CUDA device, in the primary context, which other users of CUDA in the process share.
struct Device {
  Device() {
    CUdevice gpu = 0;
    CUcontext context = nullptr;
    char text[256] = "";
    for (const CUresult result : {cuInit(0), cuDeviceGet(&gpu, 0), cuDeviceGetName(text, sizeof text, gpu),
                                  cuDriverGetVersion(&version), cuDevicePrimaryCtxRetain(&context, gpu),
                                  cuCtxSetCurrent(context), cuEventCreate(&start, 0), cuEventCreate(&end, 0)})
      if (result != CUDA_SUCCESS) {
        const char* why = "the CUDA driver (libcuda.so.1) is not installed";
        cuGetErrorString(result, &why);
        obstacle = std::string("there is no CUDA device: ") + why;
        return;
      }
    name = text;
    api = "CUDA " + std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 10);
    info = {name.c_str(), api.c_str(), api.c_str(), 0, nullptr};
    engine().message.clear();
    factory = NvClothCreateFactoryCUDA(context);
    // A kernel that does not fit the GPU is only reported to the callback.
    if (!engine().message.empty()) obstacle = "NvCloth cannot use " + name + ": " + engine().message;
    primary = context;
  }
  /// Times what `work` gives to the GPU. The engine's stream and the legacy stream wait for each other.
  template <typename Work>
  void time(Work work) {
    cuCtxSetCurrent(primary);
    cuEventRecord(start, nullptr);
    work();
    cuEventRecord(end, nullptr);
  }
  /// Waits for the GPU; false: it failed.
  bool finish() {
    float ms = 0;
    const bool done = cuEventSynchronize(end) == CUDA_SUCCESS && cuEventElapsedTime(&ms, start, end) == CUDA_SUCCESS;
    frame_s = done ? static_cast<double>(ms) / 1000 : std::nan("");
    return done;
  }

  std::string obstacle, name, api;  ///< obstacle: why there is no device, or empty
  nv::cloth::Factory* factory = nullptr;
  double frame_s = std::nan("");  ///< GPU time of the last frame
  ClothbenchDevice info{};
  int version = 0;
  CUcontext primary = nullptr;
  CUevent start = nullptr, end = nullptr;
};
#endif

/// Never freed: the engine allows one CUDA factory per process, and the driver ends before static objects do.
inline Device& device() {
  static Device& only = *new Device;
  return only;
}

}  // namespace clothbench::nvcloth
