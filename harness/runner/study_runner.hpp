#pragma once
#include <filesystem>
#include <functional>
#include <vector>

#include "results/store.hpp"
#include "runner/cell.hpp"

namespace clothbench {

/// Cells to run, in groups; the trials of one group are interleaved, so that a change of the machine's speed meets
/// all of its cells alike.
struct CellPlan {
  std::vector<std::vector<CellSpec>> groups;
  TrialRules rules;
  std::string protocol;  ///< "short", "full" or "quick", stored with every cell
  /// Solvers that a study names and this build lacks: entries without `make`, whose cells become `unsupported`.
  std::vector<std::shared_ptr<const SolverEntry>> not_built;
  bool references = false;      ///< store the reference solution of each scene's truth with its cells
  bool material_cards = false;  ///< measure every solver's material card at its default setting and those of its fronts

  std::size_t size() const;
};

struct RunOptions {
  std::filesystem::path out;
  bool resume = false;
  DeviceOptions device;
  /// Called before each piece of work with what it is and how many of how many pieces are done.
  std::function<void(const std::string& what, std::size_t done, std::size_t total)> progress;
  std::filesystem::path reference_cache = "results/runs/reference-cache";  ///< for plans with references
};

struct RunResult {
  std::vector<std::filesystem::path> files;
  int cells_ok = 0, cells_unsupported = 0, cells_over_budget = 0, cells_failed = 0;
  /// Wall time by solver: loads, passes, trials and files; and of "reference solutions".
  std::map<std::string, double> seconds, card_seconds;  ///< card_seconds: of material cards
  int cards = 0, cards_left_out = 0;
  int expect_kept = 0;                     ///< cells that keep what their scene expects
  std::vector<std::string> expect_broken;  ///< those that do not, and how; a result, not a fault
  int validation_messages = 0;
  std::vector<std::string> faults;  ///< cells that broke a rule of the harness (stages, validation): the run fails
};

/// Before anything is written into the folder of a run: throws Error naming the file if a cell of the plan that it
/// holds, finished or begun, is of another scene, other settings or another version of its solver, or is finished and
/// not to be gone on with.
void require_same_cells(const std::filesystem::path& folder, const CellPlan&, bool resume);

/// Runs every cell and writes one file each. Finished cells are skipped and finished trials reused with `resume`;
/// without it a cell that is already there is an Error, and with it one of another scene, other settings or another
/// version. Throws Error with ExitCode::Interrupted on Ctrl-C.
RunResult run_cells(const CellPlan&, const RunOptions&);

}  // namespace clothbench
