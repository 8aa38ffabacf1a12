#include "cli/command_line.hpp"

#include <filesystem>
#include <memory>
#include <sstream>

#include "base/child_process.hpp"
#include "base/table.hpp"
#include "base/words.hpp"
#include "cli/command.hpp"
#include "runner/environment.hpp"

namespace clothbench {
namespace {

/// Reports the reason of a failure as text and, with --json, as JSON.
int report_error(const Console& console, const std::string& message, ExitCode code) {
  const std::string why = message_of(message);
  fmt::print(stderr, "clothbench: {}\n", why);
  if (console.json) Console::print({{"error", why}, {"exit_code", static_cast<int>(code)}});
  return static_cast<int>(code);
}

/// In the order of the help text.
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

/// Help text that fits the terminal.
struct Help : CLI::Formatter {
  std::string fitted(const std::string& text, std::size_t left) const {
    std::string out = wrapped(text, 0, console_columns() - left);
    out.pop_back();
    return out;
  }
  std::string make_description(const CLI::App* app) const override { return fitted(app->get_description(), 0) + "\n"; }
  std::string make_option_desc(const CLI::Option* option) const override {
    return fitted(option->get_description(), get_column_width());
  }
  std::string make_footer(const CLI::App* app) const override {
    std::istringstream lines(app->get_footer());
    std::string out;
    for (std::string line; std::getline(lines, line);)  // commands are not wrapped, so that they can be copied
      out += line.find(" clothbench ") < line.size() ? line + "\n" : fitted(line, 0) + "\n";
    return out;
  }
  std::string make_subcommand(const CLI::App* command) const override {
    std::ostringstream out;
    CLI::detail::format_help(out, command->get_display_name(true),
                             fitted(command->get_description(), get_column_width()), get_column_width());
    return out.str();
  }
};

/// Message about an unknown command or the first unknown option, with the nearest known word; empty if all are known.
std::string unknown_word(const CLI::App& app, const std::vector<std::string>& words) {
  if (words.empty()) return "";
  std::vector<std::string> commands, options;
  for (const CLI::App* c : app.get_subcommands({})) commands.push_back(c->get_name());
  if (!words.front().starts_with("-") && !contains(commands, words.front()))
    return "no command \"" + words.front() + "\"" + nearest_known(words.front(), commands);
  std::vector<const CLI::App*> given = {&app};
  for (const CLI::App* c : app.get_subcommands()) given.push_back(c);
  for (const CLI::App* a : given)
    for (const CLI::Option* o : a->get_options())
      for (const std::string& name : o->get_lnames()) options.push_back("--" + name);
  for (const std::string& word : words)
    if (const std::string name = word.substr(0, word.find('=')); name.starts_with("--") && !contains(options, name))
      return "no option \"" + name + "\"" + nearest_known(name, options);
  return "";
}

}  // namespace

int run_command_line(const std::vector<std::string>& words) {
  CLI::App app{
      "clothbench: runs interchangeable cloth solvers on the same scenes and compares error, time and "
      "robustness",
      "clothbench"};
  app.formatter(std::make_shared<Help>());
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("clothbench ") + build_info::kVersion + " (" + build_info::kGitCommit +
                                        "), sources " + build_info::kSourceSha256);
  app.footer(
      "Examples: clothbench run paper/desk-flat-low --solver xpbd --solver bullet-soft\n          "
      "clothbench study table3 --quick --out results/runs/mine\n          clothbench report "
      "results/runs/mine -o report\nOptions of a command: clothbench COMMAND --help, or clothbench help "
      "COMMAND\nTerms: clothbench list terms\nExit codes: 0 ok, 1 a check failed or a solver finished none of the "
      "runs that it supports, 2 bad input, 3 no device, 130 interrupted.");
  Console console;
  console.command_line = "clothbench " + joined(words, " ");
  app.add_flag("--json", console.json, "Print a machine-readable summary; may also follow the command");
  app.add_flag("--in-process", console.arguments<bool>(),
               "Run solvers in this process, so that a debugger sees them; a solver's crash then ends the program");
  // Before the words are parsed, because parsing loads plugins.
  if (contains(words, "--in-process")) run_solvers_in_process();
  std::optional<SummaryOutput> summary_alone;
  if (contains(words, "--json")) summary_alone.emplace();
  app.fallthrough();

  for (AddCommand* add : kCommands) add(app, console);
  const bool helps = !words.empty() && words.front() == "help";  // help, help run
  const std::vector<std::string> asked(words.begin() + (helps ? 1 : 0), words.end());
  try {
    std::vector<std::string> given(asked.rbegin(), asked.rend());  // CLI11 expects the words in reverse order
    if (helps) given.insert(given.begin(), "--help");
    app.parse(given);
  } catch (const CLI::ParseError& e) {
    const std::string unknown = unknown_word(app, asked);
    if (e.get_exit_code() == 0 && (unknown.empty() || !helps)) return app.exit(e);
    console.json = contains(words, "--json");  // parsing may have stopped before it
    return report_error(console, (unknown.empty() ? e.what() : unknown) + "; --help explains", ExitCode::BadInput);
  } catch (const Error& e) {
    return report_error(console, e.what(), e.code());
  } catch (const std::filesystem::filesystem_error& e) {  // from a path that the user gave
    return report_error(console, e.path1().string() + ": " + e.code().message(), ExitCode::BadInput);
  } catch (const std::exception& e) {
    return report_error(console, std::string("internal error: ") + e.what(), ExitCode::CheckFailed);
  }
  return static_cast<int>(console.exit_code);
}

}  // namespace clothbench
