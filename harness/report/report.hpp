#pragma once
#include <filesystem>

#include "base/table.hpp"
#include "report/run_table.hpp"

namespace clothbench {

/// A sentence for the note of a table of times: why some runs show "–". Empty if no time is withheld.
std::string withheld_note(const std::vector<const Row*>&);

/// A number on the first screen. `entries`: at least one, at most one per solver and setting, the best first.
struct Tile {
  struct Entry {
    std::string solver, label, value;
    std::string about;  ///< interval, or why there is none; trials
    double merit = 0;   ///< larger is better
  };
  std::string title;
  std::vector<Entry> entries;
  std::string left_out = {};  ///< number and names of solvers that are not ranked, with the reasons
  /// "paper 7166 (7100–7200, 5 trials) · …": all entries except the first.
  std::string others() const;
};

/// The first four tiles that have runs, in this order: generated contact, contact, error, rate, stability.
std::vector<Tile> tiles_of(const RunTable&);

/// Title of a report, and device, commit, date and trials as its runs state them.
struct Heading {
  std::string title;
  std::vector<std::pair<std::string, std::string>> facts;
};
Heading heading_of(const RunTable&, const std::vector<std::string>& studies);
/// Sentences on the whole report: a software device, invalid measurements, withheld times.
std::vector<std::string> warnings_of(const RunTable&);
/// Sentences about the plugins and the number of runs that passed.
std::vector<std::string> notes_of(const RunTable&);
/// One row per run: ending, stretch, frame times, ratio to time_baseline(), rank. No rows if there are no runs.
Table in_short_table(const RunTable&);
/// One row per run with every summary value, as the shortest text that reads back exactly; missing = empty.
std::string runs_csv(const RunTable&);
/// Everything except values per frame: outcome, summary (missing = null), environment.
nlohmann::json runs_json(const std::vector<RunRecord>& runs);
/// The plotted metrics of runs with contact, one row per frame, six digits; missing = empty.
std::string series_csv(const RunTable&);
/// One row per timed trial: frames, mean, percentiles and maximum of the frame times.
std::string trials_csv(const RunTable&);
/// Writes report.md, tables.tex, runs.csv, runs.json, series.csv and trials.csv into `out`. Writes the page index.html
/// if this program was built with Node, and its figures as images (draw_pictures) if Node is installed; otherwise
/// prints the reason. `history`: a log of `clothbench check --log`; empty: none. Throws Error if a file cannot be read
/// or written.
void write_report(const std::vector<std::filesystem::path>& results, const std::filesystem::path& out,
                  const std::filesystem::path& history = {});
/// Prints head, failures, two tables and the location of the rest on the terminal. With few runs, the first table has
/// one row per run.
void print_console_report(const std::vector<std::filesystem::path>& results);

}  // namespace clothbench
