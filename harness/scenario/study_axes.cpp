#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>

#include "clothbench/error.hpp"
#include "scenario/study.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

void check_lengths(const json& axis, std::size_t a, const std::string& pointer, const std::string& source) {
  if (axis["values"].size() != axis["labels"].size())
    throw Error(fmt::format("{}: {}/axes/{}/labels: expected one label a value, {}; found {}", source, pointer, a,
                            axis["values"].size(), axis["labels"].size()));
  for (const auto& [key, values] : axis["with"].items())
    if (values.size() != axis["values"].size())
      throw Error(fmt::format("{}: {}/axes/{}/with/{}: expected one value each of the axis, {}; found {}", source,
                              pointer, a, key, axis["values"].size(), values.size()));
}

/// The last value that `set` gives the axis's key.
std::optional<json> fixed_value(const json& axis, const std::vector<std::string>& set) {
  const std::string start = axis["key"].get<std::string>() + "=";
  std::optional<json> out;
  for (const std::string& item : set) {
    if (!item.starts_with(start)) continue;
    const std::string text = item.substr(start.size());
    out = json::parse(text, nullptr, false);
    if (out->is_discarded()) out = json(text);
  }
  return out;
}

/// Letters, digits and . _ of a value, with - between: "[24,24]" -> "24-24".
std::string label_of_value(const json& value) {
  std::string out;
  for (const char c : value.is_string() ? value.get<std::string>() : value.dump()) {
    const bool kept = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '_';
    if (kept || (!out.empty() && out.back() != '-')) out += kept ? c : '-';
  }
  while (!out.empty() && out.back() == '-') out.pop_back();
  return out.empty() ? "set" : out;
}

Variant with_value(Variant v, const json& axis, std::size_t k) {
  v.tags.push_back(axis["labels"][k].get<std::string>());
  v.suffix += "-" + v.tags.back();
  v.overrides.push_back(axis["key"].get<std::string>() + "=" + axis["values"][k].dump());
  for (const auto& [key, values] : axis["with"].items()) v.overrides.push_back(key + "=" + values[k].dump());
  return v;
}

/// The one form of an axis whose value is fixed. The override itself is applied later, with all others.
Variant with_fixed(Variant v, const json& axis, const json& value) {
  const auto& values = axis["values"];
  const auto at = std::find(values.begin(), values.end(), value);
  if (at != values.end())
    v = with_value(std::move(v), axis, static_cast<std::size_t>(at - values.begin()));
  else
    v.suffix += "-" + label_of_value(value);
  for (const auto& label : axis["labels"]) v.tags.push_back(label.get<std::string>());
  v.merged = true;
  return v;
}

}  // namespace

std::vector<Variant> expand(const json& axes, const std::string& pointer, const std::string& source,
                            const std::vector<std::string>& set) {
  std::vector<Variant> all(1);
  double count = 1;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const json& axis = axes[a];
    check_lengths(axis, a, pointer, source);
    const std::optional<json> only = fixed_value(axis, set);
    if (!only) count *= static_cast<double>(axis["values"].size());
  }
  if (!(count <= static_cast<double>(kMostRuns)))
    throw Error(fmt::format("{}: {}/axes: they make {:.0f} scenes; a study may have at most {} runs", source, pointer,
                            count, kMostRuns));
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const json& axis = axes[a];
    const std::optional<json> only = fixed_value(axis, set);
    std::vector<Variant> next;
    for (const Variant& v : all) {
      if (only) next.push_back(with_fixed(v, axis, *only));
      for (std::size_t k = 0; !only && k < axis["values"].size(); ++k) next.push_back(with_value(v, axis, k));
    }
    all = std::move(next);
  }
  return all;
}

}  // namespace clothbench
