#pragma once
#include <filesystem>
#include <string>

#include "report/web/template.hpp"

namespace clothbench {

/// File that lists the pictures in a folder that a report wrote: {"format", "format_version", "pictures"}.
inline constexpr char kPicturesList[] = "report-pictures.json";

struct Drawn {
  std::string fault;     ///< a sentence on what is missing, and why; empty if all was drawn
  std::string markdown;  ///< shows the new pictures
};

/// Draws the figures of `out`/index.html as SVG (by Node) and as PNG (by rsvg-convert), under the names that the page
/// gives them. Draws into a temporary folder and, only after success, replaces the pictures of an earlier report in
/// `out`. Never overwrites other files: throws Error naming one that has the name of a picture.
Drawn draw_pictures(const std::filesystem::path& out, const PageTemplate&);

}  // namespace clothbench
