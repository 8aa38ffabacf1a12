#pragma once

namespace clothbench {
extern const char* const kScenarioRoot;  ///< scenarios/ of the source tree this was built from
}
