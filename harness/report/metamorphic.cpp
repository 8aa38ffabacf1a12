#include "report/metamorphic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/json_number.hpp"
#include "report/grid.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

/// A stored run, read.
struct Row {
  std::string label, solver, property, doc, scene, status;
  double distance = kMissing, at_most = kMissing;
  bool bitwise = false;
};

Row row_of(const RunRecord& c) {
  const json of = scenario_of(c)["metamorphic"];
  Row r{label_of(c), c.header.solver, of["property"], of["doc"], of["scene"], "failed"};
  r.distance = summary_value(c, "metamorphic_distance");
  r.at_most = summary_value(c, "metamorphic_at_most");
  r.bitwise = summary_value(c, "metamorphic_bits_differ") == 0;
  const std::string& status = c.outcome.status;
  if (status == "ok") r.status = c.outcome.expect == "pass" ? "pass" : "fail";
  if (status == "unsupported" || status == "missing") r.status = status;
  if (status == "crashed") r.status = "crashed: " + c.outcome.message;
  return r;
}

std::vector<Row> rows_of(const std::vector<RunRecord>& runs) {
  std::vector<Row> out;
  for (const RunRecord& c : runs)
    if (is_metamorphic(c)) out.push_back(row_of(c));
  return out;
}

std::string text_of(const Row& r) {
  constexpr double kRounding = 1e-4;  // a greater bound is the solver's own error
  if (!std::isfinite(r.distance)) return r.status;
  const std::string figure = r.bitwise ? "0 bits" : fmt::format("{:.1e}", r.distance);
  if (r.status == "pass" && r.at_most > kRounding) return fmt::format("pass ({}, own error {:.1e})", figure, r.at_most);
  return fmt::format("{} ({})", r.status, figure);
}

/// Index of the text in the list, added at its end if it is new.
std::size_t place(std::vector<std::string>& list, const std::string& text) {
  const auto at = std::find(list.begin(), list.end(), text);
  if (at == list.end()) list.push_back(text);
  return static_cast<std::size_t>(std::find(list.begin(), list.end(), text) - list.begin());
}

}  // namespace

bool is_metamorphic(const RunRecord& c) {
  const json s = scenario_of(c);
  return s.is_object() && s.contains("metamorphic");
}

std::vector<Table> metamorphic_tables(const std::vector<RunRecord>& runs) {
  std::vector<Table> out;
  std::vector<std::string> labels, scenes;
  const std::vector<Row> all = rows_of(runs);
  for (const Row& r : all) place(scenes, r.scene);
  for (const Row& r : all) {
    const std::size_t k = place(labels, r.label);
    if (k == out.size()) {
      out.push_back({fmt::format("Metamorphic properties of {}", r.label),
                     "Greatest distance from the expected motion over all vertices and frames, divided by the longer "
                     "side; \"0 bits\": no bit differs.",
                     {{"property", "what changes"}}});
      out[k].rows[0].insert(out[k].rows[0].end(), scenes.begin(), scenes.end());
    }
    std::vector<std::string> empty(2 + scenes.size(), "–");
    empty[0] = r.property;
    empty[1] = r.doc;
    auto& row = find_or_add(
        out[k].rows, [&](const auto& cells) { return cells[0] == r.property; }, empty);
    row[2 + place(scenes, r.scene)] = text_of(r);
  }
  return out;
}

json metamorphic_json(const std::vector<RunRecord>& runs) {
  json out = json::array();
  for (const Row& r : rows_of(runs))
    out.push_back({{"solver", r.solver},
                   {"property", r.property},
                   {"scene", r.scene},
                   {"status", r.status},
                   {"distance", finite_or_null(r.distance)},
                   {"bitwise", r.bitwise},
                   {"at_most", finite_or_null(r.at_most)}});
  return out;
}

}  // namespace clothbench
