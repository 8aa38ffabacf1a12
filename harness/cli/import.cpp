#include "cli/command.hpp"
#include "results/store.hpp"

namespace clothbench {

void add_import(CLI::App& app, Console& console) {
  auto& folders = console.arguments<std::vector<std::string>>();
  auto& samples_file = console.arguments<std::string>();
  CLI::App* cmd =
      app.add_subcommand("import", "Convert the CBOR files of a headset, whose program has no HDF5, to HDF5 files");
  cmd->add_option("folder", folders, "Study folders or .cbor files")->required();
  cmd->add_option("--samples", samples_file,
                  "Readings of the device during the run: samples.json of scripts/quest_run.py");
  cmd->footer(
      "Examples: clothbench import results/runs/phone\n"
      "          clothbench import results/runs/quest --samples results/runs/quest/samples.json");
  cmd->callback([&console, &folders, &samples_file] {
    std::optional<DeviceSamples> samples;
    if (!samples_file.empty()) samples.emplace(samples_file);
    nlohmann::json rows = nlohmann::json::array();
    for (const std::string& folder : folders)
      for (const auto& file : import_runs(folder, samples ? &*samples : nullptr)) {
        rows.push_back(file.string());
        if (!console.json) fmt::print("{}\n", file.string());
      }
    if (console.json) Console::print(rows);
    const std::set<std::string> reasons = samples ? samples->reasons() : std::set<std::string>();
    for (const std::string& reason : reasons) fmt::print(stderr, "NOT VALID: {}\n", reason);
    if (!reasons.empty()) console.exit_code = ExitCode::CheckFailed;
    if (rows.empty()) fmt::print(stderr, "nothing to import: these folders have no .cbor files\n");
  });
}

}  // namespace clothbench
