#include <fmt/format.h>

#include "cli/run_common.hpp"
#include "report/report.hpp"

namespace clothbench {
namespace {

/// What the seeds drew, a line a scene; many scenes are what the result files are for.
void print_drawn(const Study& study) {
  constexpr std::size_t kFew = 24;
  std::set<std::string> names;
  for (const Study::Item& item : study.scenes) names.insert(item.scene.name);
  if (names.size() > kFew) return;
  for (const Study::Item& item : study.scenes) {
    if (names.erase(item.scene.name) == 0) continue;
    const nlohmann::json drawn = nlohmann::json::parse(item.scene.json)["drawn"];
    std::string text = fmt::format("{}: speed {:.3g} m/s;", item.scene.name, drawn["speed_m_per_s"].get<double>());
    for (const auto& [name, value] : drawn["values"].items())
      text += fmt::format(" {}={}", name, value.is_string() ? value.get<std::string>() : value.dump());
    fmt::print("{}\n", text);
  }
}

struct Counts {
  int passed = 0, drawn = 0;
  void add(const RunRecord& a) {
    ++drawn;
    passed += a.outcome.expect == "pass" ? 1 : 0;
  }
};

}  // namespace

void run_contact_and_tell(Study study, StudyManifest manifest, const RunFlags& flags, std::vector<std::string> only,
                          int jobs, Console& console) {
  StabilityOptions options = options_apart(study, manifest, flags, only, jobs, console);
  require_same_runs(study, options);
  write_manifest(options.out, manifest);
  if (!console.json) print_drawn(study);
  Counts counts;
  {
    StatusLine line(!console.json);
    options.progress = [&](const std::string& what, std::size_t done, std::size_t total) {
      line.show(what, done, total);
    };
    execute_runs_apart(study, options, [&](const RunRecord& a) { counts.add(a); });
  }
  if (console.json) {
    const nlohmann::json j = {{"out", options.out.string()}, {"passed", counts.passed}, {"runs", counts.drawn}};
    fmt::print("{}\n", j.dump(2));
    return;
  }
  print_console_report({options.out});
  fmt::print("\n{} of {} runs passed; results in {}\n", counts.passed, counts.drawn, options.out.string());
}

}  // namespace clothbench
