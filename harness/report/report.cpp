#include "report/report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <sstream>

#include "base/files.hpp"
#include "report/view.hpp"
#include "report/web/page.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::pair<const char*, const char*> kSections[] = {
    {"overview", "Overview"},      {"rates", "Frame rates"},
    {"contact", "Verdicts"},       {"accuracy", "Error against run time"},
    {"stability", "Stability"},    {"time", "Frame times"},
    {"failed", "Failures"},        {"features", "Features"},
    {"environment", "Environment"}};

std::vector<PageSection> filled_sections(const RunTable& table) {
  std::vector<PageSection> out;
  for (const auto& [id, title] : kSections) {
    PageSection section{id, title, {}};
    for (const View& v : views())
      if (v.section == id)
        for (ViewTable& t : tables_of(v, table)) section.tables.push_back(std::move(t));
    if (!section.tables.empty()) out.push_back(std::move(section));
  }
  return out;
}

/// Names of the studies of the results, without repetition.
std::vector<std::string> names_of(const std::vector<fs::path>& results) {
  std::vector<std::string> out;
  for (const fs::path& result : results)
    if (fs::exists(result / "study.json"))
      if (std::string name = read_manifest(result).study; !name.empty()) {
        if (name == "run") name = fs::absolute(result).lexically_normal().filename().string();
        if (!contains(out, name)) out.push_back(std::move(name));
      }
  return out;
}

/// The lines of a log of `check --log`.
json history_of(const fs::path& file) {
  json out = json::array();
  if (file.empty()) return out;
  std::istringstream lines(read_text(file));
  for (std::string line; std::getline(lines, line);) {
    const std::string where = fmt::format("{}:{}", file.string(), out.size() + 1);
    out.push_back(parse_json(line, where));
    for (const char* key : {"commit", "created", "runs"})
      if (!out.back().is_object() || !out.back().contains(key))
        throw Error(fmt::format("{}: no `{}`; expected a line that `clothbench check --log` wrote", where, key));
  }
  return out;
}

Page page_of(const RunTable& table, const std::vector<fs::path>& results, const fs::path& history = {}) {
  return {heading_of(table, names_of(results)),
          warnings_of(table),
          tiles_of(table),
          notes_of(table),
          filled_sections(table),
          history_of(history)};
}

std::string facts_of(const Heading& h) {
  return joined(h.facts, " · ", [](const auto& f) { return f.first + " " + f.second; });
}

/// The part of report.md above its tables.
std::string head_markdown(const Page& page) {
  std::string out = "# " + page.heading.title + "\n\n";
  for (const std::string& w : page.warnings) out += "**" + w + "**\n\n";
  out += facts_of(page.heading) + "\n\n";
  for (const std::string& n : page.notes) out += n + "\n\n";
  for (const Tile& t : page.tiles)
    out += fmt::format("- {}, {}: **{}**{}{}{}{}{}\n", t.title, t.entries[0].label, t.entries[0].value,
                       in_brackets(t.entries[0].about), t.entries.size() > 1 ? "; " : "", t.others(),
                       t.left_out.empty() ? "" : "; ", t.left_out);
  return out + (page.tiles.empty() ? "" : "\n");
}

}  // namespace

std::string withheld_note(const std::vector<const Row*>& rows) {
  double most = 1;
  std::size_t count = 0;
  for (const Row* r : rows) {
    if (r->run->withheld.empty()) continue;
    ++count;
    most = std::max(most, jobs_of(*r->run));
  }
  return count == 0 ? ""
                    : fmt::format("Times of {} run{} are withheld (–) because up to {:.0f} jobs ran side by side.",
                                  count, count == 1 ? "" : "s", most);
}

void write_report(const std::vector<fs::path>& results, const fs::path& out, const fs::path& history) {
  const RunTable table(withhold_times(collect(results)));
  const auto write = [&](const std::string& name, const std::string& text) { write_file_atomically(out / name, text); };
  fs::create_directories(out);
  write("runs.csv", runs_csv(table));
  write("runs.json", dump(runs_json(table.runs()), 1) + "\n");
  write("series.csv", series_csv(table));
  write("trials.csv", trials_csv(table));
  const Page page = page_of(table, results, history);
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
  const std::string no_page = write_page(out, table, page, with);
  const auto [no_figures, figures] = draw_pictures(out, with);
  for (const std::string& why : {no_page, no_figures})
    if (!why.empty()) fmt::print(stderr, "{}\n", why);
  write("report.md",
        head_markdown(page) + all + (figures.empty() ? "" : "## Figures\n\n" + figures) +
            (no_figures.empty() ? "" : no_figures + "\n\n") +
            (no_page.empty() ? "`index.html` shows all of this interactively, with the motions. " : no_page + "\n\n") +
            "`runs.csv` and `runs.json` hold every summary value of every run in full precision, `series.csv` the "
            "metrics by frame, `trials.csv` the timed trials.\n");
}

void print_console_report(const std::vector<fs::path>& results) {
  constexpr std::size_t kShown = 2, kFew = 24;
  const RunTable table(withhold_times(collect(results)));
  const Page page = page_of(table, results);
  for (const Texts& lines : {page.warnings, {facts_of(page.heading)}, page.notes})
    for (const std::string& line : lines) fmt::print("{}", wrapped(line, 0, console_columns()));
  std::size_t shown = 0, rest = 0;
  const bool few = table.runs().size() <= kFew;
  if (few)
    if (const Table t = in_short_table(table); !t.rows.empty() && ++shown > 0) fmt::print("{}", t.console());
  for (const PageSection& s : page.sections)
    for (const ViewTable& t : s.tables) {
      if (few && s.id == "overview") continue;  // its runs are in the table above
      // Messages are sentences: they are printed as lines, not columns. A failed run is always listed.
      if (s.id == "failed" && !t.in_full) {
        fmt::print("\n{}\n", t.title);
        for (std::size_t r = 1; r < t.rows.size(); ++r)
          fmt::print("{}", wrapped(fmt::format("{}", fmt::join(t.rows[r], ": ")), 2, console_columns()));
      } else if (!t.in_full && shown < kShown) {
        fmt::print("{}", t.console());
        ++shown;
      } else {
        ++rest;
      }
    }
  if (rest == 0) return;
  const std::string from = joined(results, " ", [](const fs::path& p) { return p.string(); });
  fmt::print("\n{}",
             wrapped(fmt::format("{} more tables, figures and motions: clothbench report {} -o report", rest, from), 0,
                     console_columns()));
}

}  // namespace clothbench
