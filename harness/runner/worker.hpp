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
#include "runner/solver_run.hpp"

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

/// Rules of one untimed run.
struct RunRules {
  DeviceOptions device = {};
  std::string protocol = {};
  std::filesystem::path out = {};  ///< folder for the result file; empty: none is written
  double limit_s = 0;              ///< a pass that takes more wall time is `timed_out`; 0 = no limit
};

/// A scene from beginning to end, untimed: positions, metrics, summary and the result of the scene's expectations.
/// Throws Error as SolverRun does.
RunRecord whole_run(const RunSpec&, const RunRules&);

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

/// Null or an Error if there is none of that name.
using SolverLookup = std::function<const SolverEntry*(const std::string&)>;

/// Executes the run in this process: the child's side of Worker::run. An exception of a solver is the outcome `error`.
RunRecord run_request(const RunRequest&, const SolverLookup&);

/// What a worker does by name: request -> answer.
using WorkerProgress = std::function<void(const std::string& what, std::size_t done, std::size_t total)>;
using WorkerFunction = std::function<nlohmann::json(const nlohmann::json& request, const WorkerProgress&)>;
using WorkerFunctions = std::map<std::string, WorkerFunction>;

/// Main function of `PROGRAM run-child FOLDER`: for every line n of its standard input, until it ends, executes
/// FOLDER/request-n.json and writes FOLDER/answer-n.json. A request names one of the functions, or "run" (RunRequest).
int run_child_main(const std::filesystem::path& folder, const SolverLookup&, WorkerFunctions = {});

/// An answer, or how the worker ended without one.
struct WorkerAnswer {
  nlohmann::json value;
  std::optional<ChildEnd> end = {};
};

/// Longest time [s] that a solver may take for a frame or a load: $CLOTHBENCH_SOLVER_LIMIT_S, or 900.
double solver_limit_s();

nlohmann::json device_to_json(const DeviceOptions&);
DeviceOptions device_from_json(const nlohmann::json&);

/// The request of a planned run.
RunRequest request_of(const RunSpec&, RunRules);

/// A child process, `program run-child …`, that calls solvers for this one: the only way from a command to a solver.
/// One child answers many requests, since creating a Vulkan device costs as much as a small run; after a fault it is
/// replaced. Not thread-safe.
class Worker {
 public:
  /// `program`: this one if empty. `scratch`: a folder for the exchanged files, used by this worker only.
  /// `keep_output`: the child's output goes to a file there, whose last line explains a crash; otherwise it is this
  /// process's.
  Worker(std::filesystem::path program, std::filesystem::path scratch, bool keep_output = true);
  /// In a temporary folder, with this process's output.
  explicit Worker(std::filesystem::path program = {});
  ~Worker();

  /// Calls a function of the child, and throws the Error that it throws. The child is killed after `limit_s` (0 =
  /// never) without progress; `heard` receives progress and returns the limit from then on. On Ctrl-C it is killed too,
  /// and Error(`interrupted`, Interrupted) thrown.
  WorkerAnswer call(
      const std::string& function, const nlohmann::json& request, double limit_s, const char* interrupted,
      const std::function<double(const std::string& what, std::size_t done, std::size_t total)>& heard = {});
  /// Executes a run. The child is killed at 1.2 times the run's limit plus 5 s. If it crashes, hangs or ends without an
  /// answer, the outcome is `crashed` or `timed_out` with class F3 and its last output; where results are kept, such a
  /// run gets a result file too. A crash in a child that had executed other runs only counts if it recurs in a fresh
  /// one.
  RunRecord run(const RunRequest&);
  int children() const { return children_; }  ///< number of children started so far

 private:
  const std::filesystem::path program_, scratch_;
  const bool keep_output_;
  std::unique_ptr<Child> child_;
  int number_ = 0, runs_ = 0, children_ = 0;
  std::uintmax_t said_ = 0;  ///< bytes of the child's output before the request
};

/// `work(request)` by the worker's function of that name, or in this process if --in-process asks for it.
WorkerAnswer guarded(Worker&, const std::string& function, const nlohmann::json& request,
                     const std::function<nlohmann::json(const nlohmann::json&)>& work);

}  // namespace clothbench
