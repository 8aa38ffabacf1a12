#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "assets/assets.hpp"
#include "base/json_text.hpp"
#include "check/gates.hpp"
#include "cli/command.hpp"
#include "metrics/registry.hpp"
#include "report/features.hpp"
#include "scenario/load.hpp"
#include "scenario/study.hpp"

namespace clothbench {
namespace {

nlohmann::json list_solvers() {
  nlohmann::json rows = nlohmann::json::array();
  for (const SolverEntry& e : solvers()) {
    nlohmann::json settings = nlohmann::json::array(), features = nlohmann::json::array();
    for (const SettingSpec& s : e.info.settings)
      settings.push_back({{"name", s.name}, {"default", nlohmann::json::parse(s.default_json)}, {"doc", s.doc}});
    e.info.supports.for_each([&](Feature f) { features.push_back(name_of(f)); });
    rows.push_back({{"name", e.info.name},
                    {"folder", e.info.folder},
                    {"summary", e.info.summary},
                    {"version", e.info.version},
                    {"precision", e.info.precision},
                    {"gpu", e.info.on_gpu},
                    {"supports", features},
                    {"settings", settings}});
  }
  return rows;
}

nlohmann::json list_files(const char* folder) {
  nlohmann::json rows = nlohmann::json::array();
  const std::filesystem::path root = scenario_root();
  if (!std::filesystem::exists(root / folder)) return rows;
  for (const auto& file : std::filesystem::recursive_directory_iterator(root / folder))
    if (file.path().extension() == ".json")
      rows.push_back({{"name", std::filesystem::relative(file.path(), root).replace_extension().string()}});
  std::sort(rows.begin(), rows.end());
  return rows;
}

nlohmann::json list_scenarios() {
  nlohmann::json rows = nlohmann::json::array();
  for (const char* folder : {"paper", "contact", "validation", "stability"})
    for (auto& row : list_files(folder)) {
      row["why"] = load_scene(row["name"].get<std::string>()).why;
      rows.push_back(row);
    }
  return rows;
}

nlohmann::json list_studies() {
  nlohmann::json rows = list_files("studies");
  for (auto& row : rows) {
    const std::string name = row["name"], file = (scenario_root() / (name + ".json")).string();
    row["name"] = name.substr(name.find('/') + 1);  // as `study` takes it
    row["why"] = parse_json(read_text(file), file).value("why", "");
  }
  return rows;
}

nlohmann::json list_devices() {
  nlohmann::json rows = nlohmann::json::array();
  for (const SolverEntry& e : solvers()) {
    if (!e.devices) continue;
    for (const DeviceInfo& d : e.devices())
      rows.push_back({{"name", d.name}, {"driver", d.driver}, {"api", d.api}, {"software", d.is_software}});
    break;  // all GPU backends here see the same Vulkan devices
  }
  return rows;
}

/// Into rows in the order of the registry: the file that each entry stands in.
template <class T>
void source_of(nlohmann::json& rows, std::vector<T> MetricGroup::*list) {
  std::size_t at = 0;
  for (const MetricGroup& g : metric_groups())
    for (std::size_t k = 0; k < (g.*list).size(); ++k) rows[at++]["source"] = g.source;
}

nlohmann::json list_metrics() {
  nlohmann::json rows = nlohmann::json::array();
  for (const Metric& m : metrics())
    rows.push_back({{"name", m.name},
                    {"units", m.units},
                    {"long_name", m.long_name},
                    {"version", m.version},
                    {"needs", m.needs.words}});
  source_of(rows, &MetricGroup::series);
  return rows;
}

nlohmann::json list_scalars() {
  nlohmann::json rows = nlohmann::json::array();
  for (const Scalar& s : scalars()) {
    rows.push_back({{"name", s.name},
                    {"units", s.units},
                    {"long_name", s.doc},
                    {"of", s.from.series},
                    {"expect", s.expect == Expect::Yes}});
    if (s.gate != nullptr) rows.back()["check"] = {{"slack", slack_text(*s.gate)}, {"why", s.gate->why}};
  }
  source_of(rows, &MetricGroup::scalars);
  return rows;
}

nlohmann::json list_assets() {
  const assets::AssetSource source = assets::locate_assets(false);
  return {{{"name", source.kind()}, {"summary", source.reason}, {"folder", source.root.string()}}};
}

std::vector<SolverFeatures> features() {
  std::vector<SolverFeatures> out;
  for (const SolverEntry& e : solvers()) out.push_back(declared_features(e.info));
  return out;
}

void print_rows(const nlohmann::json& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& r = rows[i];
    std::string text = r.value("summary", r.value("why", r.value("long_name", r.value("driver", std::string()))));
    if (r.value("software", false)) text += "  (software: for correctness, not for speed claims)";
    if (r.contains("units")) text += " [" + r["units"].get<std::string>() + "]";
    fmt::print("{:<24} {}\n", r["name"].get<std::string>(), text);
    if (r.contains("settings"))
      for (const auto& s : r["settings"])
        fmt::print("    solver.{}={}  {}\n", s["name"].get<std::string>(), s["default"].dump(),
                   s["doc"].get<std::string>());
  }
}

}  // namespace

void add_list(CLI::App& app, Console& console) {
  std::string& what = console.arguments<std::string>();
  what = "solvers";
  CLI::App* cmd = app.add_subcommand(
      "list", "What there is: solvers, features, scenarios, studies, devices, metrics, scalars or assets");
  cmd->add_option("what", what, "solvers | features | scenarios | studies | devices | metrics | scalars | assets")
      ->check(
          CLI::IsMember({"solvers", "features", "scenarios", "studies", "devices", "metrics", "scalars", "assets"}));
  cmd->footer(
      "Examples: clothbench list solvers\n"
      "          clothbench list scenarios --json");
  cmd->callback([&console, &what] {
    const nlohmann::json rows = what == "solvers"     ? list_solvers()
                                : what == "scenarios" ? list_scenarios()
                                : what == "studies"   ? list_studies()
                                : what == "devices"   ? list_devices()
                                : what == "features"  ? feature_json(features(), false)
                                : what == "assets"    ? list_assets()
                                : what == "scalars"   ? list_scalars()
                                                      : list_metrics();
    if (console.json)
      fmt::print("{}\n", rows.dump(2));
    else if (what == "features")
      fmt::print("{}", feature_table(features(), false).console());
    else if (rows.empty())
      fmt::print("no {}\n", what);
    else
      print_rows(rows);
  });
}

}  // namespace clothbench
