#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"
#include "report/grid.hpp"

namespace clothbench {

/// True if the cell's scene has something to touch or hands that hold: its result is told by the tables below instead
/// of those of frames per second.
bool has_contact(const CellRecord&);

/// True if the cell's scene is the strip pulled at both ends (truth card two-hand-pull).
bool pulls_strip(const CellRecord&);

/// A cell in these tables. Points into the vector it was made from.
struct ContactRow {
  const CellRecord* cell = nullptr;
  Series series;
  std::string kind = {}, scene = {};  ///< of its set-up and scene
};

/// All cells of the scenes of one name, the same scene in several forms (sides, part of the room) among them.
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

/// Sorts the cells with contact; the others are left out. `cells` must outlive the answer.
std::vector<ContactSetUp> set_ups(const std::vector<CellRecord>& cells);

/// All of them, in order.
std::vector<ContactRow> contact_rows(const std::vector<ContactSetUp>&);

/// What came of one bound of a scene's `expect`.
struct BoundResult {
  std::string name;  ///< of the summary value, or "outcome"
  double kept;       ///< 1 kept, 0 broken, NaN not known
};

/// Of every bound of the cell's scene. The one place that tables of verdicts and of speeds that fail are told from.
std::vector<BoundResult> bound_results(const CellRecord&);

/// What came of the scene's `expect`: "kept", "broken", "not measured", "–" if it expects nothing or what it expects
/// must not be printed (withheld.hpp), "ignored" if it was kept by a solver that ignores all contact; how the cell
/// ended if it did not end well.
std::string verdict(const CellRecord&);

/// Rows: scenes; columns: solvers; entries: `verdict`.
Table verdict_table(const std::vector<ContactSetUp>&);

/// Rows: scene x solver; columns: what went through and what it costs. A column without any value is left out.
Table contact_table(const ContactSetUp&);

/// The same rows: bytes, memory, dispatches, time to load.
Table cost_table(const ContactSetUp&);

/// Every broken expectation with its value and bound; no rows but the header if there is none.
Table broken_table(const std::vector<ContactSetUp>&);

nlohmann::json penetration_json(const std::vector<ContactSetUp>&);

/// Per-frame metrics of contact and stretch, one row a frame, six digits; missing = empty. What the figures are drawn
/// from.
std::string series_csv(const std::vector<ContactSetUp>&);

}  // namespace clothbench
