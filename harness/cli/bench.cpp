#include "studies/bench.hpp"

#include "cli/command.hpp"

namespace clothbench {

void add_bench(CLI::App& app, Console& console) {
  auto& flags = console.arguments<DeviceFlags>();
  auto& study = console.arguments<std::string>();
  study = "table3";
  CLI::App* cmd =
      app.add_subcommand("bench", "Time the runs of a study with Google Benchmark; accepts its --benchmark_… flags");
  cmd->add_option("--study", study, "Study")->capture_default_str();
  flags.add_to(*cmd);
  // Google Benchmark reads what this command does not know; without this the words would go to the parent command.
  cmd->fallthrough(false);
  cmd->allow_extras();
  cmd->footer("Example: clothbench bench --benchmark_filter='gravity-32-.*xpbd' --benchmark_repetitions=5");
  cmd->callback([cmd, &console, &flags, &study] {
    std::vector<std::string> words = cmd->remaining();
    console.json = std::erase(words, "--json") > 0 || console.json;
    if (console.json) words.push_back("--benchmark_format=json");
    if (!bench(study, flags.options, std::move(words))) console.exit_code = ExitCode::CheckFailed;
  });
}

}  // namespace clothbench
