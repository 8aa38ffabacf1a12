#include "clothbench/error.hpp"
#include "report/report.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

/// A planned cell that has no result: what its name "<scene>__<solver>__<setting>" tells.
CellRecord missing_cell(const std::string& name, bool started) {
  CellRecord c;
  const std::size_t first = name.find("__"), last = name.rfind("__");
  c.header.scene = name.substr(0, first);
  if (first != std::string::npos && last > first) {
    c.header.solver = name.substr(first + 2, last - first - 2);
    c.header.setting = name.substr(last + 2);
  }
  c.outcome = {"missing", "ok", -1, started ? "started, not finished" : "planned, not run"};
  return c;
}

CellRecord read(const fs::path& path) {
  CellRecord c = read_cell_summary(path);
  c.file = path.string();
  return c;
}

void collect_folder(const fs::path& dir, std::vector<CellRecord>& cells) {
  const std::size_t first = cells.size();
  for (const std::string& name : read_manifest(dir).cells) {
    const fs::path file = dir / (name + ".h5"), part = dir / (name + ".part");
    if (fs::exists(file))
      cells.push_back(read(file));
    else if (fs::exists(part / "outcome.raw"))
      cells.push_back(read(part));
    else
      cells.push_back(missing_cell(name, fs::exists(part)));
  }
  // A missing cell stands in the row and column of its scene if another solver finished that scene.
  for (std::size_t k = first; k < cells.size(); ++k) {
    if (cells[k].outcome.status != "missing") continue;
    for (std::size_t j = first; j < cells.size() && cells[k].header.scenario_json.empty(); ++j)
      if (cell_name(cells[j].header).starts_with(cells[k].header.scene + "__"))
        cells[k].header.scenario_json = cells[j].header.scenario_json;
  }
}

}  // namespace

std::vector<CellRecord> collect(const std::vector<fs::path>& runs) {
  std::vector<CellRecord> cells;
  for (const fs::path& run : runs) {
    if (!fs::exists(run)) throw Error(run.string() + ": no such file or folder");
    // A path with a trailing slash has an empty last part.
    const fs::path last = run.has_filename() ? run.filename() : run.parent_path().filename();
    if (fs::is_directory(run) && last.extension() != ".part")
      collect_folder(run, cells);
    else
      cells.push_back(read(run));
  }
  return cells;
}

}  // namespace clothbench
