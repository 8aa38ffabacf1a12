#pragma once
#include <string>

#include "clothbench/record.hpp"

namespace clothbench {

/// Definition of the byte counts, for the notes of tables.
inline constexpr const char* kWhatBytesAre =
    "loads and stores of the shaders, computed from the scene and the kernels' loops; tests compare them "
    "with instrumented kernels. ≥: a lower bound, where the bytes read depend on the shape of the cloth, "
    "as in contact. Retries of atomics are not counted.";

/// True if the bytes that the run's stages read are a lower bound.
bool reads_at_least(const RunRecord&);

/// "≥ 12.3" for a lower bound, "12.3" for an exact count; "–" for a missing value.
std::string bytes_read(const RunRecord&, double value, int digits);

/// The summary values `read` and `written`, times `scale`: "≥ 12.3 / 4.50".
std::string bytes_pair(const RunRecord&, const char* read, const char* written, double scale);

}  // namespace clothbench
