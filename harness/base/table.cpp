#include "base/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/tint.hpp"

namespace clothbench {
namespace {

constexpr std::size_t kLabelColumns = 2;  // solver and sides, repeated where a table is too wide for one piece
constexpr std::size_t kGap = 2;

/// A bar or line break inside a cell would end it.
std::string markdown_cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|')
      out += "\\|";
    else
      out += c == '\n' || c == '\r' ? ' ' : c;
  }
  return out;
}

}  // namespace

std::string significant(double v, int digits) {
  if (!std::isfinite(v)) return "–";
  const int before = v == 0 ? 1 : static_cast<int>(std::floor(std::log10(std::abs(v)))) + 1;
  return fmt::format("{:.{}f}", v, std::max(0, digits - before));
}

std::string paired(double a, double b, const std::string& between, int digits) {
  if (!std::isfinite(a) && !std::isfinite(b)) return "–";
  return significant(a, digits) + between + significant(b, digits);
}

std::size_t display_width(const std::string& s) {
  // Bytes that do not continue a UTF-8 sequence.
  return static_cast<std::size_t>(
      std::count_if(s.begin(), s.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0u) != 0x80u; }));
}

std::string wrapped(const std::string& text, std::size_t indent, std::size_t columns) {
  std::istringstream words(text);
  std::string out, line(indent, ' ');
  for (std::string word; words >> word;) {
    if (display_width(line) > indent && display_width(line) + 1 + display_width(word) > columns) {
      out += line + "\n";
      line.assign(indent, ' ');
    }
    if (display_width(line) > indent) line += ' ';
    line += word;
  }
  return out + line + "\n";
}

std::string Table::markdown() const {
  std::string out = "### " + title + "\n\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    out += "|";
    for (const std::string& cell : rows[r]) out += " " + markdown_cell(cell) + " |";
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
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], display_width(row[k]));
  }
  std::string out = "\n" + tinted(Tone::Heading, title) + "\n";
  for (std::size_t first = kLabelColumns; first == kLabelColumns || first < widths.size();) {
    std::size_t total = 1, last = first;
    for (std::size_t k = 0; k < std::min(kLabelColumns, widths.size()); ++k) total += widths[k] + kGap;
    while (last < widths.size() && (last == first || total + widths[last] + kGap <= kConsoleColumns))
      total += widths[last++] + kGap;
    for (const auto& row : rows) {
      const bool head = &row == &rows.front();
      out += " ";
      for (std::size_t k = 0; k < row.size(); ++k) {
        if (k >= kLabelColumns && (k < first || k >= last)) continue;
        const std::string pad(widths[k] - display_width(row[k]), ' ');
        out += k == 0 ? " " + row[k] + pad : "  " + pad + tinted(head ? Tone::Plain : tone_of(row[k]), row[k]);
      }
      out += "\n";
    }
    first = std::max(last, first + 1);
  }
  return out + (note.empty() ? "" : wrapped(note, 2, kConsoleColumns));
}

std::string csv_number(double v) { return std::isnan(v) ? "" : fmt::format("{}", v); }

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
