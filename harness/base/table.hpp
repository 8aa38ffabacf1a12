#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace clothbench {

/// Width [characters] for tables and their notes: COLUMNS, otherwise the terminal's, otherwise 80; at least 40.
std::size_t console_columns();

/// A table of text that can be printed for the terminal, as Markdown or as LaTeX. The first row of cells is the header.
struct Table {
  std::string title, note;
  std::vector<std::vector<std::string>> rows;
  bool in_full = false;  ///< a detailed table, for files and the page only, not for the terminal

  std::string markdown() const;
  /// A `table` environment for LaTeX with the package booktabs: the title as caption, the note below the rows. Uses
  /// only characters that LaTeX has without further packages.
  std::string latex() const;
  /// Columns beyond console_columns() follow below, after a copy of the first one or two columns. The note is wrapped.
  std::string console() const;
};

/// A number with `digits` significant digits and no exponent; "–" for a missing value.
std::string significant(double v, int digits);

/// Two results of `significant`, separated by `between`; "–" if both are missing.
std::string paired(double a, double b, const std::string& between, int digits);

/// Width [characters] of UTF-8 text that has no combining or double-width characters.
std::size_t display_width(const std::string&);

/// Breaks text at spaces so that indented lines fit `columns`; a longer word gets its own line. Ends with a newline.
/// `head` replaces the first line's indent; a longer head shifts the first line's text.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t columns, const std::string& head = "");

}  // namespace clothbench
