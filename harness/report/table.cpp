#include "report/table.hpp"

#include <algorithm>

namespace clothbench {
namespace {

/// Characters on screen: bytes that do not continue a UTF-8 sequence.
std::size_t width(const std::string& s) {
  return static_cast<std::size_t>(std::count_if(s.begin(), s.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0u) != 0x80u; }));
}

}  // namespace

std::string Table::markdown() const {
  std::string out = "### " + title + "\n\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    out += "|";
    for (const std::string& cell : rows[r]) out += " " + cell + " |";
    out += "\n";
    if (r > 0) continue;
    out += "|---|";
    for (std::size_t k = 1; k < rows[0].size(); ++k) out += "--:|";
    out += "\n";
  }
  return out + (note.empty() ? "" : "\n" + note + "\n");
}

std::string Table::console() const {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], width(row[k]));
  }
  std::string out = "\n" + title + "\n";
  for (const auto& row : rows) {
    out += " ";
    for (std::size_t k = 0; k < row.size(); ++k) {
      const std::string pad(widths[k] - width(row[k]), ' ');
      out += k == 0 ? " " + row[k] + pad : "  " + pad + row[k];
    }
    out += "\n";
  }
  return out + (note.empty() ? "" : "  " + note + "\n");
}

std::string csv_row(const std::vector<std::string>& fields) {
  std::string out;
  for (std::size_t k = 0; k < fields.size(); ++k) {
    const bool quote = fields[k].find_first_of(",\"\n\r") != std::string::npos;
    std::string text = fields[k];
    for (std::size_t at = 0; quote && (at = text.find('"', at)) != std::string::npos; at += 2) text.insert(at, 1, '"');
    out += (k > 0 ? "," : "") + (quote ? "\"" + text + "\"" : text);
  }
  return out + "\n";
}

}  // namespace clothbench
