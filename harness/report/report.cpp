#include "report/report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/files.hpp"
#include "clothbench/error.hpp"
#include "report/features.hpp"
#include "report/verdict.hpp"
#include "report/view.hpp"
#include "report/web/page.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

std::vector<RunRecord> printable(const std::vector<fs::path>& results) {
  std::vector<RunRecord> runs = collect(results);
  withhold_times(runs);
  return runs;
}

/// The table of features is no view: its rows are features, not runs.
Table features_of(const RunTable& table) {
  const auto solvers = solver_features(table.runs());
  if (std::none_of(solvers.begin(), solvers.end(), [](const SolverFeatures& s) { return s.known; })) return {};
  Table t = feature_table(solvers, true);
  t.in_full = true;
  return t;
}

/// The sections that have tables.
std::vector<PageSection> filled_sections(const RunTable& table) {
  std::vector<PageSection> out;
  for (const Section& s : sections()) {
    PageSection section{s.id, s.title, {}};
    for (const View& v : views())
      if (v.section == s.id)
        for (Table& t : tables_of(v, table)) section.tables.push_back(std::move(t));
    if (section.id == "features")
      if (Table t = features_of(table); !t.rows.empty()) section.tables.push_back(std::move(t));
    if (!section.tables.empty()) out.push_back(std::move(section));
  }
  return out;
}

std::string verdict_line(const std::vector<RunRecord>& runs) {
  const VerdictCounts n = count_verdicts(runs);
  return n.runs == 0 ? "" : n.text() + ", of those whose scene has acceptance criteria.\n";
}

}  // namespace

void write_report(const std::vector<fs::path>& results, const ReportOptions& options) {
  const RunTable table(printable(results));
  const auto write = [&](const std::string& name, const std::string& text) {
    write_file_atomically(options.out / name, text);
  };
  std::error_code error;
  fs::create_directories(options.out, error);
  if (error) throw Error(options.out.string() + ": cannot be made a folder: " + error.message());
  write("runs.csv", runs_csv(table));
  write("runs.json", runs_json(table.runs()).dump(1) + "\n");
  write("series.csv", series_csv(table));
  write("trials.csv", trials_csv(table));
  const std::string head = headline(table.runs(), Format::Markdown) + verdict_line(table.runs());
  const Page page{head, filled_sections(table), commands_of(results)};
  std::string all, latex = "% Tables of this report for LaTeX; \\usepackage{booktabs}.\n";
  for (const PageSection& s : page.sections) {
    all += "## " + s.title + "\n\n";
    for (const Table& t : s.tables) {
      all += t.markdown() + "\n";
      latex += "\n" + t.latex();
    }
  }
  write("tables.tex", latex);
  const PageTemplate with = page_template();
  const std::string no_page = write_page(options.out, table, page, with);
  const auto [no_figures, figures] = draw_pictures(options.out, with);
  for (const std::string& why : {no_page, no_figures})
    if (!why.empty()) fmt::print(stderr, "{}\n", why);
  write("report.md",
        "# clothbench report\n\n" + head + "\n" + all + (figures.empty() ? "" : "## Figures\n\n" + figures) +
            (no_figures.empty() ? "" : no_figures + "\n\n") +
            (no_page.empty() ? "`index.html` shows all of this interactively, with the motions. " : no_page + "\n\n") +
            "`runs.csv` and `runs.json` hold every summary value of every run in full precision, `series.csv` the "
            "metrics by frame, `trials.csv` the timed trials.\n");
}

void print_console_report(const std::vector<fs::path>& results) {
  const RunTable table(printable(results));
  fmt::print("{}{}", headline(table.runs(), Format::Console), verdict_line(table.runs()));
  for (const PageSection& s : filled_sections(table))
    for (const Table& t : s.tables) {
      if (t.in_full) continue;
      if (s.id != "failed") {
        fmt::print("{}", t.console());
        continue;
      }
      fmt::print("\n{}\n", t.title);
      for (std::size_t r = 1; r < t.rows.size(); ++r)  // messages are sentences and are printed as lines, not columns
        fmt::print("{}", wrapped(fmt::format("{}", fmt::join(t.rows[r], ": ")), 2, kConsoleColumns));
    }
}

}  // namespace clothbench
