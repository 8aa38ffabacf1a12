#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/table.hpp"
#include "report/run_table.hpp"

namespace clothbench {

struct ReportOptions {
  std::filesystem::path out;
};

/// All runs of study folders, or result files, without trajectories. Planned runs without a file have the
/// status "missing". Throws Error naming the file that cannot be read.
std::vector<RunRecord> collect(const std::vector<std::filesystem::path>& results);

/// Maximum number of concurrent clothbench jobs while the run was loaded and timed; NaN if its file does not state it.
double jobs_of(const RunRecord&);

/// Removes the times (trials and summary) of runs that were not timed alone, and stores the reason in `withheld`.
void withhold_times(std::vector<RunRecord>&);

/// A sentence for the note of a table of times: why some of the runs show "–". Empty if no time is withheld.
std::string withheld_note(const std::vector<const Row*>&);

enum class Format { Markdown, Console };

/// Head of a report: whether the device is software; whose times are withheld; device, protocol and commit, one line
/// for each combination among the runs; the plugins; the overhead of the harness.
std::string headline(const std::vector<RunRecord>& runs, Format);

/// Sentences about the whole report: a software device, measurements that are not valid, withheld times.
std::vector<std::string> warnings_of(const std::vector<RunRecord>& runs);

/// The ballistic solver's slowest run as a percentage of a 72 Hz frame, against the 1 % allowed; empty without one.
std::string overhead_line(const std::vector<RunRecord>& runs);

/// One row per run, the fastest of each scene first: ending, stretch, frame times, ratio to time_baseline(). Runs that
/// failed, or whose cloth is stretched to more than twice its length, follow without a rank.
Table in_short_table(const std::vector<RunRecord>& runs);

/// One row per run with every summary value, as the shortest text that reads back exactly; missing = empty.
std::string runs_csv(const RunTable&);
/// Everything except frames: outcome, summary (missing = null), environment.
nlohmann::json runs_json(const std::vector<RunRecord>& runs);
/// The plotted metrics of runs with contact, one row per frame, six digits; missing = empty.
std::string series_csv(const RunTable&);
/// One row per timed trial: frames, mean, percentiles and maximum of the frame times.
std::string trials_csv(const RunTable&);

/// Writes report.md, tables.tex, runs.csv, runs.json, series.csv and trials.csv into `out`; also the page index.html if
/// this was built with Node, and its figures as pictures (draw_pictures) if Node is installed; otherwise a line that
/// states the reason. Throws Error if a file cannot be read or written.
void write_report(const std::vector<std::filesystem::path>& results, const ReportOptions&);

/// Head, failures and the first two tables on the terminal, and where the rest is.
void print_console_report(const std::vector<std::filesystem::path>& results);

}  // namespace clothbench
