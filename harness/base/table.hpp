#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace clothbench {

/// Width [characters] that tables and their notes must fit: COLUMNS, else the terminal's, else 80; at least 40.
std::size_t console_columns();

/// A table of text, printed for the terminal, as Markdown or as LaTeX. The first row of cells is the header.
struct Table {
  std::string title, note;
  std::vector<std::vector<std::string>> rows;
  bool in_full = false;  ///< a detailed table, for files and the page only, not for the terminal

  std::string markdown() const;
  /// A `table` environment for LaTeX with the package booktabs: the title as its caption, the note below the rows. Only
  /// characters that LaTeX knows without further packages.
  std::string latex() const;
  /// Columns that do not fit console_columns() follow below, after a copy of the first two. The note is wrapped.
  std::string console() const;
};

/// `digits` significant digits without an exponent; "–" for a missing value.
std::string significant(double v, int digits);

/// Two numbers as by `significant`, with `between` as separator; "–" if both are missing.
std::string paired(double a, double b, const std::string& between, int digits);

/// Width [characters] of UTF-8 text that has no combining or double-width characters.
std::size_t display_width(const std::string&);

/// Breaks text at spaces so that indented lines fit `columns`; a longer word gets its own line. Ends with a newline.
/// `head`: stands in the indent of the first line, or, if longer, before the text.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t columns, const std::string& head = "");

}  // namespace clothbench
