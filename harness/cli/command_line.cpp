#include "cli/command_line.hpp"

#include <algorithm>
#include <filesystem>

#include "base/plugin_environment.hpp"
#include "base/words.hpp"
#include "cli/command.hpp"
#include "runner/build_info.hpp"

namespace clothbench {
namespace {

/// Says why the command failed, to people and, with --json, to machines.
int report_error(const Console& console, const std::string& message, ExitCode code) {
  const std::string why = message_of(message);
  fmt::print(stderr, "clothbench: {}\n", why);
  if (console.json) Console::print({{"error", why}, {"exit_code", static_cast<int>(code)}});
  return static_cast<int>(code);
}

/// In the order of the help.
constexpr AddCommand* kCommands[] = {
    add_list,   add_validate, add_plan,  add_run,     add_run_child,   add_study,
    add_report, add_import,   add_check, add_compare, add_conformance,
#ifdef CLOTHBENCH_WITH_RENDER
    add_render,
#endif
#ifdef CLOTHBENCH_WITH_XR
    add_xr,
#endif
};

/// Suggests the nearest command if the first word is not a command.
void suggest_command(const CLI::App& app, const std::vector<std::string>& words) {
  if (words.empty() || !app.get_subcommands().empty()) return;
  std::vector<std::string> commands;
  for (const CLI::App* c : app.get_subcommands({})) commands.push_back(c->get_name());
  const std::string near = nearest(words.front(), commands);
  if (!near.empty() && near != words.front())
    fmt::print(stderr, "no command \"{}\"; nearest known: {}\n", words.front(), near);
}

}  // namespace

int run_command_line(const std::vector<std::string>& words) {
  CLI::App app{
      "clothbench: runs interchangeable cloth solvers on the same scenes and compares error, time and "
      "robustness",
      "clothbench"};
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("clothbench ") + build_info::kVersion + " (" + build_info::kGitCommit +
                                        "), sources " + build_info::kSourceSha256);
  app.footer(
      "Examples: clothbench run paper/desk-flat-low --solver xpbd --solver bullet-soft\n          "
      "clothbench study table3 --quick --out results/runs/mine\n          clothbench report "
      "results/runs/mine -o report\nOptions of a command: clothbench COMMAND --help\nTerms: clothbench list "
      "terms\nExit codes: 0 ok, 1 a "
      "check failed, 2 bad input, 3 no device, 130 interrupted.");
  Console console;
  console.command_line = "clothbench " + joined(words, " ");
  app.add_flag("--json", console.json, "Print a machine-readable summary");
  app.add_flag("--in-process", console.arguments<bool>(),
               "Run solvers in this process, for a debugger; a crash of a solver then ends the program");
  // Before the words are read: plugins are loaded on the way.
  if (contains(words, "--in-process")) run_solvers_in_process();
  std::optional<SummaryOutput> summary_alone;
  if (contains(words, "--json")) summary_alone.emplace();
  app.fallthrough();

  for (AddCommand* add : kCommands) add(app, console);
  try {
    // CLI11 takes the words last first.
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    suggest_command(app, words);
    console.json = contains(words, "--json");  // not every word was read
    return report_error(console, std::string(e.what()) + "; --help explains", ExitCode::BadInput);
  } catch (const Error& e) {
    return report_error(console, e.what(), e.code());
  } catch (const std::filesystem::filesystem_error& e) {  // of a path that the user gave
    return report_error(console, e.path1().string() + ": " + e.code().message(), ExitCode::BadInput);
  } catch (const std::exception& e) {
    return report_error(console, std::string("internal error: ") + e.what(), ExitCode::CheckFailed);
  }
  return static_cast<int>(console.exit_code);
}

}  // namespace clothbench
