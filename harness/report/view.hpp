#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/table.hpp"
#include "report/run_table.hpp"

namespace clothbench {

/// Runs behind one cell of a table; never empty.
using Group = std::vector<const Row*>;
using Texts = std::vector<std::string>;

/// A value of a table: its text, and what it means to the page, which sorts by the number and tints by the tone. A
/// missing value has no text and is shown as "–".
struct Cell {
  std::string text;
  double value = kMissing;  ///< NaN: the text is no number
  const char* tone = "";    ///< "good", "bad", "dim" or none

  Cell() = default;
  Cell(std::string t, double v = kMissing, const char* tinted = "") : text(std::move(t)), value(v), tone(tinted) {}
  Cell(const char* t) : text(t) {}
  bool is_missing() const { return text.empty(); }
};
/// A number with `digits` significant digits.
Cell number_cell(double v, int digits);
/// "12.3 / 4.50", sorted by the first.
Cell paired_cell(double a, double b, int digits);

/// How many runs passed, with Wilson's 95 % interval: "53/58 (81–96 %)". Empty without runs.
Cell share_cell(std::size_t passed, std::size_t all);

/// The verdict on a run; how it ended.
Cell verdict_cell(const RunRecord&);
Cell ending_cell(const RunRecord&);

/// A value by which runs are divided. `all`: it stands for all values of its key, and its row is the last one.
struct KeyValue {
  bool all = false;
  std::string text;

  KeyValue(std::string t, bool stands_for_all = false) : all(stands_for_all), text(std::move(t)) {}
  auto operator<=>(const KeyValue&) const = default;
};
using Keys = std::vector<KeyValue>;

/// Divides runs into rows or columns. A run with several values stands in several of them (all as well as its own).
struct Key {
  std::string head;
  std::function<Keys(const Row&)> of;
  bool is_solver = false;  ///< the page's filter of solvers applies to its values
};
/// A key with one value per run.
Key key(std::string head, std::function<std::string(const Row&)> of, bool is_solver = false);

/// The scene; the solver with its setting and the number of a repeated run; the sides.
Key scene_key();
Key solver_key();
Key sides_key();

/// A value of a row.
struct ViewColumn {
  std::string head;
  std::function<Cell(const Group&, const Keys& keys)> cell;
  bool if_differs = false;  ///< left out where all rows have the same value
};
using Pick = std::function<const Row*(const Group&)>;
inline const Row* first_of(const Group& g) { return g.front(); }
/// A column that shows the run that `pick` gives, empty where it gives none.
ViewColumn column(std::string head, std::function<Cell(const Row&)> cell, bool if_differs = false,
                  Pick pick = first_of);

/// The ratio of two values, with the minimum and maximum ratio of values within both intervals.
Cell ratio_cell(double value, const Interval&, double by, const Interval& of_by);
/// The number of timed trials; the rank by wall time; how many times as fast as time_baseline() the median frame is.
Cell trials_cell(const Row&);
Cell rank_cell(const Row&);
Cell times_as_fast_cell(const Row&);

/// Columns made from the runs: one per value of `key`, ascending by `order`. In a narrow window only the last `leading`
/// of these columns keep their place; the rest of them follow all other columns.
struct Across {
  Key key;
  std::function<Cell(const Group&, const Keys& keys)> cell;
  std::function<double(const Row&)> order = nullptr;
  std::size_t leading = SIZE_MAX;
};

/// One column per band of `value`, whose lower ends are `lows`, ascending. A name shows the next band's end less `gap`:
/// 1 for whole numbers.
Across by_bands(const std::vector<double>& lows, std::function<double(const Row&)> value,
                std::function<Cell(const Group&, const Keys&)> cell, double gap = 0, const char* unit = "");

/// A table of a report as data. Every table of report.md, tables.tex, the page and the terminal is one of these.
struct View {
  std::string section, title, note;
  std::function<bool(const Row&)> where;
  std::vector<Key> keys = {};            ///< one row per combination of their values; the first columns
  std::vector<ViewColumn> columns = {};  ///< left out where no row has a value
  std::optional<Across> across = {};
  std::function<std::string(const Row&)> each = nullptr;    ///< one table per value, which is its title
  std::function<std::string(const Group&)> more = nullptr;  ///< a further sentence of the note
  std::function<double(const Group&)> order = nullptr;      ///< rows ascend by it
  bool by_key = false;   ///< rows in the order of their keys; otherwise in the order of the runs
  bool timed = false;    ///< shows times: the note states whose times are withheld
  bool in_full = false;  ///< only in files and on the page, not on the terminal
};

/// A table with the runs behind it, for filters and commands of the page.
struct ViewTable : Table {
  std::vector<const Row*> runs = {};          ///< the first run of each row
  std::vector<Group> again = {};              ///< by row: the runs that its command makes again; none of a sum
  std::size_t keys = 0;                       ///< number of columns that tell the rows apart
  std::vector<std::size_t> late = {};         ///< columns that stand last in a narrow window
  int solver_column = -1;                     ///< column of the key that names the solver; -1: none
  std::vector<std::vector<Cell>> cells = {};  ///< of the rows below the head; empty: text only
  std::vector<std::string> solvers = {};      ///< by column: the solver that a column is about, or ""
};

/// Adds columns on the run that `pick` gives: median wall time of a frame with its interval, tails, missed deadlines,
/// real-time factor, GPU times, and precision, device and threads where rows differ in them.
void add_tail_columns(View&, const Pick& pick);

/// The tables of a view that have rows and values; none if no run is concerned.
std::vector<ViewTable> tables_of(const View&, const RunTable&);

/// All views, in the order of report.md.
const std::vector<View>& views();

/// The limit of a criterion in the scene of a run, and the value that was found, with units.
std::string expected_of(const Row&, const std::string& criterion);
Cell found_of(const Row&, const std::string& criterion);
/// Contact offset [mm] of these runs, "3.5 to 20" where it differs; empty without colliders.
std::string offset_of(const Group&);
/// "S01 stiffness" of a scene that stability is judged on.
std::string case_of(const Row&);
/// 0 stable, 1 degraded, 2 failed; -1 if stability is not judged, the solver does not support it or it was not run.
int grade_of(const Row&);

/// A run of a claim of the article, with the settings that the article leaves open.
struct ClaimPoint {
  std::string claim;
  double iterations = 1, substeps = 1;
  std::size_t bounds = 0, unmet = 0;  ///< the check of motion is no part of a claim
  bool ended = false;
  bool holds() const { return ended && bounds > 0 && unmet == 0; }
  /// One of several bounds is not met.
  bool is_near() const { return ended && bounds > 1 && unmet == 1; }
};
ClaimPoint claim_point(const Row&);

/// Table 4: features by solver, as runs of these state them (describe_features); "not built" where a build lacks a
/// solver.
View feature_view();

// Parts of views(), by file.
std::vector<View> overview_views();
std::vector<View> rate_views();
std::vector<View> contact_views();
std::vector<View> reproduction_views();
std::vector<View> accuracy_views();

}  // namespace clothbench
