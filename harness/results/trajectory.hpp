#pragma once
#include <filesystem>
#include <string>

#include "clothbench/record.hpp"

namespace clothbench {

/// SHA-256 of a motion in lower-case hexadecimal: the times (float64), then the positions (float32), little-endian.
/// Files store it with the outcome, so that a verdict belongs to one motion. Empty without frames.
std::string trajectory_sha256(const AccuracyPass&);

/// What is wrong with the motion in a result file (.h5) or part folder, whatever its summary says: positions that are
/// missing, not finite, not one set for each time, or another motion than the one that the file's outcome is of. Empty
/// if nothing is. A run that did not end well may lack frames and have values that are not finite. Throws Error naming
/// the file if it cannot be read.
std::string trajectory_fault(const std::filesystem::path&);

}  // namespace clothbench
