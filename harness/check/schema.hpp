#pragma once

namespace clothbench {

/// results/baselines/baseline.schema.json, compiled in.
extern const char* const kBaselineSchema;

}  // namespace clothbench
