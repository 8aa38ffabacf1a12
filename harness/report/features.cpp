#include "report/features.hpp"

#include <algorithm>
#include <optional>

#include "base/columns.hpp"
#include "base/words.hpp"
#include "report/run_table.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

std::optional<Feature> feature(const json& name) {
  for (std::size_t k = 0; k < kFeatureCount; ++k)
    if (name.is_string() && name.get<std::string>() == kFeatures[k].name) return static_cast<Feature>(k);
  return std::nullopt;
}

/// Leaves out names of features that this build does not know (of later versions).
FeatureSet feature_set(const json& names) {
  FeatureSet set;
  if (names.is_array())
    for (const json& name : names)
      if (const auto f = feature(name)) set.add(*f);
  return set;
}

std::string words(std::string_view name) {
  std::string out(name);
  std::replace(out.begin(), out.end(), '_', ' ');
  return out;
}

void add_run(SolverFeatures& s, const RunRecord& c) {
  const json declared = environment_of(c, "solver_features");
  if (declared.is_object()) {
    s.known = true;
    s.supports |= feature_set(declared.value("supports", json()));
    s.ignores |= feature_set(declared.value("ignores", json()));
    for (const json& pair : declared.value("only_with", json::array())) {
      if (!pair.is_array() || pair.size() != 2) continue;
      const auto f = feature(pair[0]), beside = feature(pair[1]);
      if (f && beside && !contains(s.only_with, std::pair{*f, *beside})) s.only_with.emplace_back(*f, *beside);
    }
  }
}

}  // namespace

std::vector<SolverFeatures> solver_features(const std::vector<RunRecord>& runs) {
  std::vector<SolverFeatures> out;
  for (const RunRecord& c : runs)
    add_run(find_or_add(out, [&](const SolverFeatures& s) { return s.solver == c.header.solver; }, {c.header.solver}),
            c);
  return out;
}

SolverFeatures declared_features(const SolverInfo& info) {
  return {info.name, true, info.supports, info.ignores, info.only_with};
}

std::string feature_text(const SolverFeatures& s, Feature f) {
  if (!s.known) return "not built";
  if (s.ignores.has(f)) return "ignored";
  if (!s.supports.has(f)) return "no";
  std::string text = "yes";
  for (const auto& [what, beside] : s.only_with)
    if (what == f) text += " (only with " + words(name_of(beside)) + ")";
  return text;
}

Table feature_table(const std::vector<SolverFeatures>& solvers) {
  return Columns<FeatureRow>{{"", "feature", [](auto& f) { return words(f.name); }}}
      .across(solvers, &SolverFeatures::solver,
              [&](const FeatureRow& f, const SolverFeatures& s) {
                return feature_text(s, static_cast<Feature>(&f - kFeatures.data()));
              })
      .table({"Table 4: features",
              "As solvers declare them. Ignored: the solver runs the scene and leaves the feature out.",
              {}},
             kFeatures);
}

json feature_json(const std::vector<SolverFeatures>& solvers) {
  json rows = json::array();
  for (std::size_t k = 0; k < kFeatureCount; ++k) {
    json row = {{"name", kFeatures[k].name}, {"doc", kFeatures[k].doc}, {"solvers", json::object()}};
    for (const SolverFeatures& s : solvers) row["solvers"][s.solver] = feature_text(s, static_cast<Feature>(k));
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace clothbench
