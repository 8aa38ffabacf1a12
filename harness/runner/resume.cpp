#include "runner/resume.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "clothbench/error.hpp"
#include "results/raw_file.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kWhatToDo = "results of both would be mixed; give another --out, or undo the change";

/// Where a solver is known both are completed: a process that crashed has stored settings as they were given.
bool same_settings(const PlannedCell& cell, const json& stored) {
  if (cell.solver == nullptr) {
    const json given = flat_settings(cell.settings), all = flat_settings(stored);
    return std::all_of(given.items().begin(), given.items().end(),
                       [&](const auto& s) { return all.contains(s.key()) && all[s.key()] == s.value(); });
  }
  try {
    return complete_settings(*cell.solver, cell.settings) == complete_settings(*cell.solver, stored);
  } catch (const Error&) {
    return false;  // a setting that this version of the solver does not have
  }
}

std::string version_of(const CellHeader& h) {
  return h.environment.is_object() ? h.environment.value("solver_version", "") : "";
}

/// Null if there is none. Another process of a sharded study may be finishing the cell: its folder then becomes a file.
std::optional<CellHeader> stored_header(const fs::path& folder, const std::string& cell, fs::path& file) {
  for (int attempt = 0;; ++attempt) {
    file = stored_cell(folder, cell);
    if (file.empty()) return std::nullopt;
    try {
      if (!fs::is_directory(file)) return read_cell_summary(file).header;
      return header_from_json(read_raw(file / "header.raw").header.at("cell"));
    } catch (const Error&) {
      if (fs::exists(file) || attempt > 0) throw;
    }
  }
}

}  // namespace

std::string short_hash(const std::string& sha256) {
  constexpr std::size_t kShown = 12;
  return sha256.empty() ? "none" : sha256.substr(0, kShown);
}

PlannedCell planned_cell(const CellSpec& spec) {
  return {cell_name(spec), spec.scene->sha256, spec.settings, spec.entry->make ? &spec.entry->info : nullptr};
}

fs::path stored_cell(const fs::path& folder, const std::string& cell) {
  const fs::path file = folder / (cell + ".h5"), part = folder / (cell + ".part");
  if (fs::exists(file)) return file;
  return fs::exists(part / "header.raw") ? part : fs::path();
}

void require_same_cell(const fs::path& folder, const PlannedCell& cell) {
  fs::path file;
  const std::optional<CellHeader> h = stored_header(folder, cell.name, file);
  if (!h) return;
  if (h->scenario_sha256 != cell.scenario_sha256)
    throw Error(fmt::format("{}: is of another scene (SHA-256 of the completed scenario {}, now {}); {}", file.string(),
                            short_hash(h->scenario_sha256), short_hash(cell.scenario_sha256), kWhatToDo));
  if (!same_settings(cell, h->settings))
    throw Error(fmt::format("{}: was run with other settings ({}, now {}); {}", file.string(), h->settings.dump(),
                            cell.settings.dump(), kWhatToDo));
  const std::string version = version_of(*h);  // older files lack it
  if (cell.solver != nullptr && !version.empty() && version != cell.solver->version)
    throw Error(fmt::format("{}: was run with version {} of {}, this is version {}; {}", file.string(), version,
                            cell.solver->name, cell.solver->version, kWhatToDo));
}

void refuse_finished_cell(const fs::path& folder, const std::string& cell) {
  throw Error(fmt::format("{}: {} is already there; give another --out, or --resume to go on with this folder",
                          folder.string(), cell));
}

void require_same_cells(const fs::path& folder, const std::vector<PlannedCell>& cells, bool resume) {
  for (const PlannedCell& cell : cells) {
    if (!resume && cell_finished(folder, cell.name)) refuse_finished_cell(folder, cell.name);
    require_same_cell(folder, cell);
  }
}

}  // namespace clothbench
