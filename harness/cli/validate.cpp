#include "cli/command.hpp"
#include "results/store.hpp"
#include "runner/study_plan.hpp"
#include "scenario/study.hpp"

namespace clothbench {
namespace {

void validate(const std::string& file) {
  if (!is_study(file)) return static_cast<void>(load_scene(file));
  const Study study = load_study(file);
  for (const std::string& run : run_names(plan_study(study))) require_short_name(".", run);
}

}  // namespace

void add_validate(CLI::App& app, Console& console) {
  auto& files = console.arguments<std::vector<std::string>>();
  CLI::App* cmd = app.add_subcommand("validate", "Check scene and study files");
  cmd->add_option("file", files, "Files or names")->required();
  cmd->footer(
      "Examples: clothbench validate my-scene.json\n"
      "          clothbench validate paper/gravity table3");
  cmd->callback([&console, &files] {
    nlohmann::json rows = nlohmann::json::array();
    for (const std::string& file : files) {
      std::string fault;
      try {
        validate(file);
      } catch (const Error& e) {
        fault = message_of(e.what());
        console.exit_code = ExitCode::BadInput;
      }
      rows.push_back({{"file", file}, {"ok", fault.empty()}, {"message", fault}});
      if (!console.json) fmt::print("{}\n", fault.empty() ? file + ": ok" : fault);
    }
    if (console.json) Console::print(rows);
  });
}

}  // namespace clothbench
