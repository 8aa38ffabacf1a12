#include "report/report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <set>
#include <utility>

#include "clothbench/error.hpp"
#include "metrics/registry.hpp"
#include "report/across_runs.hpp"
#include "report/contact_pairs.hpp"
#include "report/contact_rates.hpp"
#include "report/feature_cost.hpp"
#include "report/features.hpp"
#include "report/friction.hpp"
#include "report/leak.hpp"
#include "report/material.hpp"
#include "report/mesh_grid.hpp"
#include "report/metamorphic.hpp"
#include "report/paths.hpp"
#include "report/penetration.hpp"
#include "report/pictures.hpp"
#include "report/plugin_marks.hpp"
#include "report/pulled_strip.hpp"
#include "report/stability.hpp"
#include "report/web/page.hpp"
#include "report/withheld.hpp"
#include "report/work_precision.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kBandwidthNames = {"read_B_per_frame", "write_B_per_frame",
                                                  "bandwidth_read_peak_B_per_s", "bandwidth_write_peak_B_per_s",
                                                  "bandwidth_window_s"};
const std::vector<std::string> kMemoryNames = {"device_memory_B", "dispatches", "load_s"};

/// All runs, without values that must not be printed.
std::vector<RunRecord> printable(const std::vector<fs::path>& results) {
  std::vector<RunRecord> runs = collect(results);
  withhold_times(runs);
  return runs;
}

/// Copies of the runs, by the section that reports them.
struct Parts {
  std::vector<RunRecord> stability, drawn, contact, truth, rest;
};

/// Leaves out runs with separate tables: comparisons of feature costs (by address), effective moduli, friction,
/// metamorphic properties.
Parts parts_of(const std::vector<RunRecord>& runs, const std::vector<RunPair>& costs) {
  Parts out;
  std::set<const RunRecord*> reported;
  for (const RunPair& p : costs) reported.insert({p.run, p.other});
  std::set<std::string> timed;
  for (const RunRecord& c : runs)
    if (summary_value(c, "frame_wall_median_s") > 0) timed.insert(c.header.scenario_json);
  for (const RunRecord& c : runs) {
    if (reported.contains(&c) || is_moduli_run(c) || is_all_on(c) || is_friction(c) || is_metamorphic(c)) continue;
    // Of a scene that has not been run only the name is known; the table of runs without a result lists it.
    if (c.outcome.status == "missing" && c.header.scenario_json.empty()) continue;
    // Where no solver was timed on a pulled strip, its errors are tabulated by speed instead of by time.
    const bool by_time = has_truth(c) && !(set_up_of(c) == "wave" && !timed.contains(c.header.scenario_json));
    (is_stability(c)       ? out.stability
     : is_drawn_contact(c) ? out.drawn
     : by_time             ? out.truth
     : has_contact(c)      ? out.contact
                           : out.rest)
        .push_back(c);
  }
  return out;
}

/// Data of the runs for the sections of a report. Its members point to each other, so it must not be copied or moved.
struct Facts {
  const std::vector<fs::path>& results;
  std::vector<RunRecord> runs = printable(results);
  std::vector<RunPair> costs = feature_costs(runs);
  std::vector<SolverMaterial> materials = solver_materials(runs);
  Parts parts = parts_of(runs, costs);
  nlohmann::json maps = stability_maps(results), published = published_table3();
  std::vector<Family> rates = families(parts.rest);
  std::vector<ContactSetUp> ups = set_ups(parts.contact);
  std::vector<RunPair> rooms = run_pairs(parts.contact, "whole-room");
  std::vector<RunPair> turned = turned_pairs(ups);
  std::vector<WorkDiagram> diagrams = work_diagrams(parts.truth, materials);
  PluginMarks marks{runs};
};

/// A section of report.md and of the page, and the files written beside it.
struct Section : PageSection {
  std::string markdown = {};  ///< file with only its tables; none if empty
  std::vector<std::pair<const char*, std::function<std::string()>>> files = {};
};
using Sections = std::vector<Section>;

std::string text_of(const nlohmann::json& j) { return j.dump(1) + "\n"; }

std::string markdown_of(const std::vector<Table>& tables) {
  std::string out;
  for (const Table& t : tables) out += t.markdown() + "\n";
  return out;
}

/// The tables that have rows.
std::vector<Table> filled(std::vector<Table> tables) {
  std::erase_if(tables, [](const Table& t) { return t.rows.size() <= 1; });
  return tables;
}

Table in_full(Table t) {
  t.in_full = true;
  return t;
}

Sections rates_sections(const Facts& f) {
  Sections out;
  bool wrote = false;
  for (const Family& family : f.rates) {
    const bool paper = family.paper_table == 3;
    out.push_back({{"rates", paper ? "Table 3" : "Rates: " + family.name, fps_tables(family, f.published)}});
    if (!paper || std::exchange(wrote, true)) continue;
    out.back().markdown = "table3.md";
    out.back().files = {{"table3.csv", [&] { return table3_csv(family, f.published); }},
                        {"table3.json", [&] { return text_of(table3_json(family, f.published)); }}};
  }
  return out;
}

Sections mesh_section(const Facts& f) {
  const auto rows = meshes_beside_grids(f.parts.rest);
  if (rows.empty()) return {};
  return {{{"rates", "Meshes beside grids", {mesh_grid_table(rows)}}, "", {{"mesh-grid.csv", [rows] {
                                                                              return mesh_grid_csv(rows);
                                                                            }}}}};
}

Sections sampled_section(const Facts& f) {
  const auto tables = filled({sampled_table(f.runs)});
  if (tables.empty()) return {};
  return {{{"sampled", "The device's own counters", tables}, "", {{"device-samples.csv", [&] {
                                                                     return summary_csv(f.runs, sampled_names());
                                                                   }}}}};
}

std::vector<Table> penetration_tables(const Facts& f) {
  std::vector<Table> out = {verdict_table(f.ups)};
  for (Table& t : filled({leak_table(speed_sweeps(f.ups)), pulled_strip_table(f.ups),
                          popping_table(popping_pairs(f.ups)), turned_table(f.turned)}))
    out.push_back(std::move(t));
  for (const ContactSetUp& u : f.ups) {
    out.push_back(contact_table(u));
    if (Table costs = cost_table(u); costs.rows.front().size() > 3) out.push_back(in_full(std::move(costs)));
  }
  for (Table& t : filled({failed_expectations_table(f.ups), room_table(f.rooms)})) out.push_back(std::move(t));
  return out;
}

Sections penetration_section(const Facts& f) {
  if (f.ups.empty()) return {};
  const auto all = [&] {
    return text_of({{"runs", penetration_json(f.ups)},
                    {"rooms", room_json(f.rooms)},
                    {"failure_speeds", leak_json(speed_sweeps(f.ups))},
                    {"pulled_strip", pulled_strip_json(f.ups)},
                    {"popping", popping_json(popping_pairs(f.ups))},
                    {"turned", turned_json(f.turned)}});
  };
  return {{{"penetration", "Penetration", penetration_tables(f)},
           "penetration.md",
           {{"penetration.csv", [&] { return summary_csv(f.parts.contact, penetration_columns()); }},
            {"penetration.json", all},
            {"penetration-series.csv", [&] { return series_csv(f.ups); }}}}};
}

Sections drawn_section(const Facts& f) {
  const std::vector<RunRecord>& runs = f.parts.drawn;
  if (runs.empty()) return {};
  return {{{"contact-rates", "Drawn contact scenes",
            filled({contact_rate_table(runs), worst_contact_table(worst_contacts(runs))})},
           "contact-rates.md",
           {{"contact-rates.csv", [&] { return contact_rates_csv(runs); }},
            {"contact-rates.json", [&] { return text_of(contact_rates_json(runs)); }},
            {"contact-runs.csv", [&] { return summary_csv(runs, penetration_columns()); }}}}};
}

Sections work_section(const Facts& f) {
  if (f.diagrams.empty()) return {};
  return {{{"work-precision",
            "Error against run time",
            {work_table(f.diagrams), budget_table(f.diagrams), energy_table(f.diagrams), truth_table(f.diagrams)}},
           "work-precision.md",
           {{"work-precision.csv", [&] { return work_csv(f.diagrams); }},
            {"work-precision.json", [&] { return text_of(work_json(f.diagrams)); }}}}};
}

Sections winners_section(const Facts& f) {
  if (f.diagrams.empty()) return {};
  return {{{"", "", {winners_table(f.diagrams), ranks_table(f.diagrams)}}}};
}

Sections stability_section(const Facts& f) {
  const std::vector<RunRecord>& runs = f.parts.stability;
  if (runs.empty() && f.maps.empty()) return {};
  std::vector<Table> tables;
  if (!runs.empty()) tables.push_back(robustness_table(runs));
  for (Table& t : filled({across_table(across_runs(runs))})) tables.push_back(std::move(t));
  if (!f.maps.empty()) tables.insert(tables.end(), {headline_table(f.maps), in_full(boundary_table(f.maps))});
  for (Table& t : filled({in_full(first_failure_table(runs))})) tables.push_back(std::move(t));
  const nlohmann::json maps = {{"format", "clothbench-stability"}, {"format_version", 1}, {"maps", f.maps}};
  return {{{"stability", "Stability", tables},
           "stability.md",
           {{"stability.csv", [&] { return stability_csv(runs); }},
            {"stability-across.csv", [&] { return across_csv(across_runs(runs)); }},
            {"stability.json", [maps] { return text_of(maps); }}}}};
}

Sections material_section(const Facts& f) {
  if (f.materials.empty()) return {};
  return {{{"material", "Effective moduli", {material_table(f.materials), material_verdicts(f.materials)}},
           "material.md",
           {{"material.json", [&] { return text_of(material_json(f.materials)); }}}}};
}

Sections friction_section(const Facts& f) {
  std::vector<Table> tables = friction_tables(f.runs);
  if (tables.empty()) return {};
  return {{{"friction", "Friction", std::move(tables)}, "friction.md", {{"friction.json", [&] {
                                                                           return text_of(friction_json(f.runs));
                                                                         }}}}};
}

Sections metamorphic_section(const Facts& f) {
  std::vector<Table> tables = metamorphic_tables(f.runs);
  if (tables.empty()) return {};
  return {{{"metamorphic", "Metamorphic properties", std::move(tables)},
           "metamorphic.md",
           {{"metamorphic.json", [&] { return text_of(metamorphic_json(f.runs)); }}}}};
}

Sections cost_section(const Facts& f) {
  if (f.costs.empty()) return {};
  return {{{"feature-cost", "Feature cost", {feature_cost_table(f.costs), no_op_table(f.costs)}},
           "feature-cost.md",
           {{"feature-cost.csv", [&] { return feature_cost_csv(f.costs); }},
            {"feature-cost.json", [&] { return text_of(feature_cost_json(f.costs)); }}}}};
}

Sections features_section(const Facts& f) {
  const auto solvers = solver_features(f.runs);
  if (std::none_of(solvers.begin(), solvers.end(), [](const SolverFeatures& s) { return s.known; })) return {};
  const Table table = feature_table(solvers, true);
  return {{{"features", "Features", {f.parts.contact.empty() ? in_full(table) : table}},
           "",
           {{"features.json", [solvers] { return text_of(feature_json(solvers, true)); }}}}};
}

Sections failed_section(const Facts& f) {
  std::vector<RunRecord> runs = f.runs;
  // Other tables report the failures of these.
  std::erase_if(runs, [](const RunRecord& c) { return is_stability(c) || is_drawn_contact(c); });
  Sections out;
  for (Section s : {Section{{"failed", "Runs without a result", filled({failed_table(runs)})}},
                    Section{{"expect", "Expectations", filled({expect_table(runs)})}}})
    if (!s.tables.empty()) out.push_back(std::move(s));
  return out;
}

/// Sections in the order of report.md and the page, and of the terminal.
constexpr Sections (*kInReport[])(const Facts&) = {
    rates_sections, mesh_section,      sampled_section,  penetration_section, drawn_section,
    work_section,   stability_section, material_section, friction_section,    metamorphic_section,
    cost_section,   features_section,  failed_section};
constexpr Sections (*kOnTerminal[])(const Facts&) = {
    rates_sections, mesh_section,     sampled_section,  penetration_section, drawn_section,
    work_section,   winners_section,  material_section, friction_section,    metamorphic_section,
    cost_section,   features_section, stability_section};

/// One page: ranks, best solvers, whether stiffness is a parameter of each solver, irrelevant features with an effect.
std::string summary_page(const Facts& f) {
  std::vector<Table> tables = {ranks_table(f.diagrams), winners_table(f.diagrams)};
  if (!f.materials.empty()) tables.push_back(material_verdicts(f.materials));
  if (!f.costs.empty()) tables.push_back(no_op_table(f.costs));
  return markdown_of(f.marks.tables(tables));
}

/// The sections with their plugins marked.
Sections marked(Sections (*sections)(const Facts&), const Facts& f) {
  Sections out = sections(f);
  for (Section& s : out) s.tables = f.marks.tables(std::move(s.tables));
  return out;
}

/// Parts of the page other than the sections.
Page page_of(const Facts& f, const std::string& head) {
  Page page;
  page.headline = head;
  page.rates = f.marks.data(rates_json(f.rates, f.published));
  page.penetration = f.marks.data(contact_series_json(f.ups));
  page.work = f.marks.data(work_json(f.diagrams));
  page.maps = f.marks.data(f.maps);
  page.cases = f.marks.data(stability_cases(f.parts.stability));
  page.commands = commands_of(f.results);
  for (const WorkDiagram& d : f.diagrams)
    for (const WorkPoint& p : d.points)
      if (p.on_front) page.fronts.insert(p.run->file);
  return page;
}

}  // namespace

nlohmann::json published_table3() { return nlohmann::json::parse(kPublishedTable3); }

void write_report(const std::vector<fs::path>& results, const ReportOptions& options) {
  const Facts f{results};
  const auto write = [&](const std::string& name, const std::string& text) {
    write_file_atomically(options.out / name, text);
  };
  std::error_code error;
  fs::create_directories(options.out, error);
  if (error) throw Error(options.out.string() + ": cannot be made a folder: " + error.message());
  write("runs.csv", runs_csv(f.runs));
  write("runs.json", text_of(runs_json(f.runs)));
  write("bandwidth.csv", summary_csv(f.runs, kBandwidthNames));
  write("memory.csv", summary_csv(f.runs, kMemoryNames));
  const std::string head = headline(f.runs, Format::Markdown);
  Page page = page_of(f, head);
  std::string all, latex = "% Tables of this report for LaTeX; \\usepackage{booktabs}.\n";
  for (const auto sections : kInReport)
    for (const Section& s : marked(sections, f)) {
      const std::string text = markdown_of(s.tables);
      all += text;
      for (const Table& t : s.tables) latex += "\n" + t.latex();
      if (!s.markdown.empty()) write(s.markdown, "# " + s.title + "\n\n" + head + "\n" + text);
      for (const auto& [name, content] : s.files) write(name, content());
      page.sections.push_back(s);
    }
  write("tables.tex", latex);
  if (!f.diagrams.empty()) {
    write("summary.md", "# Summary\n\n" + head + "\n" + summary_page(f));
    page.sections.push_back(
        {"summary", "Summary", f.marks.tables({ranks_table(f.diagrams), winners_table(f.diagrams)})});
  }
  page.sections.push_back({"environment", "Environment", f.marks.tables({environment_table(f.runs)})});
  const PageTemplate with = page_template();
  const std::string no_page = write_page(options.out, f.runs, page, with);
  const auto [no_figures, figures] = draw_pictures(options.out, with);
  for (const std::string& why : {no_page, no_figures})
    if (!why.empty()) fmt::print(stderr, "{}\n", why);
  write("report.md",
        "# clothbench report\n\n" + head + "\n" + all + (figures.empty() ? "" : "### Figures\n\n" + figures) +
            (no_figures.empty() ? "" : no_figures + "\n\n") +
            (no_page.empty() ? "`index.html` shows all of this interactively, with the motions. " : no_page + "\n\n") +
            "`runs.csv` and `runs.json` hold every summary value of every run in full precision.\n");
}

void print_console_report(const std::vector<fs::path>& results) {
  const Facts f{results};
  fmt::print("{}", headline(f.runs, Format::Console));
  for (const auto sections : kOnTerminal)
    for (const Section& s : marked(sections, f))
      for (const Table& t : s.tables)
        if (!t.in_full) fmt::print("{}", t.console());
  for (const Section& s : marked(failed_section, f)) {
    const Table& t = s.tables[0];
    fmt::print("\n{}{}\n", t.title, t.note.empty() ? "" : " (" + t.note.substr(0, t.note.size() - 1) + ")");
    for (std::size_t r = 1; r < t.rows.size(); ++r)  // messages are sentences and are printed as lines, not columns
      fmt::print("{}", wrapped(fmt::format("{}", fmt::join(t.rows[r], ": ")), 2, kConsoleColumns));
  }
}

}  // namespace clothbench
