#include <fmt/format.h>

#include <mutex>
#include <nlohmann/json.hpp>
#include <set>

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

/// Once a process, solver and subject: what is stored is read again and again.
void notice(const std::string& solver, const std::string& subject, const std::string& text) {
  static std::mutex mutex;
  static std::set<std::string> reported;
  const std::lock_guard lock(mutex);
  if (reported.insert(solver + subject).second) fmt::print(stderr, "notice: solver {}: {}\n", solver, text);
}

/// Takes members named in `retired` out of an object; returns their names.
std::vector<std::string> take_retired(json& settings, const std::vector<std::string>& retired) {
  std::vector<std::string> found;
  for (const std::string& name : retired)
    if (settings.is_object() && settings.erase(name) > 0) found.push_back(name);
  return found;
}

bool fits(const json& given, const json& standard) {
  if (standard.is_number_integer()) return given.is_number_integer();
  if (standard.is_number()) return given.is_number();
  return given.type() == standard.type();
}

}  // namespace

json flat_settings(json settings) {
  if (!settings.is_object()) return settings;
  const json tuning = settings.value(kTuning, json());
  if (!tuning.is_object()) return settings;
  settings.erase(kTuning);
  settings.update(tuning);
  return settings;
}

json complete_settings(const SolverInfo& info, const json& as_given) {
  json given = as_given;
  std::vector<std::string> retired = take_retired(given, info.retired);
  if (given.contains(kTuning))
    for (std::string& name : take_retired(given[kTuning], info.retired)) retired.push_back(std::move(name));
  if (!retired.empty()) notice(info.name, "retired", joined(retired) + ": no longer a setting; without effect");
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
    if (!of.contains(key))
      throw Error(fmt::format("solver {}: no setting {}{}", info.name, in_quotes(path),
                              names.empty() ? "; it has none" : nearest_known(path, names)));
    if (!fits(value, of[key]))
      throw Error(fmt::format("solver {}: setting {}: expected {}; found {}", info.name, path, kind(of[key]),
                              shortened(value.dump(), 60)));
    if (seen.emplace(key, value).first.value() != value)
      throw Error(
          fmt::format("solver {}: setting {}: given twice with different values; expected one value", info.name, path));
    of[key] = value;
  };
  std::vector<std::string> moved;
  for (const auto& [key, value] : given.items()) {
    const bool was_here = tuning.contains(key);
    if (was_here) moved.push_back(key);
    put(was_here ? tuning : all, key, value, key);
    if (key != kTuning) continue;
    for (const auto& [member, own] : value.items()) put(tuning, member, own, fmt::format("{}.{}", key, member));
  }
  if (!moved.empty())
    notice(info.name, "moved",
           fmt::format("{}: now in the setting \"{}\", as {}.<name> on the command line", joined(moved), kTuning,
                       kTuning));
  if (!tuning.empty()) all[kTuning] = std::move(tuning);
  return all;
}

}  // namespace clothbench
