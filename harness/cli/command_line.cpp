#include <fmt/format.h>

#include "cli/command.hpp"
#include "cli/command_line.hpp"
#include "runner/build_info.hpp"

namespace clothbench {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string line = "clothbench";
  for (const std::string& word : words) line += " " + word;
  return line;
}

}  // namespace

int run_command_line(const std::vector<std::string>& words) {
  CLI::App app{"clothbench: interchangeable cloth solvers, the same scenes, comparable numbers", "clothbench"};
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("clothbench ") + build_info::kVersion + " (" + build_info::kGitCommit + ")");
  app.footer("Exit codes: 0 ok, 1 a check failed, 2 bad input, 3 no device, 130 interrupted.");
  Console console;
  console.command_line = joined(words);
  console.words = words;
  app.add_flag("--json", console.json, "Print a machine-readable summary");
  app.fallthrough();

  add_list(app, console);
  add_validate(app, console);
  add_plan(app, console);
  add_card(app, console);
  add_run(app, console);
  add_run_cell(app, console);
  add_study(app, console);
  add_report(app, console);
  add_import(app, console);
  add_check(app, console);
  add_compare(app, console);
  add_history(app, console);
  add_metamorphic(app, console);
  add_threshold(app, console);
  add_friction(app, console);
#ifdef CLOTHBENCH_WITH_BENCH
  add_bench(app, console);
#endif
#ifdef CLOTHBENCH_WITH_RENDER
  add_render(app, console);
#endif
#ifdef CLOTHBENCH_WITH_XR
  add_xr(app, console);
#endif
  add_completion(app, console);
  try {
    // CLI11 takes the words last first.
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::ParseError& e) {
    if (!words.empty() && app.get_subcommands().empty()) {
      std::vector<std::string> commands;
      for (const CLI::App* c : app.get_subcommands({})) commands.push_back(c->get_name());
      const std::string near = nearest(words.front(), commands);
      if (!near.empty() && near != words.front()) fmt::print(stderr, "no command \"{}\"; nearest known: {}\n", words.front(), near);
    }
    return app.exit(e) == 0 ? 0 : static_cast<int>(ExitCode::BadInput);
  } catch (const Error& e) {
    fmt::print(stderr, "clothbench: {}\n", e.what());
    return static_cast<int>(e.code());
  } catch (const std::exception& e) {
    fmt::print(stderr, "clothbench: internal error: {}\n", e.what());
    return static_cast<int>(ExitCode::CheckFailed);
  }
  return static_cast<int>(console.exit_code);
}

}  // namespace clothbench
