#pragma once

namespace clothbench {
extern const char* const kPublishedTable3;  ///< results/paper-table3.json
}  // namespace clothbench
