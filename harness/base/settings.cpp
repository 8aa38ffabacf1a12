#include <fmt/format.h>

#include "base/json_text.hpp"
#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

const char* kind(const json& v) {
  return v.is_number_integer() ? "an integer"
         : v.is_number()       ? "a number"
         : v.is_boolean()      ? "true or false"
         : v.is_object()       ? "an object"
                               : "a string";
}

bool fits(const json& given, const json& standard) {
  if (standard.is_number_integer()) return given.is_number_integer();
  if (standard.is_number()) return given.is_number();
  return given.type() == standard.type();
}

}  // namespace

json complete_settings(const SolverInfo& info, const json& given) {
  json all = json::object(), tuning = json::object();
  std::vector<std::string> names;
  for (const SettingSpec& s : info.settings) {
    all[s.name] = json_from(s.default_json);
    names.push_back(s.name);
  }
  for (const SettingSpec& s : info.tuning) {
    tuning[s.name] = json_from(s.default_json);
    names.push_back(fmt::format("{}.{}", kTuning, s.name));
  }
  if (!tuning.empty()) all[kTuning] = json::object();
  const auto put = [&](json& of, const std::string& key, const json& value, const std::string& path) {
    if (!of.contains(key))
      throw Error(fmt::format("solver {}: no setting {}{}", info.name, in_quotes(path),
                              names.empty() ? "; it has none" : nearest_known(path, names)));
    if (!fits(value, of[key]))
      throw Error(fmt::format("solver {}: setting {}: expected {}; found {}", info.name, path, kind(of[key]),
                              shortened(dump(value), 60)));
    of[key] = value;
  };
  for (const auto& [key, value] : given.items()) {
    put(all, key, value, key);
    if (key != kTuning) continue;
    for (const auto& [member, own] : value.items()) put(tuning, member, own, fmt::format("{}.{}", key, member));
  }
  if (!tuning.empty()) all[kTuning] = std::move(tuning);
  return all;
}

}  // namespace clothbench
