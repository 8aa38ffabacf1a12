#pragma once
#include <string>
#include <vector>

#include "clothbench/record.hpp"
#include "report/grid.hpp"

namespace clothbench {

/// Shown in a table in place of a value that must not be printed.
inline constexpr const char* kNotPrinted = "–";

/// Whether a summary value is a time, or a rate computed from a time.
bool is_time(const std::string& summary_name);

/// Greatest number of concurrent clothbench jobs while the run was loaded and timed; NaN if its file does not tell.
double jobs_of(const RunRecord&);

/// Removes the times (trials and summary) of runs that were not timed alone, and stores the reason in `withheld`.
void withhold_times(std::vector<RunRecord>&);

/// A sentence for a table's note: why some of the runs show "–" for these summary values. Empty if nothing is withheld.
std::string withheld_note(const std::vector<const RunRecord*>&, const std::vector<std::string>& summary_names);

/// `note` followed by that sentence.
std::string with_withheld(const std::string& note, const std::vector<const RunRecord*>&,
                          const std::vector<std::string>& summary_names);

/// Why one run has no value for these names; reasons separated by "; ".
std::string withheld_of(const RunRecord&, const std::vector<std::string>& summary_names);

/// A column for each of these summary values, and one for the reasons why values are withheld.
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

/// Lines for a report's head: how many runs' times and which metrics are not printed, and why; how many runs do not
/// tell whether they were timed alone. For runs that `withhold` has processed.
std::vector<std::string> withheld_lines(const std::vector<RunRecord>&);

}  // namespace clothbench
