#pragma once
#include <string>
#include <vector>

namespace clothbench {

/// A table of text, printed for the terminal, as Markdown or as CSV. The first row of cells is the header.
struct Table {
  std::string title, note;
  std::vector<std::vector<std::string>> rows;

  std::string markdown() const;
  std::string console() const;
};

/// Fields with comma, quote or line break quoted as RFC 4180 says.
std::string csv_row(const std::vector<std::string>& fields);

}  // namespace clothbench
