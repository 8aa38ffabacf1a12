#include "report/features.hpp"

#include <algorithm>

#include "base/words.hpp"
#include "clothbench/feature.hpp"
#include "report/run_table.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

std::string words(std::string_view text) {
  std::string name(text);
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string feature_text(const json& declared, std::string_view name) {
  if (declared.is_null()) return "not built";
  if (contains(declared.at("ignores"), name)) return "ignored";
  if (!contains(declared.at("supports"), name)) return "no";
  std::string text = "yes";
  for (const json& pair : declared.at("only_with"))
    if (pair.at(0) == name) text += " (only with " + words(pair.at(1).get<std::string>()) + ")";
  return text;
}

}  // namespace

DeclaredFeatures declared_features(const std::vector<RunRecord>& runs) {
  DeclaredFeatures out;
  for (const RunRecord& c : runs) {
    const std::string& solver = c.header.solver;
    auto& [unused, features] = find_or_add(out, [&](auto& s) { return s.first == solver; }, {solver, json()});
    if (features.is_null()) features = environment_of(c, "solver_features");
  }
  return out;
}

Table feature_table(const DeclaredFeatures& solvers) {
  Table t{"Table 4: features",
          "As solvers declare them. Ignored: the solver runs the scene and leaves the feature out.",
          {{"feature"}}};
  for (const auto& [solver, unused] : solvers) t.rows[0].push_back(solver);
  for (const FeatureRow& f : kFeatures) {
    t.rows.push_back({words(f.name)});
    for (const auto& [unused, declared] : solvers) t.rows.back().push_back(feature_text(declared, f.name));
  }
  return t;
}

json feature_json(const DeclaredFeatures& solvers) {
  json rows = json::array();
  for (const FeatureRow& f : kFeatures) {
    rows.push_back({{"name", f.name}, {"doc", f.doc}, {"solvers", json::object()}});
    for (const auto& [solver, declared] : solvers) rows.back()["solvers"][solver] = feature_text(declared, f.name);
  }
  return rows;
}

}  // namespace clothbench
