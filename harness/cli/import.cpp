#include <fmt/format.h>

#include "cli/command.hpp"
#include "results/store.hpp"

namespace clothbench {

void add_import(CLI::App& app, Console& console) {
  static std::vector<std::string> folders;
  folders = {};
  CLI::App* cmd = app.add_subcommand("import", "Turn raw run files (a device without HDF5, an interrupted run) into HDF5 files");
  cmd->add_option("folder", folders, "Study folders or part folders")->required();
  cmd->callback([&console] {
    nlohmann::json rows = nlohmann::json::array();
    for (const std::string& folder : folders)
      for (const auto& file : import_raw(folder)) {
        rows.push_back(file.string());
        if (!console.json) fmt::print("{}\n", file.string());
      }
    if (console.json) fmt::print("{}\n", rows.dump(2));
  });
}

}  // namespace clothbench
