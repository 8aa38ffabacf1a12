#pragma once
#include <string>

namespace clothbench {

/// A text in a kernel's source, and its replacement.
struct ShaderFault {
  std::string file;          ///< below solvers/pbd-gpu
  std::string is, is_to_be;  ///< text that occurs exactly once, and its replacement
};

/// While it exists, every kernel is compiled from sources with this fault before it is passed to the driver, with the
/// build's own compiler command. Throws std::runtime_error if the text does not occur exactly once.
class ShaderVariant {
 public:
  explicit ShaderVariant(const ShaderFault&);
  ~ShaderVariant();
  ShaderVariant(const ShaderVariant&) = delete;
  ShaderVariant& operator=(const ShaderVariant&) = delete;

  /// Number of kernels that reached the driver in changed form. 0: the run did not have the fault.
  static int exchanged();
};

}  // namespace clothbench
