#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "base/child_process.hpp"
#include "base/json_text.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {

/// Path of this program's executable, for starting it again. Throws Error in an app.
std::filesystem::path own_program();

/// Finds a solver by name; null if there is none.
using SolverLookup = std::function<const SolverEntry*(const std::string&)>;

/// Functions of a worker by name: request -> answer.
using WorkerProgress = std::function<void(const std::string& what, std::size_t done, std::size_t total)>;
using WorkerFunction = std::function<nlohmann::json(const nlohmann::json& request, const WorkerProgress&)>;
using WorkerFunctions = std::map<std::string, WorkerFunction>;

/// Main function of `PROGRAM run-child`, the child's side. It reads requests from standard input, a socket, as one JSON
/// object per line, calls the function that each names, and answers on the same socket with one JSON object per line;
/// earlier lines report progress. The process ends with its parent, even if it hangs in a solver.
int run_child_main(const WorkerFunctions&);

/// An answer, or how the worker ended without one.
struct WorkerAnswer {
  nlohmann::json value;
  std::optional<ChildEnd> end = {};
  std::string last_words = {};  ///< last line of the ended worker's output, if kept; it usually explains why it ended
};

/// Maximum time [s] of a solver for a frame or a load: $CLOTHBENCH_SOLVER_LIMIT_S, or 900.
double solver_limit_s();

nlohmann::json device_to_json(const DeviceOptions&);
DeviceOptions device_from_json(const nlohmann::json&);

/// A child process, `program run-child …`, that calls solvers on behalf of this one. Commands call solvers in no other
/// way, except with --in-process. One child answers many requests, because creating a Vulkan device costs as much as a
/// small run; after a crash a new child replaces it. Not thread-safe.
class Worker {
 public:
  /// `program`: empty for this program. `scratch`: a folder of this worker for a file with the child's output, whose
  /// last line explains a crash; if empty, the child writes to this process's output.
  explicit Worker(std::filesystem::path program = {}, std::filesystem::path scratch = {});

  /// Calls a function of the child and rethrows its Error. The child is killed after `limit_s` (0 = never) without
  /// progress; `heard` receives progress and returns the limit from then on. On Ctrl-C the child is killed too, and
  /// Error(`interrupted`, Interrupted) is thrown.
  WorkerAnswer call(
      const std::string& function, const nlohmann::json& request, double limit_s, const char* interrupted,
      const std::function<double(const std::string& what, std::size_t done, std::size_t total)>& heard = {});
  /// Makes the next call start a new child.
  void replace_child() { child_.reset(); }
  int children() const { return children_; }     ///< number of children started so far
  int calls_of_child() const { return calls_; }  ///< number of calls to the current child

 private:
  /// Sends a line and waits for the answer. Returns nothing after an answer, otherwise how the child ended.
  std::optional<ChildEnd> ask(const std::string& line, double limit_s, const char* interrupted,
                              const std::function<double(const std::string&)>& heard, std::string& answer);

  const std::filesystem::path program_, scratch_;
  std::unique_ptr<ChildProcess> child_;
  int calls_ = 0, children_ = 0;
  std::uintmax_t said_ = 0;  ///< bytes of the child's output before the request
};

/// Calls the worker's function of that name; with --in-process, calls `work(request)` in this process instead.
WorkerAnswer guarded(Worker&, const std::string& function, const nlohmann::json& request,
                     const std::function<nlohmann::json(const nlohmann::json&)>& work);

}  // namespace clothbench
