#include <fmt/format.h>

#include "base/words.hpp"
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

/// An override of the key would give all values of the axis the same scene.
void check_free(const json& axis, const std::vector<std::string>& set) {
  const std::string start = axis["key"].get<std::string>() + "=";
  for (const std::string& item : set)
    if (item.starts_with(start))
      throw Error("--set " + shortened(item, 200) + ": the study varies this key; give it in a copy of the study file");
}

Variant with_value(Variant v, const json& axis, std::size_t k) {
  v.tags.push_back(axis["labels"][k].get<std::string>());
  v.suffix += "-" + v.tags.back();
  v.overrides.push_back(axis["key"].get<std::string>() + "=" + axis["values"][k].dump());
  for (const auto& [key, values] : axis["with"].items()) v.overrides.push_back(key + "=" + values[k].dump());
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
    check_free(axis, set);
    count *= static_cast<double>(axis["values"].size());
  }
  if (!(count <= static_cast<double>(kMostRuns)))
    throw Error(fmt::format("{}: {}/axes: they make {:.0f} scenes; a study may have at most {} runs", source, pointer,
                            count, kMostRuns));
  for (const json& axis : axes) {
    std::vector<Variant> next;
    for (const Variant& v : all)
      for (std::size_t k = 0; k < axis["values"].size(); ++k) next.push_back(with_value(v, axis, k));
    all = std::move(next);
  }
  return all;
}

}  // namespace clothbench
