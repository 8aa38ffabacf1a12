#include <fmt/ranges.h>

#include "cli/command.hpp"
#include "studies/lists.hpp"

namespace clothbench {

void add_list(CLI::App& app, Console& console) {
  std::string& what = console.arguments<std::string>();
  what = "solvers";
  CLI::App* cmd =
      app.add_subcommand("list", "List solvers, features, scenarios, studies, devices, metrics, scalars or assets");
  cmd->add_option("what", what, fmt::format("{}", fmt::join(list_names(), " | ")))->check(CLI::IsMember(list_names()));
  add_solvers(*cmd, "--solver", console.arguments<std::vector<std::string>>(),
              "Also these, in lists of solvers and features");
  cmd->footer(
      "Examples: clothbench list solvers\n"
      "          clothbench list scenarios --json");
  cmd->callback([&] { console.print([&] { return list_of(what); }, [&] { return list_text(what); }); });
}

}  // namespace clothbench
