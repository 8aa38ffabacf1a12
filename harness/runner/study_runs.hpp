#pragma once
#include <filesystem>
#include <functional>
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

/// The runs of a study in which each result decides the next run: a search, a measurement of moduli, a relation of two
/// runs. With a folder, each is stored like any other run, and a stored run is read instead of run again: a resumed
/// study requests the same runs. The rows of its table are computed from the records, both here and in a report of the
/// folder.
class StudyRuns {
 public:
  /// Nothing is stored.
  explicit StudyRuns(DeviceOptions);
  /// Writes `out`/study.json. Throws Error if there is one and `resume` is off.
  StudyRuns(DeviceOptions, std::filesystem::path out, bool resume, StudyManifest);

  const DeviceOptions& device() const { return device_; }

  /// The whole scene: the stored run, or one run now and stored under that protocol; without a folder only how it ends
  /// (see whole_run.hpp, also for `by`). Throws Error if the stored run is of another scene, other settings or another
  /// version of the solver.
  RunRecord run(const RunSpec&, const std::string& protocol, const truth::ReferenceCase* by = nullptr);

  /// A run that `make` measures, without positions: the stored one, or one made now.
  RunRecord made(const PlannedRun&, const std::function<RunRecord()>& make);

  /// Results of `work`, in a child for a plugin. If the child crashes or hangs, the runs that it had begun are stored
  /// as crashed, or `asked` if there are none, and the result is one record, of `asked`, with that outcome.
  std::vector<RunRecord> ask(Guard&, const RunHeader& asked, const SolverEntry&,
                             const std::function<std::vector<RunRecord>()>& work);

 private:
  /// None if it is not stored; otherwise it is added to the manifest.
  std::optional<RunRecord> stored(const PlannedRun&) const;
  void plan(const std::string& run) const;
  void store_crashed(const RunHeader& asked, const Outcome&) const;

  DeviceOptions device_;
  std::filesystem::path out_;  ///< empty: nothing is stored
};

}  // namespace clothbench
