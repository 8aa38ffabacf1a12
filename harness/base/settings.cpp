#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

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

const char* kind(const json& v) {
  return v.is_number_integer() ? "an integer"
         : v.is_number()       ? "a number"
         : v.is_boolean()      ? "true or false"
                               : "a string";
}

bool fits(const json& given, const json& standard) {
  if (standard.is_number_integer()) return given.is_number_integer();
  if (standard.is_number()) return given.is_number();
  return given.type() == standard.type();
}

}  // namespace

std::string nearest(const std::string& word, const std::vector<std::string>& known) {
  std::string best;
  std::size_t least = std::max<std::size_t>(2, word.size() / 2) + 1;
  for (const std::string& k : known)
    if (const std::size_t d = distance(word, k); d < least) {
      least = d;
      best = k;
    }
  return best;
}

json complete_settings(const SolverInfo& info, const json& given) {
  json all = json::object();
  std::vector<std::string> names;
  for (const SettingSpec& s : info.settings) {
    all[s.name] = json::parse(s.default_json);
    names.push_back(s.name);
  }
  for (const auto& [key, value] : given.items()) {
    if (!all.contains(key)) {
      const std::string near = nearest(key, names);
      throw Error(fmt::format("solver {}: no setting \"{}\"{}", info.name, key,
                              near.empty() ? names.empty() ? "; it has none" : "" : "; nearest known: " + near));
    }
    if (!fits(value, all[key]))
      throw Error(
          fmt::format("solver {}: setting {}: expected {}; found {}", info.name, key, kind(all[key]), value.dump()));
    all[key] = value;
  }
  return all;
}

}  // namespace clothbench
