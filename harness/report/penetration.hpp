#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"
#include "report/grid.hpp"
#include "report/verdict.hpp"

namespace clothbench {

/// True if the run's scene has colliders or hands that hold the cloth. The tables below report it then, instead of
/// those of frames per second.
bool has_contact(const RunRecord&);

/// Kind of the run's set-up (ContactSetUp), as its study states it ("set_up"). If none does: by what touches.
std::string set_up_of(const RunRecord&);

/// A run in these tables. Points into the vector it was made from.
struct ContactRow {
  const RunRecord* run = nullptr;
  Series series;
  std::string kind = {}, scene = {};  ///< kind of its set-up, name of its scene
};

/// All runs of the scenes with one name, in all forms (sides, part of the room).
struct ContactScene {
  std::string name;
  std::vector<ContactRow> rows;  ///< by solver and setting
};

/// Scenes that show the same kind of contact.
struct ContactSetUp {
  std::string kind;   ///< "rooms", "capsules", "hand", "grip", "wave" or "shapes"; used in file names and figures
  std::string title;  ///< with the paper's section and table if the scenes name them
  std::vector<ContactScene> scenes;
};

/// Sorts the runs with contact by set-up; leaves the others out. `runs` must outlive the result.
std::vector<ContactSetUp> set_ups(const std::vector<RunRecord>& runs);

/// The rows of all set-ups, in order.
std::vector<ContactRow> contact_rows(const std::vector<ContactSetUp>&);

/// Least and greatest distance [m] at which the run's solver holds the cloth off its colliders: what the solver states,
/// else the scene's margin. NaN if the scene has no collider or the run did not begin.
std::pair<double, double> held_at_m(const RunRecord&);
/// The same in mm, as text: "4", "4 to 20", "–".
std::string held_at(const RunRecord&);
/// The same by solver (labels of series) over all its rows: "4, 20". No cells if no run holds a cloth off anything.
TextRow held_row(const std::vector<ContactRow>&);
/// The head of that row.
inline constexpr const char* kHeldAt = "(the solver holds the cloth at [mm])";

/// Rows: scenes, below a row of the distances at which solvers hold the cloth; columns: solvers; entries: `verdict`.
Table verdict_table(const std::vector<ContactSetUp>&);

/// Rows: scene x solver; columns: penetration and cost. A column without any value is left out.
Table contact_table(const ContactSetUp&);

/// The same rows; columns: bytes, memory, dispatches, time to load, as far as any run has them; without any only the
/// three that name the run.
Table cost_table(const ContactSetUp&);

/// Every broken bound with its value; only the header if there is none.
Table failed_expectations_table(const std::vector<ContactSetUp>&);

nlohmann::json penetration_json(const std::vector<ContactSetUp>&);

/// Per-frame metrics of contact and stretch, one row a frame, six digits; missing = empty. The data of the figures.
std::string series_csv(const std::vector<ContactSetUp>&);

}  // namespace clothbench
