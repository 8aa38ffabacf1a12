#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"
#include "runner/child.hpp"
#include "runner/whole_run.hpp"

namespace clothbench {

/// One run: a whole scene, untimed, for this process or another. It holds all data of the request file that a process
/// is given.
struct RunRequest {
  nlohmann::json scenario;       ///< as in its file, not completed
  std::string source;            ///< that file
  std::vector<std::string> set;  ///< overrides of the scene, `dotted.key=JSON`
  std::string name;              ///< of this variant of the scene
  std::string solver, setting;
  nlohmann::json settings = nlohmann::json::object();
  RunRules rules = {};
};

nlohmann::json to_json(const RunRequest&);
RunRequest request_from_json(const nlohmann::json&);

/// What a process reports of its run: outcome and summary.
nlohmann::json answer_to_json(const RunRecord&);
RunRecord answer_from_json(const nlohmann::json&);

/// Writes the file of a run whose process could not write it. A file that the process left incomplete is removed: it is
/// not the beginning of this one, but output of a crashed solver.
void write_failed_run(const std::filesystem::path& out, const RunHeader&, const Outcome&,
                      const std::map<std::string, double>& summary);

using SolverLookup = std::function<const SolverEntry&(const std::string&)>;

/// Executes the run in this process: the child's side of RunWorker. What a solver throws is the outcome `error`.
RunRecord run_request(const RunRequest&, const SolverLookup&);

/// Main function of `PROGRAM run-child FOLDER`: for every line n of its standard input, until it ends, runs
/// FOLDER/request-n.json and writes FOLDER/answer-n.json.
int run_child_main(const std::filesystem::path& folder, const SolverLookup&);

/// Executes runs in a child process, `program run-child …`. One child executes many runs, since creating a Vulkan
/// device costs as much as a small run; after a fault it is replaced. A child is killed at 1.2 times the run's limit
/// plus 5 s. If it crashes, hangs or ends without an answer, the outcome is `crashed` or `timed_out` with class F8 and
/// its last output; where results are kept, such a run gets a result file too. A crash in a child that had executed
/// other runs only counts if it recurs in a fresh one. Not thread-safe.
class RunWorker {
 public:
  /// `scratch`: a folder for the exchanged files, used by this worker alone.
  RunWorker(std::filesystem::path program, std::filesystem::path scratch);
  ~RunWorker();
  RunRecord run(const RunRequest&);
  int children() const { return children_; }  ///< number of children started so far

 private:
  std::optional<ChildEnd> ask(const RunRequest&);

  const std::filesystem::path program_, scratch_;
  std::unique_ptr<Child> child_;
  int number_ = 0, runs_ = 0, children_ = 0;
  std::uintmax_t said_ = 0;  ///< bytes of the child's output before the run
};

}  // namespace clothbench
