#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

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
         : v.is_object()       ? "an object"
                               : "a string";
}

/// Once a process and solver: what is stored is read again and again.
void tell_moved(const std::string& solver, const std::string& names) {
  static std::mutex mutex;
  static std::set<std::string> reported;
  const std::lock_guard lock(mutex);
  if (reported.insert(solver).second)
    fmt::print(stderr, "notice: solver {}: {}: now in the setting \"{}\", as {}.<name> on the command line\n", solver,
               names, kTuning, kTuning);
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

json flat_settings(json settings) {
  if (!settings.is_object()) return settings;
  const json tuning = settings.value(kTuning, json());
  if (!tuning.is_object()) return settings;
  settings.erase(kTuning);
  settings.update(tuning);
  return settings;
}

json complete_settings(const SolverInfo& info, const json& given) {
  json all = json::object(), tuning = json::object(), seen = json::object();
  std::vector<std::string> names;
  for (const SettingSpec& s : info.settings) {
    all[s.name] = json::parse(s.default_json);
    names.push_back(s.name);
  }
  for (const SettingSpec& s : info.tuning) {
    tuning[s.name] = json::parse(s.default_json);
    names.push_back(fmt::format("{}.{}", kTuning, s.name));
  }
  if (!tuning.empty()) all[kTuning] = json::object();
  const auto put = [&](json& of, const std::string& key, const json& value, const std::string& path) {
    if (!of.contains(key)) {
      const std::string near = nearest(path, names);
      throw Error(fmt::format("solver {}: no setting \"{}\"{}", info.name, path,
                              near.empty() ? names.empty() ? "; it has none" : "" : "; nearest known: " + near));
    }
    if (!fits(value, of[key]))
      throw Error(
          fmt::format("solver {}: setting {}: expected {}; found {}", info.name, path, kind(of[key]), value.dump()));
    if (seen.emplace(key, value).first.value() != value)
      throw Error(
          fmt::format("solver {}: setting {}: given twice with different values; expected one value", info.name, path));
    of[key] = value;
  };
  std::string moved;
  for (const auto& [key, value] : given.items()) {
    const bool was_here = tuning.contains(key);
    if (was_here) moved += (moved.empty() ? "" : ", ") + key;
    put(was_here ? tuning : all, key, value, key);
    if (key != kTuning) continue;
    for (const auto& [member, own] : value.items()) put(tuning, member, own, fmt::format("{}.{}", key, member));
  }
  if (!moved.empty()) tell_moved(info.name, moved);
  if (!tuning.empty()) all[kTuning] = std::move(tuning);
  return all;
}

}  // namespace clothbench
