#pragma once
#include <string>

#include "clothbench/record.hpp"

namespace clothbench {

/// Definition of the byte counts, for the notes of tables.
inline constexpr const char* kWhatBytesAre =
    "loads and stores of the shaders, computed from the scene and the kernels' loops and checked against instrumented "
    "kernels in tests; "
    "≥: a lower bound, where what is read depends on how the cloth lies (contact of xpbd); retries of atomics are left "
    "out.";

/// True if the bytes that the run's stages read are a lower bound.
bool reads_at_least(const RunRecord&);

/// "≥ 12.3" for a lower bound, "12.3" for an exact count; "–" for a missing value.
std::string bytes_read(const RunRecord&, double value, int digits);

/// The summary values `read` and `written`, times `scale`: "≥ 12.3 / 4.50".
std::string bytes_pair(const RunRecord&, const char* read, const char* written, double scale);

}  // namespace clothbench
