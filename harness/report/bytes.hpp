#pragma once
#include <string>

#include "clothbench/record.hpp"

namespace clothbench {

/// What bytes are, for notes.
inline constexpr const char* kWhatBytesAre =
    "loads and stores of the shaders, computed from the scene and the kernels' loops and checked against instrumented "
    "kernels in tests; "
    "≥: a lower bound, where what is read depends on how the cloth lies (contact of xpbd); retries of atomics are left "
    "out.";

/// True if what the run's stages read is a lower bound.
bool reads_at_least(const RunRecord&);

/// "≥ 12.3", or without the sign where the bytes are all that there is; "–" for a missing value.
std::string bytes_read(const RunRecord&, double value, int digits);

/// What is read and written by these names of the summary, times `scale`: "≥ 12.3 / 4.50".
std::string bytes_pair(const RunRecord&, const char* read, const char* written, double scale);

}  // namespace clothbench
