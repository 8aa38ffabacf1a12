#include "cli/command_line.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <map>

#include "base/former_names.hpp"
#include "base/plugin_environment.hpp"
#include "base/tint.hpp"
#include "cli/command.hpp"
#include "runner/build_info.hpp"

namespace clothbench {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string line = "clothbench";
  for (const std::string& word : words) line += " " + word;
  return line;
}

/// Says why the command failed, to people and, with --json, to machines.
int report_error(const Console& console, const std::string& why, ExitCode code) {
  const bool colour = takes_colour(STDERR_FILENO);
  fmt::print(stderr, "{}clothbench:{} {}\n", colour ? "\x1b[31m" : "", colour ? "\x1b[0m" : "", why);
  if (console.json)
    fmt::print("{}\n", nlohmann::json{{"error", why}, {"exit_code", static_cast<int>(code)}}.dump(
                           2, ' ', false, nlohmann::json::error_handler_t::replace));
  return static_cast<int>(code);
}

/// Words that commands had in version 0.1, with the ones of today.
std::vector<std::string> current_words(std::vector<std::string> words) {
  static const std::map<std::string, std::string> kOptions = {
      {"--cell", "--run"}, {"--list-cells", "--list-runs"}, {"--no-cards", "--no-moduli"}, {"--patience", "--timeout"}};
  const auto command = std::find_if(words.begin(), words.end(), [](const auto& w) { return !w.starts_with("-"); });
  if (command != words.end() && *command == "card") {
    notice_renamed("clothbench", "card", "moduli");
    *command = "moduli";
  }
  for (std::string& word : words) {
    const std::size_t end = std::min(word.find('='), word.size());
    const auto found = kOptions.find(word.substr(0, end));
    if (found == kOptions.end()) continue;
    notice_renamed("clothbench", found->first, found->second);
    word.replace(0, end, found->second);
  }
  return words;
}

void add_commands(CLI::App& app, Console& console) {
  add_list(app, console);
  add_validate(app, console);
  add_plan(app, console);
  add_moduli(app, console);
  add_run(app, console);
  add_run_child(app, console);
  add_study(app, console);
  add_report(app, console);
  add_import(app, console);
  add_check(app, console);
  add_compare(app, console);
  add_history(app, console);
  add_metamorphic(app, console);
  add_threshold(app, console);
  add_friction(app, console);
  add_conformance(app, console);
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
  add_manual(app, console);
}

/// Of a first word that is no command.
void tell_nearest(const CLI::App& app, const std::vector<std::string>& words) {
  if (words.empty() || !app.get_subcommands().empty()) return;
  std::vector<std::string> commands;
  for (const CLI::App* c : app.get_subcommands({})) commands.push_back(c->get_name());
  const std::string near = nearest(words.front(), commands);
  if (!near.empty() && near != words.front())
    fmt::print(stderr, "no command \"{}\"; nearest known: {}\n", words.front(), near);
}

}  // namespace

int run_command_line(const std::vector<std::string>& given) {
  const std::vector<std::string> words = current_words(given);
  CLI::App app{
      "clothbench: runs interchangeable cloth solvers on the same scenes and compares error, time and "
      "robustness",
      "clothbench"};
  app.require_subcommand(1);
  app.set_version_flag("--version",
                       std::string("clothbench ") + build_info::kVersion + " (" + build_info::kGitCommit + ")");
  app.footer(
      "Examples: clothbench run paper/desk-flat-low --solver xpbd --solver bullet-soft\n          "
      "clothbench study table3 --quick --out results/runs/mine\n          clothbench report "
      "results/runs/mine -o report\nOptions of a command: clothbench COMMAND --help\nExit codes: 0 ok, 1 a "
      "check failed, 2 bad input, 3 no device, 130 interrupted.");
  Console console;
  colour_output(takes_colour(STDOUT_FILENO));
  console.command_line = joined(words);
  console.words = words;
  app.add_flag("--json", console.json, "Print a machine-readable summary");
  app.add_flag("--in-process", console.arguments<bool>(),
               "Run plugins in this process, for a debugger; a crash of a plugin then ends the program");
  // Before the words are read: plugins are loaded on the way.
  if (std::find(words.begin(), words.end(), "--in-process") != words.end()) run_plugins_in_process();
  app.fallthrough();

  add_commands(app, console);
  try {
    // CLI11 takes the words last first.
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::ParseError& e) {
    tell_nearest(app, words);
    return app.exit(e) == 0 ? 0 : static_cast<int>(ExitCode::BadInput);
  } catch (const Error& e) {
    return report_error(console, e.what(), e.code());
  } catch (const std::exception& e) {
    return report_error(console, std::string("internal error: ") + e.what(), ExitCode::CheckFailed);
  }
  return static_cast<int>(console.exit_code);
}

}  // namespace clothbench
