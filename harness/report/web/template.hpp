#pragma once
#include <string>

namespace clothbench {

/// The page without data and what draws its figures, as bundle.mjs made them when this was built.
struct PageTemplate {
  std::string html;          ///< empty if it could not be made
  std::string missing;       ///< then why, as the end of a sentence
  std::string figures = {};  ///< for Node: src/stills.js
};

PageTemplate page_template();

}  // namespace clothbench
