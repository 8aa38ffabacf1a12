#pragma once

/// The files of texts/ and GLOSSARY.md, which are compiled into the program.
namespace clothbench::texts {
extern const char *const kBash, *const kZsh, *const kFish;  ///< scripts of `clothbench completion`
extern const char* const kGlossary;                         ///< Markdown table: term, meaning
}  // namespace clothbench::texts
