#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace clothbench {

/// A script of scripts/ that writes pictures beside the first of its files.
struct Drawing {
  const char* script;
  std::filesystem::path from;       ///< in the report's folder
  std::filesystem::path also = {};  ///< a second argument, if any
  bool published = false;           ///< the second argument is the published table
};

/// Names the pictures in a report's folder that a report wrote: {"format", "format_version", "pictures"}.
inline constexpr char kPicturesList[] = "report-pictures.json";

struct Drawn {
  std::string fault;       ///< why there are no new pictures; empty if there are
  bool has_python = true;  ///< false: for want of a Python with matplotlib
};

/// Draws apart and, only if all went well, puts the pictures into `out` in place of those of an earlier report. Other
/// files stay as they are: throws Error naming one that is in the way.
Drawn draw_pictures(const std::filesystem::path& out, const std::vector<Drawing>&);

}  // namespace clothbench
