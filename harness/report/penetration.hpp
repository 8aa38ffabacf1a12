#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"
#include "report/grid.hpp"

namespace clothbench {

/// True if the run's scene has something to touch or hands that hold: the tables below report its result instead
/// of those of frames per second.
bool has_contact(const RunRecord&);

/// True if the run's scene is the strip pulled at both ends (reference case two-hand-pull).
bool pulls_strip(const RunRecord&);

/// A run in these tables. Points into the vector it was made from.
struct ContactRow {
  const RunRecord* run = nullptr;
  Series series;
  std::string kind = {}, scene = {};  ///< of its set-up and scene
};

/// All runs of the scenes of one name, the same scene in several forms (sides, part of the room) among them.
struct ContactScene {
  std::string name;
  std::vector<ContactRow> rows;  ///< by solver and setting
};

/// Scenes that show the same kind of contact.
struct ContactSetUp {
  std::string kind;   ///< "rooms", "capsules", "hand", "grip", "wave" or "shapes": of file names and figures
  std::string title;  ///< with the paper's section and table where the scenes name them
  std::vector<ContactScene> scenes;
};

/// Sorts the runs with contact; the others are left out. `runs` must outlive the answer.
std::vector<ContactSetUp> set_ups(const std::vector<RunRecord>& runs);

/// All of them, in order.
std::vector<ContactRow> contact_rows(const std::vector<ContactSetUp>&);

/// What came of one bound of a scene's `expect`.
struct BoundResult {
  std::string name;  ///< of the summary value, or "outcome"
  double passed;     ///< 1 pass, 0 fail, NaN not known
};

/// Of every bound of the run's scene. The one place that tables of verdicts and of speeds that fail are made from.
std::vector<BoundResult> bound_results(const RunRecord&);

/// What came of the scene's `expect`: "pass", "fail", "not measured", "–" if it expects nothing or what it expects
/// must not be printed (withheld.hpp), "ignored" if it was kept by a solver that ignores all contact; how the run
/// ended if it did not end well.
std::string verdict(const RunRecord&);

/// Rows: scenes; columns: solvers; entries: `verdict`.
Table verdict_table(const std::vector<ContactSetUp>&);

/// Rows: scene x solver; columns: what went through and what it costs. A column without any value is left out.
Table contact_table(const ContactSetUp&);

/// The same rows: bytes, memory, dispatches, time to load.
Table cost_table(const ContactSetUp&);

/// Every broken expectation with its value and bound; no rows but the header if there is none.
Table failed_expectations_table(const std::vector<ContactSetUp>&);

nlohmann::json penetration_json(const std::vector<ContactSetUp>&);

/// Per-frame metrics of contact and stretch, one row a frame, six digits; missing = empty. What the figures are drawn
/// from.
std::string series_csv(const std::vector<ContactSetUp>&);

}  // namespace clothbench
