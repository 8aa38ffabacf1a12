#pragma once

namespace clothbench {

// Text of scenarios/schema/*.schema.json, compiled in.
extern const char* const kSceneSchema;
extern const char* const kStudySchema;

}  // namespace clothbench
