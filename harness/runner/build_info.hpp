#pragma once

/// Facts of this build, written by build_info.cmake at every build.
namespace clothbench::build_info {
extern const char* const kCompiler;
extern const char* const kShaderCompiler;
extern const char* const kBuildType;
extern const char* const kVersion;
extern const char* const kGitCommit;
/// SHA-256 of the files that may change a figure (harness/runner/measured_paths.txt); "unknown" without git.
extern const char* const kSourceSha256;
extern const bool kGitDirty;
}  // namespace clothbench::build_info
