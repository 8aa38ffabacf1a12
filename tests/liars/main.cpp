// Tells lies of right motions and counts those that the check of motions sees.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "clothbench/error.hpp"
#include "trial.hpp"

int main(int argc, char** argv) {
  using namespace clothbench::liars;
  CLI::App app{"Wrong motions, and which of them the check of motions fails."};
  Matrix matrix;
  bool json = false, list = false;
  app.add_option("--seed", matrix.seed, "of the first motion; each motion has the next");
  app.add_option("--motions", matrix.motions, "number of right motions")->check(CLI::NonNegativeNumber);
  app.add_option("--kind", matrix.kinds, "kinds of scenes; default: all");
  app.add_option("--solver", matrix.solver, "this solver alone, such as \"xpbd accurate\"");
  app.add_option("--lie", matrix.only_lie, "this lie alone");
  app.add_option("--motion-cache", matrix.motion_cache, "folder that keeps motions between calls");
  app.add_option("--store", matrix.store, "folder for the plugin that replays the motions");
  app.add_flag("--json", json, "every trial with every ratio");
  app.add_flag("--list", list, "names of kinds and lies");
  CLI11_PARSE(app, argc, argv);
  try {
    if (list) {
      for (const std::string& kind : scene_kinds()) fmt::print("kind {}\n", kind);
      for (const Lie& lie : lies()) fmt::print("{} {}\n", lie.right ? "control" : "lie", lie.name);
      return 0;
    }
    const auto trials = tell_all(matrix, [](const std::string& line) { fmt::print(stderr, "{}\n", line); });
    fmt::print("{}\n", json ? as_json(trials).dump() : as_text(trials));
  } catch (const clothbench::Error& e) {
    fmt::print(stderr, "liars: {}\n", e.what());
    return 2;
  }
}
