#pragma once

namespace clothbench {
extern const char* const kResultsRoot;  ///< results/ of the source tree this was built from
extern const char* const kScriptsRoot;
extern const char* const kPublishedTable3;  ///< results/paper-table3.json
}  // namespace clothbench
