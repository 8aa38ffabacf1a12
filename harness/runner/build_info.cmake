# Run at every build: cmake -D SOURCE_DIR= -D OUTPUT= -D COMPILER= -D BUILD_TYPE= -D VERSION= -D GLSLC= -P build_info.cmake
# The file is rewritten only when its content changes, so a commit costs one small compilation.
execute_process(COMMAND git rev-parse HEAD WORKING_DIRECTORY ${SOURCE_DIR}
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
execute_process(COMMAND git status --porcelain --untracked-files=no WORKING_DIRECTORY ${SOURCE_DIR}
  OUTPUT_VARIABLE changes OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
# One hash of all files that can change a result: results of two commits are comparable if their hashes are equal.
file(STRINGS ${SOURCE_DIR}/harness/runner/measured_paths.txt measured REGEX "^[^#]")
execute_process(COMMAND git ls-tree -r HEAD -- ${measured} WORKING_DIRECTORY ${SOURCE_DIR}
  OUTPUT_VARIABLE listing ERROR_QUIET)
string(REGEX REPLACE "[^\n]*\\.md\n" "" listing "${listing}")
set(sources unknown)
if(listing)
  string(SHA256 sources "${listing}")
endif()
set(glslc "")
if(GLSLC)
  # The version has three lines, for shaderc, SPIRV-Tools and glslang, because each of them affects the generated code.
  execute_process(COMMAND ${GLSLC} --version OUTPUT_VARIABLE glslc ERROR_QUIET)
  string(REGEX REPLACE "\n\n.*" "" glslc "${glslc}")
  string(STRIP "${glslc}" glslc)
  string(REPLACE "\n" ", " glslc "${glslc}")
endif()
if(NOT commit)
  set(commit "unknown")
endif()
if(NOT glslc)
  set(glslc "none")
endif()
set(dirty false)
if(changes)
  set(dirty true)
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
#include "runner/environment.hpp"

namespace clothbench::build_info {
const char* const kCompiler = "@COMPILER@";
const char* const kShaderCompiler = "@glslc@";
const char* const kBuildType = "@BUILD_TYPE@";
const char* const kVersion = "@VERSION@";
const char* const kGitCommit = "@commit@";
const char* const kSourceSha256 = "@sources@";
const bool kGitDirty = @dirty@;
}  // namespace clothbench::build_info
]])
