#pragma once
#include <string>

namespace clothbench {

/// The page without data, as bundle.mjs made it when this was built.
struct PageTemplate {
  std::string html;     ///< empty if it could not be made
  std::string missing;  ///< then why, as the end of a sentence
};

PageTemplate page_template();

}  // namespace clothbench
