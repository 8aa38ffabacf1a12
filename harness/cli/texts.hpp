#pragma once

/// The files of texts/, which travel inside the program.
namespace clothbench::texts {
extern const char *const kBash, *const kZsh, *const kFish;  ///< scripts of `clothbench completion`
extern const char* const kManual;                           ///< exit status and environment, for man(1)
}  // namespace clothbench::texts
