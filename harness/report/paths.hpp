#pragma once

namespace clothbench {
extern const char* const kResultsRoot;  ///< results/ of the source tree this was built from
extern const char* const kScriptsRoot;
}  // namespace clothbench
