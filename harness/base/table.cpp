#include "base/table.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

namespace clothbench {
namespace {

constexpr std::size_t kGap = 2;

/// Escapes bars and line breaks, which would end the cell.
std::string markdown_cell(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '|' ? "\\|" : std::string(1, c == '\n' || c == '\r' ? ' ' : c);
  return out;
}

/// Characters that LaTeX reserves or lacks, each followed by its replacement.
constexpr const char* kCharacters = R"(
\ \textbackslash{}  { \{  } \}  $ \$  & \&  # \#  % \%  _ \_  ~ \textasciitilde{}  ^ \textasciicircum{}
< $<$  > $>$  | $|$  [ {[}  – --  − $-$  … \ldots{}  × $\times$  · $\cdot$  ± $\pm$  ≤ $\le$  ≥ $\ge$
† $^\dagger$  µ $\mu$  ν $\nu$  ° $^\circ$  ² $^2$  ³ $^3$  ⁴ $^4$  ⁵ $^5$  ⁶ $^6$  ⁻ $^-$)";

std::vector<std::pair<std::string, std::string>> latex_characters() {
  std::vector<std::pair<std::string, std::string>> out = {{"\u00a0", "~"}, {"\n", " "}, {"\r", " "}};
  std::istringstream in(kCharacters);
  for (std::string character, latex; in >> character >> latex;) out.emplace_back(character, latex);
  return out;
}

/// Text for LaTeX; text between backticks becomes typewriter text.
std::string latex_text(std::string_view text) {
  static const auto kLatex = latex_characters();
  std::string out;
  bool code = false;
  while (!text.empty()) {
    std::size_t length = 1;
    std::string_view written = text.substr(0, 1);
    for (const auto& [character, latex] : kLatex)
      if (text.starts_with(character)) {
        length = character.size();
        written = latex;
      }
    if (text[0] == '`') written = std::exchange(code, !code) ? "}" : "\\texttt{";
    out += written;
    text.remove_prefix(length);
  }
  return code ? out + "}" : out;
}

}  // namespace

std::size_t console_columns() {
  constexpr long kUnknown = 80, kMinimum = 40;
  long columns = 0;
  if (const char* stated = std::getenv("COLUMNS")) columns = std::strtol(stated, nullptr, 10);
  if (winsize size{}; columns <= 0 && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0) columns = size.ws_col;
  return static_cast<std::size_t>(std::max(kMinimum, columns > 0 ? columns : kUnknown));
}

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
  // Counts the bytes that do not continue a UTF-8 sequence.
  return static_cast<std::size_t>(
      std::count_if(s.begin(), s.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0u) != 0x80u; }));
}

std::string wrapped(const std::string& text, std::size_t indent, std::size_t columns, const std::string& head) {
  std::istringstream words(text);
  std::string out, line = head;
  std::size_t width = display_width(head);  // width of the line so far
  const auto pad = [&](std::size_t to) {
    line.append(to > width ? to - width : 0, ' ');
    width = std::max(width, to);
  };
  bool any = false;  // whether the line has a word
  pad(head.empty() ? indent : std::max(indent, width + 2));
  for (std::string word; words >> word; any = true) {
    if ((any || width > indent) && width + (any ? 1 : 0) + display_width(word) > columns) {
      out += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
      line.clear();
      width = 0;
      any = false;
      pad(indent);
    }
    if (any) pad(width + 1);
    line += word;
    width += display_width(word);
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

/// Number of leading columns that each piece of a wide table repeats to identify its rows; at most 2.
static std::size_t label_columns(const std::vector<std::vector<std::string>>& rows) {
  std::set<std::string> names;
  for (const auto& row : rows)
    if (!row.empty()) names.insert(row[0]);
  return names.size() < rows.size() ? 2 : 1;
}

std::string Table::console() const {
  const std::size_t labels = label_columns(rows);
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], display_width(row[k]));
  }
  std::string out = "\n" + title + "\n";
  for (std::size_t first = labels; first == labels || first < widths.size();) {
    std::size_t total = 1, last = first;
    for (std::size_t k = 0; k < std::min(labels, widths.size()); ++k) total += widths[k] + kGap;
    while (last < widths.size() && (last == first || total + widths[last] + kGap <= console_columns()))
      total += widths[last++] + kGap;
    for (const auto& row : rows) {
      out += " ";
      for (std::size_t k = 0; k < row.size(); ++k) {
        if (k >= labels && (k < first || k >= last)) continue;
        const std::string pad(widths[k] - display_width(row[k]), ' ');
        out += k == 0 ? " " + row[k] + pad : "  " + pad + row[k];
      }
      out += "\n";
    }
    first = std::max(last, first + 1);
  }
  return out + (note.empty() ? "" : wrapped(note, 2, console_columns()));
}

std::string Table::latex() const {
  if (rows.empty()) return "";
  std::string out = "\\begin{table}\n\\caption{" + latex_text(title) + "}\n\\begin{tabular}{l" +
                    std::string(rows[0].empty() ? 0 : rows[0].size() - 1, 'r') + "}\n\\toprule\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t k = 0; k < rows[r].size(); ++k) out += (k > 0 ? " & " : "") + latex_text(rows[r][k]);
    out += r == 0 ? " \\\\\n\\midrule\n" : " \\\\\n";
  }
  out += "\\bottomrule\n\\end{tabular}\n";
  if (!note.empty()) out += "\\par\\footnotesize " + latex_text(note) + "\n";
  return out + "\\end{table}\n";
}

}  // namespace clothbench
