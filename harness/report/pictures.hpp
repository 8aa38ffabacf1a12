#pragma once
#include <filesystem>
#include <string>

#include "report/web/template.hpp"

namespace clothbench {

/// Names the pictures in a report's folder that a report wrote: {"format", "format_version", "pictures"}.
inline constexpr char kPicturesList[] = "report-pictures.json";

struct Drawn {
  std::string fault;     ///< a sentence on what there is not, and why; empty if all was drawn
  std::string markdown;  ///< shows the new pictures
};

/// The figures of `out`/index.html as SVG, by Node, and as PNG, by rsvg-convert, under the names that the page's
/// figures give them. Draws apart and, only if all went well, puts the pictures into `out` in place of those of an
/// earlier report. Other files stay as they are: throws Error naming one that is in the way.
Drawn draw_pictures(const std::filesystem::path& out, const PageTemplate&);

}  // namespace clothbench
