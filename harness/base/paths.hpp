#pragma once

namespace clothbench {
extern const char* const kSourceRoot;       ///< the source tree this was built from
extern const char* const kDataFromProgram;  ///< from the program's folder to the installed share/clothbench
}  // namespace clothbench
