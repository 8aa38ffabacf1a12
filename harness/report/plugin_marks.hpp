#pragma once
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// Marks solvers that are plugins with a dagger wherever a report shows them. Every table, the headline and all data of
/// the page's figures pass through it; files for programs (CSV, JSON) keep the plain names.
class PluginMarks {
 public:
  /// The solvers of runs whose environment names a plugin.
  explicit PluginMarks(const std::vector<RunRecord>& runs);

  /// `text` with the mark after every whole word that is a plugin's name.
  std::string text(const std::string& text) const;
  /// The table with its marks, and a sentence in its note if it has any. Columns of scenes, settings, messages and
  /// commands stay as they are.
  Table table(Table t) const;
  std::vector<Table> tables(std::vector<Table> all) const;
  /// Marks the members `solver`, `solvers` and `label`, at any depth, and members that have a plugin's name.
  nlohmann::json data(const nlohmann::json& value) const;

 private:
  std::set<std::string> names_;
};

/// Engine that the run's plugin wraps, as the plugin states it: "NvCloth"; empty if it states none, or is no plugin.
std::string engine_of(const RunRecord&);

}  // namespace clothbench
