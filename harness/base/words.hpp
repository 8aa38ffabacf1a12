#pragma once
#include <algorithm>
#include <functional>
#include <string>
#include <vector>

namespace clothbench {

/// The items in order, separated by `between`. `text(item)`: the text of an item.
template <class Items, class Text = std::identity>
std::string joined(const Items& items, const std::string& between = ", ", Text text = {}) {
  std::string out;
  for (const auto& item : items) {
    if (!out.empty()) out += between;
    out += std::invoke(text, item);
  }
  return out;
}

template <class Items, class Item>
bool contains(const Items& items, const Item& item) {
  return std::find(std::begin(items), std::end(items), item) != std::end(items);
}

/// A name with spaces in place of its underscores.
inline std::string spaced(std::string_view name) {
  std::string out(name);
  std::replace(out.begin(), out.end(), '_', ' ');
  return out;
}

/// Shortens a text of unknown length for a message: at most `most` bytes and "…", control characters as "?".
std::string shortened(const std::string& text, std::size_t most);

/// A word of the input for a message: shortened to 40 bytes, between quotes.
std::string in_quotes(const std::string& word);

/// Replaces every match of a regular expression. <regex> takes seconds to compile, so only this module includes it.
std::string regex_replaced(const std::string& text, const std::string& pattern, const std::string& with);

/// Converts ASCII letters to lower case, for file extensions.
std::string lower_case(std::string);

/// "; nearest known: …", the end of a message about an unknown word; empty if none is similar (clothbench/solver.hpp).
std::string nearest_known(const std::string& word, const std::vector<std::string>& known);

}  // namespace clothbench
