#pragma once
#include <string>

namespace clothbench {

/// One place of a kernel's source that is exchanged.
struct ShaderFault {
  std::string file;          ///< below solvers/pbd-gpu
  std::string is, is_to_be;  ///< text that stands there exactly once
};

/// While it lives every kernel is compiled from sources with this fault before it goes to the driver, with the very
/// command that the build compiles it with. Throws std::runtime_error if the text is not there exactly once.
class ShaderVariant {
 public:
  explicit ShaderVariant(const ShaderFault&);
  ~ShaderVariant();
  ShaderVariant(const ShaderVariant&) = delete;
  ShaderVariant& operator=(const ShaderVariant&) = delete;

  /// How many kernels came to the driver otherwise than they were built: none means that the fault was not in the run.
  static int exchanged();
};

}  // namespace clothbench
