#pragma once
#include <string>

#include "vulkan/kernel.hpp"

namespace clothbench::pbd_gpu {

/// A kernel's code, as it runs and with byte counters; the latter is null where the build left them out
/// (BUILD_TESTING).
struct Shader {
  std::string name;
  vulkan::SpirV code, counted;
};

/// By name: of its file, with what CMakeLists.txt adds for the variant. Throws Error if there is none.
const Shader& shader(const std::string& name);

}  // namespace clothbench::pbd_gpu
