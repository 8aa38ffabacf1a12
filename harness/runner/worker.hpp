#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "base/child_process.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {

/// Path of this program's executable, for running it again. Throws Error in an app.
std::filesystem::path own_program();

/// Null if there is none of that name.
using SolverLookup = std::function<const SolverEntry*(const std::string&)>;

/// Functions of a worker by name: request -> answer.
using WorkerProgress = std::function<void(const std::string& what, std::size_t done, std::size_t total)>;
using WorkerFunction = std::function<nlohmann::json(const nlohmann::json& request, const WorkerProgress&)>;
using WorkerFunctions = std::map<std::string, WorkerFunction>;

/// Main function of `PROGRAM run-child`, the child's side: reads requests from its standard input, a socket, one JSON
/// object per line, calls the function that each names, and answers on the same socket with a JSON object on one line;
/// lines before it report progress. The process ends with its parent, even if it hangs in a solver.
int run_child_main(const WorkerFunctions&);

/// An answer, or how the worker ended without one.
struct WorkerAnswer {
  nlohmann::json value;
  std::optional<ChildEnd> end = {};
  std::string last_words = {};  ///< the last line of its output, if the worker keeps it and ended: mostly why
};

/// Longest time [s] that a solver may take for a frame or a load: $CLOTHBENCH_SOLVER_LIMIT_S, or 900.
double solver_limit_s();

nlohmann::json device_to_json(const DeviceOptions&);
DeviceOptions device_from_json(const nlohmann::json&);

/// A child process, `program run-child …`, that calls solvers for this one: the only way from a command to a solver.
/// One child answers many requests, since creating a Vulkan device costs as much as a small run; after a fault it is
/// replaced. Not thread-safe.
class Worker {
 public:
  /// `program`: this one if empty. `scratch`: a folder of this worker, for a file with the child's output, whose last
  /// line explains a crash; if empty, the child's output is this process's.
  explicit Worker(std::filesystem::path program = {}, std::filesystem::path scratch = {});

  /// Calls a function of the child, and throws the Error that it throws. The child is killed after `limit_s` (0 =
  /// never) without progress; `heard` receives progress and returns the limit from then on. On Ctrl-C it is killed too,
  /// and Error(`interrupted`, Interrupted) thrown.
  WorkerAnswer call(
      const std::string& function, const nlohmann::json& request, double limit_s, const char* interrupted,
      const std::function<double(const std::string& what, std::size_t done, std::size_t total)>& heard = {});
  /// The next call gets a new child.
  void replace_child() { child_.reset(); }
  int children() const { return children_; }     ///< number of children started so far
  int calls_of_child() const { return calls_; }  ///< number of calls that the last child got

 private:
  /// Sends a line and waits for the answer. Returns nothing if it came, or how the child ended instead.
  std::optional<ChildEnd> ask(const std::string& line, double limit_s, const char* interrupted,
                              const std::function<double(const std::string&)>& heard, std::string& answer);

  const std::filesystem::path program_, scratch_;
  std::unique_ptr<ChildProcess> child_;
  int calls_ = 0, children_ = 0;
  std::uintmax_t said_ = 0;  ///< bytes of the child's output before the request
};

/// `work(request)` by the worker's function of that name, or in this process if --in-process asks for it.
WorkerAnswer guarded(Worker&, const std::string& function, const nlohmann::json& request,
                     const std::function<nlohmann::json(const nlohmann::json&)>& work);

}  // namespace clothbench
