#pragma once
#include <string>

#include "vulkan/kernel.hpp"

namespace clothbench::pbd_gpu {

/// A kernel's code: as it runs, and with byte counters. The latter is null in builds without BUILD_TESTING.
struct Shader {
  std::string name;
  vulkan::SpirV code, counted;
};

/// Finds a kernel by name: its file's, plus the variant's suffix from CMakeLists.txt. Throws Error if there is none.
const Shader& shader(const std::string& name);

}  // namespace clothbench::pbd_gpu
