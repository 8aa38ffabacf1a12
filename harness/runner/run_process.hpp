#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/child_process.hpp"
#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"
#include "runner/whole_run.hpp"

namespace clothbench {

/// A child process that reads requests line by line from its standard input, a socket, and answers each with an empty
/// line on the same socket. Lines before the answer report progress.
class Child {
 public:
  /// Starts argv[0] (a path) with its output in `log`, or with this process's output if that is empty. Throws Error if
  /// it cannot be started.
  Child(const std::vector<std::string>& argv, const std::filesystem::path& log);

  /// Sends a line and waits for the answer. Returns nothing if it came, or how the child ended instead, for example
  /// killed after `limit_s` (0 = never) without a line; the child is then gone. `heard` receives lines of progress and
  /// returns the limit for the time after them. On Ctrl-C the child is killed and Error(`interrupted`, Interrupted)
  /// thrown.
  std::optional<ChildEnd> ask(const std::string& line, double limit_s, const char* interrupted,
                              const std::function<double(const std::string&)>& heard = {});

 private:
  ChildProcess process_;
};

/// The child's side: calls `answer` for every line until there are no more. The process ends with its parent, even if
/// it hangs in a solver.
void serve_parent(const std::function<void(const std::string&)>& answer);

/// Reports progress to the parent; `line` is not empty.
void tell_parent(const std::string& line);

/// Path of this program's executable, for running it again. Throws Error in an app.
std::filesystem::path own_program();

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

/// What a worker does by name, beside runs: request -> answer.
using WorkerProgress = std::function<void(const std::string& what, std::size_t done, std::size_t total)>;
using WorkerFunction = std::function<nlohmann::json(const nlohmann::json& request, const WorkerProgress&)>;
using WorkerFunctions = std::map<std::string, WorkerFunction>;

/// Main function of `PROGRAM run-child FOLDER`: for every line n of its standard input, until it ends, executes
/// FOLDER/request-n.json and writes FOLDER/answer-n.json.
int run_child_main(const std::filesystem::path& folder, const SolverLookup&, const WorkerFunctions& = {});

/// An answer, or how the worker ended without one.
struct WorkerAnswer {
  nlohmann::json value;
  std::optional<ChildEnd> end = {};
};

/// Calls a function in a new worker process, with this process's output, and throws the Error that it throws. The
/// worker is killed after `limit_s` (0 = never) without progress; `heard` receives progress and returns the limit from
/// then on. On Ctrl-C it is killed too, and Error(`interrupted`, Interrupted) thrown.
WorkerAnswer call_worker(
    const std::string& function, const nlohmann::json& request, double limit_s, const char* interrupted,
    const std::function<double(const std::string& what, std::size_t done, std::size_t total)>& heard = {});

/// `work(request)` in this process, or for a plugin the function of that name in a worker.
WorkerAnswer guarded(const SolverEntry&, const std::string& function, const nlohmann::json& request,
                     const std::function<nlohmann::json(const nlohmann::json&)>& work);

/// Longest time [s] that a plugin may run without progress: $CLOTHBENCH_PLUGIN_LIMIT_S, or 900.
double plugin_limit_s();

nlohmann::json device_to_json(const DeviceOptions&);
DeviceOptions device_from_json(const nlohmann::json&);

/// The request of a planned run.
RunRequest request_of(const RunSpec&, RunRules);

/// Executes runs in a child process, `program run-child …`. One child executes many runs, since creating a Vulkan
/// device costs as much as a small run; after a fault it is replaced. A child is killed at 1.2 times the run's limit
/// plus 5 s. If it crashes, hangs or ends without an answer, the outcome is `crashed` or `timed_out` with class F3 and
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
