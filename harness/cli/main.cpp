#include <fmt/format.h>

#include <csignal>
#include <cstdlib>

#include "cli/command.hpp"
#include "runner/build_info.hpp"
#include "runner/cell.hpp"

namespace {

void on_signal(int) {
  // A second Ctrl-C means it.
  if (clothbench::interrupt_requested()) std::_Exit(130);
  clothbench::request_interrupt();
}

std::string joined(int argc, char** argv) {
  std::string line = "clothbench";
  for (int i = 1; i < argc; ++i) line += std::string(" ") + argv[i];
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace clothbench;
  CLI::App app{"clothbench: interchangeable cloth solvers, the same scenes, comparable numbers"};
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("clothbench ") + build_info::kVersion + " (" + build_info::kGitCommit + ")");
  app.footer("Exit codes: 0 ok, 1 a check failed, 2 bad input, 3 no device, 130 interrupted.");
  Console console;
  console.command_line = joined(argc, argv);
  app.add_flag("--json", console.json, "Print a machine-readable summary");
  app.fallthrough();

  add_list(app, console);
  add_validate(app, console);
  add_plan(app, console);
  add_run(app, console);
  add_study(app, console);
  add_report(app, console);
  add_import(app, console);
  add_check(app, console);
  add_bench(app, console);

  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
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
