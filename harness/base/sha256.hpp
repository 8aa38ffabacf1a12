#pragma once
#include <string>

namespace clothbench {

/// SHA-256 of `data` in lower-case hexadecimal (FIPS 180-4).
std::string sha256(const std::string& data);

}  // namespace clothbench
