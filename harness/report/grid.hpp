#pragma once
#include <algorithm>
#include <functional>
#include <map>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/columns.hpp"
#include "base/words.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// A summary value of a run; NaN if the run does not have it.
double summary_value(const RunRecord&, const std::string& name);

/// The scenario of a run; a discarded value if the stored text is not JSON.
nlohmann::json scenario_of(const RunRecord&);

/// What the environment says of `key`; null if it says nothing.
nlohmann::json environment_of(const RunRecord&, const char* key);

/// Whether the scenario has this block, as the protocol that made the run writes it: "stability", "drawn",
/// "metamorphic", "effective_moduli", "irrelevant".
bool has_block(const RunRecord&, const char* name);

/// Name in the scenario's file, without the labels of axes.
std::string base_name(const RunRecord&);

/// Each value of `of(item)` once, in the order of first appearance.
template <class Items, class Of>
auto distinct(const Items& items, Of of) {
  std::vector<std::decay_t<std::invoke_result_t<Of, decltype(*std::begin(items))>>> out;
  for (const auto& item : items)
    if (auto value = std::invoke(of, item); !contains(out, value)) out.push_back(std::move(value));
  return out;
}

/// The run that a record of a table is about.
inline const RunRecord& run_of(const RunRecord& c) { return c; }
template <class Record>
const RunRecord& run_of(const Record& r) {
  return *r.run;
}

/// The runs that the records point to; `of`: the members that point to a run.
template <class Records, class... Of>
std::vector<const RunRecord*> runs_of(const Records& records, Of... of) {
  std::vector<const RunRecord*> out;
  for (const auto& r : records) (out.push_back(std::invoke(of, r)), ...);
  return out;
}

/// Values of columns over records that run_of accepts (base/columns.hpp).
inline auto summary(const std::string& name) {
  return [name](const auto& r) -> Value { return summary_value(run_of(r), name); };
}
inline constexpr auto status_of = [](const auto& r) -> Value { return run_of(r).outcome.status; };
inline constexpr auto failed_frame_of = [](const auto& r) -> Value {
  return run_of(r).outcome.failed_frame < 0 ? absent() : Value(run_of(r).outcome.failed_frame);
};

/// A row of a pivot that has text alone: its name, what else stands before the pivot, and its cells by column.
struct TextRow {
  std::string name;
  std::vector<std::string> more = {};
  std::map<std::string, std::string> cells = {};
};
Columns<TextRow> text_columns(const std::vector<std::string>& heads, const std::vector<std::string>& across);

/// Mean wall time of a frame in each trial [s], ascending.
std::vector<double> trial_means(const RunRecord&);

/// " (first 36 frames)" where a run timed fewer frames than another of the same scene, whose time is then of other
/// frames too; empty if it timed as many. `all`: the runs that stand beside it.
std::string frames_mark(const RunRecord&, const std::vector<const RunRecord*>& all);

/// Without columns that show "–" alone.
Table without_empty_columns(Table);

/// The median of a sorted, non-empty list.
double middle(const std::vector<double>& sorted);

/// The first item for which `is` holds; if there is none, appends `fresh` and returns it.
template <class Item, class Is>
Item& find_or_add(std::vector<Item>& items, Is is, Item fresh) {
  const auto at = std::find_if(items.begin(), items.end(), is);
  return at == items.end() ? items.emplace_back(std::move(fresh)) : *at;
}

/// "diverged at 12" (the failed frame), or the status alone if no frame failed.
std::string ending(const Outcome&);

/// "diverged (F1)"; the status alone if it has no class.
std::string status_with_class(const Outcome&);

/// "–" for an empty text.
std::string or_dash(const std::string&);

/// Column of a table: cloth resolution. `grid` is {0, 0} for a cloth that is not a grid.
struct Resolution {
  int grid[2] = {0, 0};
  std::uint32_t vertices = 0;  ///< of a cloth that is not a grid; 0 otherwise
  std::string label() const;   ///< "32²", "9×7", "1234 vertices", "–"
  auto operator<=>(const Resolution&) const = default;
};

/// Row of a table.
struct Series {
  std::string solver, setting, sides;
  int repeat = 1;  ///< 2, 3, ... where several files hold the same run
  std::string label() const;
  bool operator==(const Series&) const = default;
  // Not <=>: strings have none yet in the libc++ of Android's NDK r25.
  bool operator<(const Series& o) const {
    return std::tie(solver, setting, sides, repeat) < std::tie(o.solver, o.setting, o.sides, o.repeat);
  }
};

/// "xpbd substeps=4": the solver, and the setting if it is not the default.
std::string label_of(const RunRecord&);

/// A run with its row and column in a table. Points into the vector it was made from.
struct PlacedRun {
  const RunRecord* run = nullptr;
  Resolution resolution;
  Series series;
};

/// Runs whose scenes differ only in resolution and sides. One set of tables shows one family.
class Family {
 public:
  std::string name;             ///< of the scene; with " (2)" if another family has the same name
  int paper_table = 0;          ///< number of the paper's table that the scene names; 0: none
  std::vector<PlacedRun> runs;  ///< in the order given

  std::vector<Resolution> resolutions() const;  ///< ascending
  std::vector<Series> series() const;           ///< by solver and setting; single, double-duplicated, double
  const RunRecord* find(const Series&, const Resolution&) const;

  /// `text` of a run that ended well, else its ending; empty without a run.
  std::string cell(const Series&, const Resolution&, const std::function<std::string(const RunRecord&)>& text) const;

  /// Rows: series; columns: resolutions. If a run did not end well, its ending replaces `text`.
  Table table(const std::string& title, const std::string& note,
              const std::function<std::string(const RunRecord&)>& text) const;
};

/// Sorts runs into families by their scenes, in the order of first appearance. Runs without a readable scene form a
/// family per scene name, without resolution. `runs` must outlive the result.
std::vector<Family> families(const std::vector<RunRecord>& runs);

}  // namespace clothbench
