// Table 4.
#include <algorithm>

#include "clothbench/feature.hpp"
#include "report/view.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

std::string words(std::string_view text) {
  std::string name(text);
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

/// The first declaration among the runs.
Cell declared(const Group& g, const Keys& keys) {
  json features;
  for (const Row* r : g)
    if (features.is_null()) features = environment_of(*r->run, "solver_features");
  if (features.is_null()) return "not built";
  const auto has = [&](const char* list) {
    const json& names = features.at(list);
    return std::any_of(names.begin(), names.end(),
                       [&](const json& name) { return words(name.get<std::string>()) == keys.front().text; });
  };
  if (has("ignores")) return "ignored";
  if (!has("supports")) return "no";
  std::string text = "yes";
  for (const json& pair : features.at("only_with"))
    if (words(pair.at(0).get<std::string>()) == keys.front().text)
      text += " (only with " + words(pair.at(1).get<std::string>()) + ")";
  return text;
}

}  // namespace

View feature_view() {
  View v{"features", "Table 4: features",
         "As solvers declare them. Ignored: the solver runs the scene and leaves the feature out.",
         [](const Row& r) { return r.published < 0 && r.status() != "missing"; }};
  v.keys = {{"feature", [](const Row&) {
               Keys out;
               for (const FeatureRow& f : kFeatures) out.emplace_back(words(f.name));
               return out;
             }}};
  v.across = {key(
                  "", [](const Row& r) { return r.solver; }, true),
              declared};
  v.in_full = true;
  return v;
}

}  // namespace clothbench
