#include <string_view>
#include <utility>

#include "base/table.hpp"

namespace clothbench {
namespace {

/// Characters that LaTeX reserves or does not know, and what it prints them for.
constexpr std::pair<std::string_view, std::string_view> kCharacters[] = {{"\\", "\\textbackslash{}"},
                                                                         {"{", "\\{"},
                                                                         {"}", "\\}"},
                                                                         {"$", "\\$"},
                                                                         {"&", "\\&"},
                                                                         {"#", "\\#"},
                                                                         {"%", "\\%"},
                                                                         {"_", "\\_"},
                                                                         {"~", "\\textasciitilde{}"},
                                                                         {"^", "\\textasciicircum{}"},
                                                                         {"<", "$<$"},
                                                                         {">", "$>$"},
                                                                         {"|", "$|$"},
                                                                         {"[", "{[}"},
                                                                         {"–", "--"},
                                                                         {"−", "$-$"},
                                                                         {"…", "\\ldots{}"},
                                                                         {"×", "$\\times$"},
                                                                         {"·", "$\\cdot$"},
                                                                         {"±", "$\\pm$"},
                                                                         {"≤", "$\\le$"},
                                                                         {"≥", "$\\ge$"},
                                                                         {"†", "$^\\dagger$"},
                                                                         {"µ", "$\\mu$"},
                                                                         {"ν", "$\\nu$"},
                                                                         {"°", "$^\\circ$"},
                                                                         {"²", "$^2$"},
                                                                         {"³", "$^3$"},
                                                                         {"⁴", "$^4$"},
                                                                         {"⁵", "$^5$"},
                                                                         {"⁶", "$^6$"},
                                                                         {"⁻", "$^-$"},
                                                                         {"\u00a0", "~"},
                                                                         {"\n", " "},
                                                                         {"\r", " "}};

/// Text in LaTeX; what stands between backticks is set in the typewriter font.
std::string latex_text(std::string_view text) {
  std::string out;
  bool code = false;
  while (!text.empty()) {
    std::size_t length = 1;
    std::string_view written = text.substr(0, 1);
    for (const auto& [character, latex] : kCharacters)
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
