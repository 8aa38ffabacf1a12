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

namespace clothbench {

/// One run for a process of its own: a scene from beginning to end, untimed. Everything as it goes into the
/// file that the process is handed.
struct RunRequest {
  nlohmann::json scenario;       ///< as in its file, not completed
  std::string source;            ///< that file
  std::vector<std::string> set;  ///< overrides of the scene, `dotted.key=JSON`
  std::string name;              ///< of the scene in this form
  std::string solver, setting;
  nlohmann::json settings = nlohmann::json::object();
  DeviceOptions device = {};
  std::string protocol;
  double limit_s = 0;         ///< of wall time
  std::filesystem::path out;  ///< folder for the result file; empty: nothing but the answer is kept
};

/// What it comes to. `status` beside those of Outcome: `crashed`, with the signal or exit status as message.
struct RunAnswer {
  Outcome outcome;
  std::map<std::string, double> summary;
  double wall_s = kMissing;
};

nlohmann::json to_json(const RunRequest&);
RunRequest request_from_json(const nlohmann::json&);
nlohmann::json to_json(const RunAnswer&);
RunAnswer answer_from_json(const nlohmann::json&);

/// The file of a run whose process could not write it. What that left half-written goes: it is not the beginning of
/// this, but of a solver that crashes.
void write_failed_run(const std::filesystem::path& out, const RunHeader&, const Outcome&,
                      const std::map<std::string, double>& summary);

using SolverLookup = std::function<const SolverEntry&(const std::string&)>;

/// Executes the run here: the other side of `run_in_process`.
RunAnswer run_request(const RunRequest&, const SolverLookup&);

/// What a program does that is run as `PROGRAM run-child FOLDER`: for every line n of its standard input, until it
/// ends, runs FOLDER/request-n.json and writes FOLDER/answer-n.json.
int run_child_main(const std::filesystem::path& folder, const SolverLookup&);

/// Executes runs in a child process, `program run-child …`. One child takes run after run, since making a Vulkan device
/// costs as much as a small run; after anything but a result it is replaced. A child is killed 5 s (and a fifth) after
/// the run's own limit. One that crashes, hangs or ends without an answer makes the outcome `crashed` or `timed_out`
/// with class F8 and its last words; where results are kept such a run gets a result file too. A crash in a child that
/// had executed other runs is only believed if it comes again in a fresh one. Not to be shared between threads.
class RunWorker {
 public:
  /// `scratch`: a folder for what passes between the two, of this worker alone.
  RunWorker(std::filesystem::path program, std::filesystem::path scratch);
  ~RunWorker();
  RunAnswer run(const RunRequest&);
  int children() const { return children_; }  ///< that it has needed so far

 private:
  std::optional<ChildEnd> ask(const RunRequest&);

  const std::filesystem::path program_, scratch_;
  std::unique_ptr<Child> child_;
  int number_ = 0, runs_ = 0, children_ = 0;
  std::uintmax_t said_ = 0;  ///< bytes of the child's output before the run
};

}  // namespace clothbench
