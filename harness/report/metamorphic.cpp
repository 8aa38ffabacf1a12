#include "report/metamorphic.hpp"

#include <fmt/format.h>

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

}  // namespace

bool is_metamorphic(const RunRecord& c) { return has_block(c, "metamorphic"); }

std::vector<Table> metamorphic_tables(const std::vector<RunRecord>& runs) {
  std::vector<Table> out;
  const std::vector<Row> all = rows_of(runs);
  for (const std::string& label : distinct(all, &Row::label)) {
    std::vector<Row> rows;  // the first of each property
    for (const Row& r : all)
      if (r.label == label)
        find_or_add(
            rows, [&](const Row& x) { return x.property == r.property; }, r);
    out.push_back(
        Columns<Row>{{"", "property", &Row::property}, {"", "what changes", &Row::doc}}
            .across(distinct(all, &Row::scene), std::identity{},
                    [&](const Row& row, const std::string& scene) {
                      std::string text;
                      for (const Row& r : all)
                        if (r.label == label && r.property == row.property && r.scene == scene) text = text_of(r);
                      return text;
                    })
            .table({fmt::format("Metamorphic properties of {}", label),
                    "Greatest distance from the expected motion over all vertices and frames, divided by the longer "
                    "side; \"0 bits\": no bit differs.",
                    {}},
                   rows));
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
