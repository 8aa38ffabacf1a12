#pragma once

namespace clothbench {
extern const char* const kSourceRoot;       ///< the source tree this was built from
extern const char* const kDataFromProgram;  ///< from the program's folder to share/clothbench of an installed tree
}  // namespace clothbench
