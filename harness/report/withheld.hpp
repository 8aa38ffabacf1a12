#pragma once
#include <string>
#include <vector>

#include "clothbench/record.hpp"
#include "report/grid.hpp"

namespace clothbench {

/// What a table shows in place of a value that is not printed.
inline constexpr const char* kNotPrinted = "–";

/// Whether a summary value is a time, or a rate by it.
bool is_time(const std::string& summary_name);

/// The most clothbench jobs that ran side by side while the run was loaded and timed; NaN where its file doesn't say.
double jobs_of(const RunRecord&);

/// Takes the times out of runs that were not timed alone, trials and summary, and says why in `withheld`.
void withhold_times(std::vector<RunRecord>&);

/// Takes out of the runs what was measured by an older version of a metric's rule than this program's, or than the
/// newest among them: series, summary values computed from them, what came of bounds on these; and says why in
/// `withheld`.
void withhold_old_versions(std::vector<RunRecord>&);

/// Both: what every report is made of.
void withhold(std::vector<RunRecord>&);

/// Why some of the runs show "–" for these summary values, a sentence for a table's note; empty where nothing is
/// withheld.
std::string withheld_note(const std::vector<const RunRecord*>&, const std::vector<std::string>& summary_names);

/// `note` and that sentence.
std::string with_withheld(const std::string& note, const std::vector<const RunRecord*>&,
                          const std::vector<std::string>& summary_names);

/// Reasons of one run, for these summary values; "; " between them.
std::string withheld_of(const RunRecord&, const std::vector<std::string>& summary_names);

/// A column each of these summary values, and one of why some are not there.
template <class Record>
Columns<Record> summary_columns(const std::vector<std::string>& names) {
  Columns<Record> out;
  for (const std::string& name : names) out.push_back({name, In::Both, summary(name)});
  out.push_back({"withheld", In::Both, [names](const auto& r) {
                   const std::string why = withheld_of(run_of(r), names);
                   return why.empty() ? absent() : Value(why);
                 }});
  return out;
}

/// Lines for a report's head: how many runs' times, and which metrics, are not printed and why; how many runs don't
/// say whether they were timed alone. Of runs that `withhold` has seen.
std::vector<std::string> withheld_lines(const std::vector<RunRecord>&);

}  // namespace clothbench
