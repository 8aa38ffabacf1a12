#pragma once
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"
#include "results/store.hpp"
#include "runner/again.hpp"
#include "runner/resume.hpp"
#include "runner/solver_run.hpp"
#include "truth/reference_case.hpp"

namespace clothbench {

/// The runs of a study that learns from each which one it needs next: a search, a measurement of moduli, a relation of
/// two runs. With a folder each is a run like any other's, and one that is there already is read instead of run again:
/// a study that is gone on with asks the same questions. What a row of its table says is computed from the records,
/// here and in a report of the folder alike.
class StudyRuns {
 public:
  /// Nothing is stored.
  explicit StudyRuns(DeviceOptions);
  /// Writes `out`/study.json. Throws Error if there is one and the study is not to go on with it (`resume`).
  StudyRuns(DeviceOptions, std::filesystem::path out, bool resume, StudyManifest);

  const DeviceOptions& device() const { return device_; }

  /// The whole scene: as it is stored, or run now and stored by that protocol; without a folder only how it ends (see
  /// whole_run.hpp, also for `by`). Throws Error if what is stored is of another scene, other settings or another
  /// version of the solver.
  RunRecord run(const RunSpec&, const std::string& protocol, const truth::ReferenceCase* by = nullptr);

  /// A run that `make` measures in its own way, without positions: as it is stored, or made now.
  RunRecord made(const PlannedRun&, const std::function<RunRecord()>& make);

  /// What `work` asks, a plugin's in a child. Where that crashes, or hangs, the runs that it had begun are stored as
  /// such, or else `asked`, and the answer is one record, of `asked`, that says so.
  std::vector<RunRecord> ask(Guard&, const RunHeader& asked, const SolverEntry&,
                             const std::function<std::vector<RunRecord>()>& work);

 private:
  /// Null if it is not stored; otherwise named in the manifest.
  std::optional<RunRecord> stored(const PlannedRun&) const;
  void plan(const std::string& run) const;
  void store_crashed(const RunHeader& asked, const Outcome&) const;

  DeviceOptions device_;
  std::filesystem::path out_;  ///< empty: nothing is stored
};

}  // namespace clothbench
