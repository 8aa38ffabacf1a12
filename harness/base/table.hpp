#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace clothbench {

/// Columns of the terminal that tables and their notes are made to fit.
inline constexpr std::size_t kConsoleColumns = 120;

/// A table of text, printed for the terminal or as Markdown. The first row of cells is the header.
struct Table {
  std::string title, note;
  std::vector<std::vector<std::string>> rows;
  bool in_full = false;  ///< of detail: for files and the page, not for the terminal

  std::string markdown() const;
  /// Columns that do not fit kConsoleColumns follow below, with the first two repeated; the note is wrapped. Verdicts
  /// are coloured where colour is on (base/tint.hpp).
  std::string console() const;
};

/// `digits` significant digits without an exponent; "–" for a missing value.
std::string significant(double v, int digits);

/// Two of them with something between; "–" if both are missing.
std::string paired(double a, double b, const std::string& between, int digits);

/// Characters on screen of UTF-8 text without combining or double-width characters.
std::size_t display_width(const std::string&);

/// Breaks text at spaces so that lines with their indent fit `columns`; a longer word stands alone. Ends in a newline.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t columns);

/// In full precision, for CSV: "inf" and "-inf" where it is infinite, nothing where it is missing.
std::string csv_number(double v);

/// Fields with comma, quote or line break quoted as RFC 4180 says.
std::string csv_row(const std::vector<std::string>& fields);

}  // namespace clothbench
