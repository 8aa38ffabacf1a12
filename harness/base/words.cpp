#include "base/words.hpp"

#include <numeric>
#include <regex>

#include "clothbench/solver.hpp"

namespace clothbench {
namespace {

/// Levenshtein distance.
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row.back();
}

}  // namespace

std::string shortened(const std::string& text, std::size_t most) {
  std::size_t end = std::min(most, text.size());
  // Cuts no UTF-8 character in two.
  while (end > 0 && end < text.size() && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  std::string out = text.substr(0, end);
  std::replace_if(
      out.begin(), out.end(), [](unsigned char c) { return c < ' ' || c == 0x7F; }, '?');
  return end < text.size() ? out + "…" : out;
}

std::string in_quotes(const std::string& word) { return "\"" + shortened(word, 40) + "\""; }

std::string regex_replaced(const std::string& text, const std::string& pattern, const std::string& with) {
  return std::regex_replace(text, std::regex(pattern), with);
}

std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

std::string nearest(const std::string& word, const std::vector<std::string>& known) {
  std::string best;
  std::size_t least = std::max<std::size_t>(2, word.size() / 2) + 1;
  for (const std::string& k : known) {
    // The difference in length is a lower bound of the distance; it is compared first because the input may be long.
    if (std::max(word.size(), k.size()) - std::min(word.size(), k.size()) >= least) continue;
    if (const std::size_t d = distance(word, k); d < least) {
      least = d;
      best = k;
    }
  }
  return best;
}

std::string nearest_known(const std::string& word, const std::vector<std::string>& known) {
  const std::string near = nearest(word, known);
  return near.empty() ? "" : "; nearest known: " + near;
}

}  // namespace clothbench
