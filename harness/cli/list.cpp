#include <fmt/format.h>

#include <map>

#include "assets/assets.hpp"
#include "base/table.hpp"
#include "base/words.hpp"
#include "check/compare.hpp"
#include "cli/command.hpp"
#include "metrics/registry.hpp"
#include "report/view.hpp"
#include "runner/environment.hpp"
#include "runner/study_plan.hpp"
#include "scenario/load.hpp"
#include "scenario/study.hpp"

namespace clothbench {

extern const char* const kGlossary;  ///< GLOSSARY.md, a Markdown table of term and meaning

namespace {

nlohmann::json list_solvers() {
  nlohmann::json rows = nlohmann::json::array();
  for (const SolverEntry* e : all_solvers()) {
    nlohmann::json settings = nlohmann::json::array();
    for (const SettingSpec& s : e->info.settings)
      settings.push_back({{"name", s.name}, {"default", json_from(s.default_json)}, {"doc", s.doc}});
    rows.push_back({{"name", e->info.name},
                    {"folder", e->info.folder},
                    {"summary", e->info.summary},
                    {"version", e->info.version},
                    {"precision", e->info.precision},
                    {"gpu", e->info.on_gpu},
                    {"plugin", is_external(e->info)},
                    {"supports", describe_features(e->info)["supports"]},
                    {"settings", settings}});
  }
  return rows;
}

nlohmann::json list_scenarios() {
  nlohmann::json rows = nlohmann::json::array();
  for (const std::string& name :
       scene_names({"paper", "contact", "garments", "validation", "stability", "conformance"}))
    rows.push_back({{"name", name}, {"why", load_scene(name).why}});
  return rows;
}

nlohmann::json list_studies() {
  nlohmann::json rows = nlohmann::json::array();
  for (const std::string& name : scene_names({"studies"})) {
    const std::string file = (scenario_root() / (name + ".json")).string();
    rows.push_back({{"name", name.substr(name.find('/') + 1)},  // as the command `study` expects it
                    {"why", parse_json(read_text(file), file).value("why", "")}});
  }
  return rows;
}

nlohmann::json list_devices() {
  nlohmann::json rows = nlohmann::json::array();
  for (const SolverEntry& e : solvers()) {
    if (!e.devices) continue;
    for (const DeviceInfo& d : e.devices())
      rows.push_back({{"name", d.name}, {"driver", d.driver}, {"api", d.api}, {"software", d.is_software}});
    break;  // all GPU backends see the same Vulkan devices
  }
  return rows;
}

nlohmann::json list_metrics() {
  nlohmann::json rows = nlohmann::json::array();
  for (const MetricGroup& g : metric_groups())
    for (const Metric& m : g.series)
      rows.push_back({{"name", m.name},
                      {"units", m.units},
                      {"long_name", m.long_name},
                      {"needs", m.needs.words},
                      {"source", g.source}});
  return rows;
}

nlohmann::json list_scalars() {
  nlohmann::json rows = nlohmann::json::array();
  auto s = scalars().begin();  // in the order of the groups; `doc` states from what each is computed
  for (const MetricGroup& g : metric_groups())
    for (std::size_t k = 0; k < g.scalars.size(); ++k, ++s) {
      rows.push_back({{"name", s->name},
                      {"units", s->units},
                      {"long_name", s->doc},
                      {"of", s->from.series},
                      {"expect", s->expect == Expect::Yes},
                      {"source", g.source}});
      if (s->gate != nullptr) rows.back()["check"] = {{"slack", slack_text(*s->gate)}, {"why", s->gate->why}};
    }
  return rows;
}

nlohmann::json list_assets() {
  const assets::AssetSource source = assets::locate_assets(false);
  return {{{"name", source.kind()}, {"summary", source.reason}, {"folder", source.root.string()}}};
}

std::string without_emphasis(std::string text) {
  std::erase_if(text, [](char c) { return c == '`' || c == '*'; });
  return text;
}

/// The glossary: term and meaning, in alphabetical order.
nlohmann::json list_terms() {
  nlohmann::json rows = nlohmann::json::array();
  std::istringstream lines(kGlossary);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t middle = line.find(" | ");
    if (!line.starts_with("| ") || middle == std::string::npos || line.starts_with("| term |")) continue;
    rows.push_back({{"name", without_emphasis(line.substr(2, middle - 2))},
                    {"summary", without_emphasis(line.substr(middle + 3, line.rfind(" |") - middle - 3))}});
  }
  return rows;
}

/// The report's table of features, with all solvers of this build.
Table features() {
  std::vector<RunRecord> runs;
  for (const SolverEntry* e : all_solvers()) {
    RunHeader& header = runs.emplace_back().header;
    header.solver = e->info.name;
    header.environment["solver_features"] = describe_features(e->info);
  }
  return tables_of(feature_view(), RunTable(std::move(runs))).at(0);
}

nlohmann::json list_features() {
  const Table table = features();
  nlohmann::json rows = nlohmann::json::array();
  for (std::size_t k = 0; k < kFeatureCount; ++k) {
    rows.push_back({{"name", kFeatures[k].name}, {"doc", kFeatures[k].doc}, {"solvers", nlohmann::json::object()}});
    for (std::size_t c = 1; c < table.rows[0].size(); ++c)
      rows.back()["solvers"][table.rows[0][c]] = table.rows[k + 1][c];
  }
  return rows;
}

const std::map<std::string, nlohmann::json (*)()> kLists = {
    {"solvers", list_solvers}, {"features", list_features}, {"scenarios", list_scenarios},
    {"studies", list_studies}, {"devices", list_devices},   {"metrics", list_metrics},
    {"scalars", list_scalars}, {"assets", list_assets},     {"terms", list_terms}};

std::string rows_text(const nlohmann::json& rows) {
  std::string out;
  for (const auto& r : rows) {
    std::string text = r.value("summary", r.value("why", r.value("long_name", r.value("driver", std::string()))));
    if (r.value("software", false)) text += "  (software; its times tell nothing about a GPU)";
    if (r.value("plugin", false)) text += "  (" + r["folder"].get<std::string>() + ")";
    if (r.contains("units")) text += " [" + r["units"].get<std::string>() + "]";
    out += wrapped(text, 25, console_columns(), r["name"]);
    if (r.contains("settings"))
      for (const auto& s : r["settings"])
        out += wrapped(s["doc"], 29, console_columns(),
                       fmt::format("    solver.{}={}", s["name"].get<std::string>(), dump(s["default"])));
  }
  return out;
}

std::vector<std::string> list_names() {
  std::vector<std::string> names;
  for (const auto& [name, unused] : kLists) names.push_back(name);
  return names;
}

std::string list_text(const std::string& what) {
  if (what == "features") return features().console();
  const nlohmann::json rows = kLists.at(what)();
  return rows.empty() ? "no " + what + "\n" : rows_text(rows);
}

}  // namespace

void add_list(CLI::App& app, Console& console) {
  std::string& what = console.arguments<std::string>();
  what = "solvers";
  CLI::App* cmd = app.add_subcommand(
      "list", "List solvers, features, scenarios, studies, devices, metrics, scalars, assets or terms");
  const auto check = [](const std::string& word) {
    return contains(list_names(), word) ? "" : "no list \"" + word + "\"" + nearest_known(word, list_names());
  };
  cmd->add_option("what", what, joined(list_names(), " | "))->check(check);
  add_solvers(*cmd, "--solver", console.arguments<std::vector<std::string>>(),
              "Also these, in lists of solvers and features");
  cmd->footer(
      "Examples: clothbench list solvers\n"
      "          clothbench list scenarios --json");
  cmd->callback([&] { console.print([&] { return kLists.at(what)(); }, [&] { return list_text(what); }); });
}

}  // namespace clothbench
