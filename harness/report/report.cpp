#include "report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/data_folder.hpp"
#include "clothbench/error.hpp"
#include "metrics/registry.hpp"
#include "report/across_runs.hpp"
#include "report/feature_cost.hpp"
#include "report/features.hpp"
#include "report/leak.hpp"
#include "report/material.hpp"
#include "report/paths.hpp"
#include "report/penetration.hpp"
#include "report/pictures.hpp"
#include "report/popping.hpp"
#include "report/pulled_strip.hpp"
#include "report/room_pair.hpp"
#include "report/stability.hpp"
#include "report/turned.hpp"
#include "report/web/page.hpp"
#include "report/withheld.hpp"
#include "report/work_precision.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kBandwidthNames = {"read_B_per_frame",
                                                  "write_B_per_frame",
                                                  "bandwidth_read_peak_B_per_s",
                                                  "bandwidth_read_mean_B_per_s",
                                                  "bandwidth_write_peak_B_per_s",
                                                  "bandwidth_write_mean_B_per_s",
                                                  "bandwidth_window_s"};
const std::vector<std::string> kMemoryNames = {"device_memory_B", "dispatches", "load_s"};

/// All cells, without what must not be printed.
std::vector<CellRecord> printable(const std::vector<fs::path>& runs) {
  std::vector<CellRecord> cells = collect(runs);
  withhold(cells);
  return cells;
}

/// Cells by what is told of them; copies.
struct Parts {
  std::vector<CellRecord> stability, contact, truth, rest;
};

/// Cells of a comparison of costs, by address, and material cards have tables of their own.
Parts parts_of(const std::vector<CellRecord>& cells, const std::vector<FeatureCost>& costs) {
  Parts out;
  std::set<const CellRecord*> told;
  for (const FeatureCost& f : costs) told.insert({f.needed, f.all});
  std::set<std::string> timed;
  for (const CellRecord& c : cells)
    if (summary_value(c, "frame_wall_median_s") > 0) timed.insert(c.header.scenario_json);
  for (const CellRecord& c : cells) {
    if (told.contains(&c) || is_material_card(c) || is_all_on(c)) continue;
    // Only the name is known of a scene that has not been run. It is listed among the cells without a result.
    if (c.outcome.status == "missing" && c.header.scenario_json.empty()) continue;
    // Where no solver was timed on a pulled strip, its errors are tabulated by speed instead of by time.
    const bool by_time = has_truth(c) && !(pulls_strip(c) && !timed.contains(c.header.scenario_json));
    (is_stability(c) ? out.stability : by_time ? out.truth : has_contact(c) ? out.contact : out.rest).push_back(c);
  }
  return out;
}

/// Tables of the cells with contact, in the order they are printed; none if there are none. Memory and bytes of each
/// set-up only in files.
std::vector<Table> penetration_tables(const std::vector<ContactSetUp>& ups, const std::vector<RoomPair>& pairs,
                                      const std::vector<TurnedPair>& turned, bool with_costs) {
  if (ups.empty()) return {};
  std::vector<Table> out = {verdict_table(ups)};
  if (const auto sweeps = speed_sweeps(ups); !sweeps.empty()) out.push_back(leak_table(sweeps));
  for (Table& t : std::vector<Table>{pulled_strip_table(ups), popping_table(poppings(ups)), turned_table(turned)})
    if (t.rows.size() > 1) out.push_back(std::move(t));
  for (const ContactSetUp& u : ups) {
    out.push_back(contact_table(u));
    if (with_costs) out.push_back(cost_table(u));
  }
  if (const Table broken = broken_table(ups); broken.rows.size() > 1) out.push_back(broken);
  if (!pairs.empty()) out.push_back(room_table(pairs));
  return out;
}

/// Robustness, headline numbers and, `in_full`, every boundary and every run that was not stable.
std::vector<Table> stability_tables(const std::vector<CellRecord>& cells, const nlohmann::json& maps, bool in_full) {
  std::vector<Table> out;
  if (!cells.empty()) out.push_back(robustness_table(cells));
  if (const auto across = across_runs(cells); !across.empty()) out.push_back(across_table(across));
  if (!maps.empty()) out.push_back(headline_table(maps));
  if (!in_full) return out;
  if (!maps.empty()) out.push_back(boundary_table(maps));
  if (Table t = first_failure_table(cells); t.rows.size() > 1) out.push_back(std::move(t));
  return out;
}

/// Their failures are what the stability tables are about.
std::vector<CellRecord> without_stability(std::vector<CellRecord> cells) {
  std::erase_if(cells, is_stability);
  return cells;
}

/// One page: ranks, best solvers, which solvers have stiffness as a parameter, which features are not without effect
/// where they should be. Empty without diagrams.
std::string summary_page(const std::vector<WorkDiagram>& diagrams, const std::vector<SolverMaterial>& materials,
                         const std::vector<FeatureCost>& costs) {
  if (diagrams.empty()) return "";
  std::string out = ranks_table(diagrams).markdown() + "\n" + winners_table(diagrams).markdown() + "\n";
  if (!materials.empty()) out += material_verdicts(materials).markdown() + "\n";
  if (!costs.empty()) out += no_op_table(costs).markdown() + "\n";
  return out;
}

bool any_known(const std::vector<SolverFeatures>& solvers) {
  return std::any_of(solvers.begin(), solvers.end(), [](const SolverFeatures& s) { return s.known; });
}

}  // namespace

nlohmann::json published_table3() { return nlohmann::json::parse(kPublishedTable3); }

void write_report(const std::vector<fs::path>& runs, const ReportOptions& options) {
  const std::vector<CellRecord> cells = printable(runs);
  const nlohmann::json published = published_table3();
  const auto write = [&](const char* name, const std::string& text) {
    write_file_atomically(options.out / name, text);
  };
  std::error_code error;
  fs::create_directories(options.out, error);
  if (error) throw Error(options.out.string() + ": cannot be made a folder: " + error.message());
  write("cells.csv", cells_csv(cells));
  write("cells.json", cells_json(cells).dump(1) + "\n");
  write("bandwidth.csv", summary_csv(cells, kBandwidthNames));
  write("memory.csv", summary_csv(cells, kMemoryNames));
  const Table sampled = sampled_table(cells);
  if (sampled.rows.size() > 1) write("device-samples.csv", summary_csv(cells, sampled_names()));

  const std::vector<FeatureCost> costs = feature_costs(cells);
  const std::vector<SolverMaterial> materials = solver_materials(cells);
  const auto [stability, contact, truth, rest] = parts_of(cells, costs);
  const nlohmann::json maps = stability_maps(runs);
  const std::vector<ContactSetUp> ups = set_ups(contact);
  const std::vector<WorkDiagram> diagrams = work_diagrams(truth, materials);
  const std::string head = headline(cells, Format::Markdown);
  std::string tables;
  Page page;
  // The page has the same tables as report.md: they are told once.
  const auto told = [&](const char* id, const std::string& title, std::vector<Table> of) {
    std::string text;
    for (const Table& t : of) text += t.markdown() + "\n";
    page.sections.push_back({id, title, std::move(of)});
    return text;
  };
  const std::vector<Family> rates = families(rest);
  bool wrote_table3 = false;
  for (const Family& family : rates) {
    const std::string text =
        told("rates", family.paper_table == 3 ? "Table 3" : "Rates: " + family.name, fps_tables(family, published));
    tables += text;
    if (family.paper_table != 3 || wrote_table3) continue;
    write("table3.md", "# Table 3\n\n" + head + "\n" + text);
    write("table3.csv", table3_csv(family, published));
    write("table3.json", table3_json(family, published).dump(1) + "\n");
    wrote_table3 = true;
  }
  if (sampled.rows.size() > 1) tables += told("sampled", "The device's own counters", {sampled});
  if (!ups.empty()) {
    const std::vector<RoomPair> pairs = room_pairs(contact);
    const std::vector<TurnedPair> turned = turned_pairs(ups);
    const std::string text = told("penetration", "Penetration", penetration_tables(ups, pairs, turned, true));
    tables += text;
    write("penetration.md", "# Penetration\n\n" + head + "\n" + text);
    write("penetration.csv", summary_csv(contact, penetration_columns()));
    write("penetration.json", nlohmann::json{{"cells", penetration_json(ups)},
                                             {"rooms", room_json(pairs)},
                                             {"first_leaks", leak_json(speed_sweeps(ups))},
                                             {"pulled_strip", pulled_strip_json(ups)},
                                             {"popping", popping_json(poppings(ups))},
                                             {"turned", turned_json(turned)}}
                                      .dump(1) +
                                  "\n");
    write("penetration-series.csv", series_csv(ups));
  }
  if (!diagrams.empty()) {
    const std::string text =
        told("work-precision", "Error against run time",
             {work_table(diagrams), budget_table(diagrams), energy_table(diagrams), truth_table(diagrams)});
    tables += text;
    write("work-precision.md", "# Error against run time\n\n" + head + "\n" + text);
    write("work-precision.csv", work_csv(diagrams));
    write("work-precision.json", work_json(diagrams).dump(1) + "\n");
  }
  if (!stability.empty() || !maps.empty()) {
    const std::string text = told("stability", "Stability", stability_tables(stability, maps, true));
    tables += text;
    write("stability.md", "# Stability\n\n" + head + "\n" + text);
    write("stability.csv", stability_csv(stability));
    write("stability-across.csv", across_csv(across_runs(stability)));
    write("stability.json",
          nlohmann::json{{"format", "clothbench-stability"}, {"format_version", 1}, {"maps", maps}}.dump(1) + "\n");
  }
  if (!materials.empty()) {
    const std::string text =
        told("material", "Material card", {material_table(materials), material_verdicts(materials)});
    tables += text;
    write("material.md", "# Material card\n\n" + head + "\n" + text);
    write("material.json", material_json(materials).dump(1) + "\n");
  }
  if (!costs.empty()) {
    const std::string text = told("feature-cost", "Feature cost", {feature_cost_table(costs), no_op_table(costs)});
    tables += text;
    write("feature-cost.md", "# Feature cost\n\n" + head + "\n" + text);
    write("feature-cost.csv", feature_cost_csv(costs));
    write("feature-cost.json", feature_cost_json(costs).dump(1) + "\n");
  }
  if (const std::string text = summary_page(diagrams, materials, costs); !text.empty())
    write("summary.md", "# Summary\n\n" + head + "\n" + text);
  if (const auto solvers = solver_features(cells); any_known(solvers)) {
    tables += told("features", "Features", {feature_table(solvers, true)});
    write("features.json", feature_json(solvers, true).dump(1) + "\n");
  }
  if (const Table failed = failed_table(without_stability(cells)); failed.rows.size() > 1)
    tables += told("failed", "Cells without a result", {failed});
  if (const Table broken = expect_table(without_stability(cells)); broken.rows.size() > 1)
    tables += told("expect", "Expectations", {broken});

  page.headline = head;
  page.rates = rates_json(rates, published);
  page.penetration = contact_series_json(ups);
  page.work = work_json(diagrams);
  page.maps = maps;
  page.cases = stability_cases(stability);
  page.commands = commands_of(runs);
  for (const WorkDiagram& d : diagrams)
    for (const WorkPoint& p : d.points)
      if (p.on_front) page.fronts.insert(p.cell->file);
  if (!diagrams.empty()) told("summary", "Summary", {ranks_table(diagrams), winners_table(diagrams)});
  told("environment", "Environment", {environment_table(cells)});
  const PageTemplate with = page_template();
  const std::string no_page = write_page(options.out, cells, page, with);
  const auto [no_figures, figures] = draw_pictures(options.out, with);
  for (const std::string& why : {no_page, no_figures})
    if (!why.empty()) fmt::print(stderr, "{}\n", why);
  write("report.md",
        "# clothbench report\n\n" + head + "\n" + tables + (figures.empty() ? "" : "### Figures\n\n" + figures) +
            (no_figures.empty() ? "" : no_figures + "\n\n") +
            (no_page.empty() ? "`index.html` shows all of this interactively, with the motions. " : no_page + "\n\n") +
            "`cells.csv` and `cells.json` hold every summary value of every cell in full precision.\n");
}

void print_console_report(const std::vector<fs::path>& runs) {
  const std::vector<CellRecord> cells = printable(runs);
  const nlohmann::json published = published_table3();
  fmt::print("{}", headline(cells, Format::Console));
  const std::vector<FeatureCost> costs = feature_costs(cells);
  const std::vector<SolverMaterial> materials = solver_materials(cells);
  const auto [stability, contact, truth, rest] = parts_of(cells, costs);
  for (const Family& family : families(rest))
    for (const Table& t : fps_tables(family, published)) fmt::print("{}", t.console());
  if (const Table sampled = sampled_table(cells); sampled.rows.size() > 1) fmt::print("{}", sampled.console());
  const std::vector<ContactSetUp> ups = set_ups(contact);
  for (const Table& t : penetration_tables(ups, room_pairs(contact), turned_pairs(ups), false))
    fmt::print("{}", t.console());
  if (const auto diagrams = work_diagrams(truth, materials); !diagrams.empty())
    fmt::print("{}{}{}{}{}{}", work_table(diagrams).console(), budget_table(diagrams).console(),
               energy_table(diagrams).console(), truth_table(diagrams).console(), winners_table(diagrams).console(),
               ranks_table(diagrams).console());
  if (!materials.empty())
    fmt::print("{}{}", material_table(materials).console(), material_verdicts(materials).console());
  if (!costs.empty()) fmt::print("{}{}", feature_cost_table(costs).console(), no_op_table(costs).console());
  if (const auto solvers = solver_features(cells); !contact.empty() && any_known(solvers))
    fmt::print("{}", feature_table(solvers, true).console());
  for (const Table& t : stability_tables(stability, stability_maps(runs), false)) fmt::print("{}", t.console());
  const Table failed = failed_table(without_stability(cells));
  if (failed.rows.size() > 1) fmt::print("\n{}\n", failed.title);
  for (std::size_t r = 1; r < failed.rows.size(); ++r) {
    const auto& row = failed.rows[r];  // messages are sentences: lines, not columns
    fmt::print("{}", wrapped(row[0] + ": " + row[1] + ": " + row[2] + ": " + row[3], 2, kConsoleColumns));
  }
  const Table broken = expect_table(without_stability(cells));
  if (broken.rows.size() > 1) fmt::print("\n{} ({})\n", broken.title, broken.note.substr(0, broken.note.size() - 1));
  for (std::size_t r = 1; r < broken.rows.size(); ++r)
    fmt::print("{}",
               wrapped(broken.rows[r][0] + ": " + broken.rows[r][1] + ": " + broken.rows[r][2], 2, kConsoleColumns));
}

}  // namespace clothbench
