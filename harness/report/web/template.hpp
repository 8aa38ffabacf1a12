#pragma once
#include <string>

namespace clothbench {

/// The page without data, as bundle.mjs made it when this was built; empty if it could not.
std::string page_template();
/// Why it is empty, as the end of a sentence.
std::string page_template_missing();

}  // namespace clothbench
