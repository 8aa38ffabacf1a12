#pragma once
#include <string>

namespace clothbench {

/// The page without data and the script that draws its figures, as bundle.mjs made them at build time.
struct PageTemplate {
  std::string html;          ///< empty if it could not be built
  std::string missing;       ///< then the reason, as the end of a sentence
  std::string figures = {};  ///< script for Node, from src/stills.js
};

PageTemplate page_template();

}  // namespace clothbench
