// The CUDA driver, found at run time: on a machine without it, the plugin loads and scenes are `unsupported`.
#include <cuda.h>
#include <dlfcn.h>

namespace {

/// The driver's function of this name, or one that fails.
template <typename... A>
auto driver(CUresult (*)(A...), const char* name) {
  static void* const library = dlopen("libcuda.so.1", RTLD_NOW | RTLD_LOCAL);
  using Function = CUresult (*)(A...);
  const auto found = library != nullptr ? reinterpret_cast<Function>(dlsym(library, name)) : nullptr;
  return found != nullptr ? found : Function([](A...) { return CUDA_ERROR_NOT_FOUND; });
}

}  // namespace

// cuda.h replaces some names by newer ones, such as cuMemAlloc_v2; a second macro converts the replaced name to a text.
#define TEXT(name) #name
#define DRIVER(name, parameters, arguments)              \
  CUresult name parameters {                             \
    static const auto found = driver(&name, TEXT(name)); \
    return found arguments;                              \
  }

DRIVER(cuCtxGetDevice, (CUdevice * a), (a))
DRIVER(cuCtxPopCurrent, (CUcontext * a), (a))
DRIVER(cuCtxPushCurrent, (CUcontext a), (a))
DRIVER(cuCtxSetCurrent, (CUcontext a), (a))
DRIVER(cuDeviceGet, (CUdevice * a, int b), (a, b))
DRIVER(cuDeviceGetAttribute, (int* a, CUdevice_attribute b, CUdevice c), (a, b, c))
DRIVER(cuDeviceGetName, (char* a, int b, CUdevice c), (a, b, c))
DRIVER(cuDevicePrimaryCtxRetain, (CUcontext * a, CUdevice b), (a, b))
DRIVER(cuDriverGetVersion, (int* a), (a))
DRIVER(cuEventCreate, (CUevent * a, unsigned b), (a, b))
DRIVER(cuEventElapsedTime, (float* a, CUevent b, CUevent c), (a, b, c))
DRIVER(cuEventRecord, (CUevent a, CUstream b), (a, b))
DRIVER(cuEventSynchronize, (CUevent a), (a))
DRIVER(cuFuncGetAttribute, (int* a, CUfunction_attribute b, CUfunction c), (a, b, c))
DRIVER(cuGetErrorString, (CUresult a, const char** b), (a, b))
DRIVER(cuInit, (unsigned a), (a))
DRIVER(cuLaunchKernel,
       (CUfunction a, unsigned b, unsigned c, unsigned d, unsigned e, unsigned f, unsigned g, unsigned h, CUstream i,
        void** j, void** k),
       (a, b, c, d, e, f, g, h, i, j, k))
DRIVER(cuMemAlloc, (CUdeviceptr * a, size_t b), (a, b))
DRIVER(cuMemFree, (CUdeviceptr a), (a))
DRIVER(cuMemFreeHost, (void* a), (a))
DRIVER(cuMemHostAlloc, (void** a, size_t b, unsigned c), (a, b, c))
DRIVER(cuMemHostGetDevicePointer, (CUdeviceptr * a, void* b, unsigned c), (a, b, c))
DRIVER(cuMemcpyDtoD, (CUdeviceptr a, CUdeviceptr b, size_t c), (a, b, c))
DRIVER(cuMemcpyDtoH, (void* a, CUdeviceptr b, size_t c), (a, b, c))
DRIVER(cuMemcpyHtoD, (CUdeviceptr a, const void* b, size_t c), (a, b, c))
DRIVER(cuMemcpyHtoDAsync, (CUdeviceptr a, const void* b, size_t c, CUstream d), (a, b, c, d))
DRIVER(cuMemsetD32, (CUdeviceptr a, unsigned b, size_t c), (a, b, c))
DRIVER(cuModuleGetFunction, (CUfunction * a, CUmodule b, const char* c), (a, b, c))
DRIVER(cuModuleLoadFatBinary, (CUmodule * a, const void* b), (a, b))
DRIVER(cuStreamAddCallback, (CUstream a, CUstreamCallback b, void* c, unsigned d), (a, b, c, d))
DRIVER(cuStreamCreate, (CUstream * a, unsigned b), (a, b))
DRIVER(cuStreamDestroy, (CUstream a), (a))
DRIVER(cuStreamSynchronize, (CUstream a), (a))
