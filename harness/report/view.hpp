#pragma once
#include <functional>
#include <optional>

#include "base/table.hpp"
#include "report/run_table.hpp"

namespace clothbench {

/// Runs behind one cell of a table; never empty.
using Group = std::vector<const Row*>;
using Texts = std::vector<std::string>;

/// A value of a table, the number by which the page sorts, and its tint. A missing value has no text; "–" is shown.
struct Cell {
  std::string text;
  double value = kMissing;   ///< NaN: the text is not a number
  const char* tone = "";     ///< "good", "bad", "dim" or none
  const Row* run = nullptr;  ///< run with this solver's name, or with this failed verdict, which the page explains
  std::string why = {};      ///< why there is no verdict or value

  Cell() = default;
  Cell(std::string t, double v = kMissing, const char* tinted = "", std::string reason = {})
      : text(std::move(t)), value(v), tone(tinted), why(std::move(reason)) {}
  Cell(const char* t) : text(t) {}
  bool is_missing() const { return text.empty(); }
};
/// Note of a table, from notes.json.
std::string note(const char* table);
/// A number with `digits` significant digits.
Cell number_cell(double v, int digits);
/// "12.3 / 4.50", sorted by the first.
Cell paired_cell(double a, double b, int digits);
/// Passed runs with Wilson's 95 % interval: "53/58 (81–96 %)". Empty if there are no runs.
Cell share_cell(std::size_t passed, std::size_t all);
/// The verdict on a run, and how a run ended.
Cell verdict_cell(const Row&), ending_cell(const RunRecord&);

/// A value by which runs are grouped. `all`: it covers all values of its key, and its row is the last one.
struct KeyValue {
  bool all = false;
  std::string text;
  KeyValue(std::string t, bool stands_for_all = false) : all(stands_for_all), text(std::move(t)) {}
  auto operator<=>(const KeyValue&) const = default;
};
using Keys = std::vector<KeyValue>;

/// Groups runs into rows or columns. A run with several values (such as its own and "all") is in several groups.
struct Key {
  std::string head;  ///< empty: groups runs, but is no column
  std::function<Keys(const Row&)> of;
  bool is_solver = false;  ///< the page's solver filter applies to its values
};
/// A key with one value per run.
Key key(std::string head, std::function<std::string(const Row&)> of, bool is_solver = false);
/// Keys: the scene; the solver with its setting and the number of a repeated run; the sides.
Key scene_key(), solver_key(), sides_key();

struct ViewColumn {
  std::string head;
  std::function<Cell(const Group&, const Keys& keys)> cell;
  bool if_differs = false;  ///< omitted if all rows have the same value
  bool leads = false;       ///< on the page it stands before the columns that depend on the runs
};
using Pick = std::function<const Row*(const Group&)>;
inline const Row* first_of(const Group& g) { return g.front(); }
/// A column about the run that `pick` returns; empty if it returns none.
ViewColumn column(std::string head, std::function<Cell(const Row&)> cell, bool if_differs = false,
                  Pick pick = first_of);
/// `value` / `by`, with the extreme ratios of values in both intervals, and a mark if the run or its baseline timed
/// fewer frames than other runs. For the run of time_baseline(): 1.00 and the device on which it ran.
Cell ratio_cell(const Row&, double value, const Interval&, double by, const Interval& of_by);
/// The number of timed trials; the rank by wall time; the baseline's median frame time over the run's.
Cell trials_cell(const Row&), rank_cell(const Row&), times_as_fast_cell(const Row&);

/// Columns that depend on the runs: one per value of `key`, ascending by `order`. On the page the last `leading` of
/// them come first.
struct Across {
  Key key;
  std::function<Cell(const Group&, const Keys& keys)> cell;
  std::function<double(const Row&)> order = nullptr;
  std::size_t leading = 0;
};

/// A table of a report as data. Every table of report.md, tables.tex, the page and the terminal is made from one.
struct View {
  std::string section, title, note;  ///< the page folds all lines of the note except the first
  std::function<bool(const Row&)> where;
  std::vector<Key> keys = {};            ///< one row per combination of their values; the first columns
  std::vector<ViewColumn> columns = {};  ///< omitted if no row has a value
  std::optional<Across> across = {};
  std::function<std::string(const Row&)> each = nullptr;    ///< one table per value, which becomes its title
  std::function<std::string(const Group&)> more = nullptr;  ///< an additional sentence for the note
  std::function<double(const Group&)> order = nullptr;      ///< rows are sorted by it, ascending
  bool by_key = false;    ///< rows in the order of their keys; otherwise in the order of the runs
  bool timed = false;     ///< shows times; the note then states whose times are withheld
  bool in_full = false;   ///< only in files and on the page, not on the terminal
  bool explains = false;  ///< states why runs failed; the page links failed verdicts to its rows
};

/// A table with its runs, for the page's filters and commands.
struct ViewTable : Table {
  std::vector<Group> again = {};              ///< by row: its runs, which its command repeats
  std::size_t keys = 0;                       ///< number of columns that identify a row
  std::vector<std::size_t> lead = {};         ///< columns that come first on the page, after the keys
  int solver_column = -1;                     ///< column of the key that names the solver; -1: none
  bool explains = false;                      ///< copied from View::explains
  std::vector<std::vector<Cell>> cells = {};  ///< rows below the head; empty if there is only text
  std::vector<std::string> solvers = {};      ///< by column: its solver, or ""
};

/// Adds columns about the run that `pick` returns: median wall time per frame with its interval, tails, missed
/// deadlines, real-time factor, GPU times; if rows differ in them, precision, device and threads (of `about`, if
/// given).
void add_tail_columns(View&, const Pick& pick, const Pick& about = {});
/// The tables of a view that have rows and values; none if no run belongs to it.
std::vector<ViewTable> tables_of(const View&, const RunTable&);
/// All views, in the order of report.md.
const std::vector<View>& views();
/// A criterion's limit in the scene of a run, and the value that the run reached, with units.
std::string expected_of(const Row&, const std::string& criterion);
Cell found_of(const Row&, const std::string& criterion);
/// Contact offset [mm] of these runs, "3.5 to 20" if they differ; empty without colliders.
Cell offset_of(const Group&);
ViewColumn offset_column();
/// "S01 stiffness" for a scene with stability rules.
std::string case_of(const Row&);
/// 0 stable, 1 degraded, 2 failed; -1 if there are no stability rules, the scene is unsupported or the run is missing.
int grade_of(const Row&);

/// Work of a frame of the same runs on several devices.
View devices();
/// For the map of a claim: kind, iterations, substeps, dispatches per frame; `claim`: "holds", "near" (one criterion is
/// violated) or "fails".
nlohmann::json claim_fields(const Row&);
/// Table 4: features by solver, from the environments of these runs (describe_features); "not built" for a solver that
/// a build lacks.
View feature_view();

// Parts of views(), one per source file.
std::vector<View> overview_views(), rate_views(), contact_views(), reproduction_views(), accuracy_views();

}  // namespace clothbench
