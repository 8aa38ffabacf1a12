#pragma once
#include <stdexcept>
#include <string>

namespace clothbench {

/// Process exit codes of the `clothbench` command.
enum class ExitCode : int { Ok = 0, CheckFailed = 1, BadInput = 2, NoDevice = 3, Interrupted = 130 };

/// Base class of all exceptions of the project. The message is complete: it names what failed (file and JSON pointer,
/// argument or Vulkan call) and what was expected. A solver that diverges is a result, not an error (StepStatus).
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message, ExitCode code = ExitCode::BadInput)
      : std::runtime_error(message), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

/// A solver cannot be created or cannot load a scene. This error becomes a row of results; others end the command.
class SolverError : public Error {
 public:
  explicit SolverError(const std::string& message) : Error(message, ExitCode::CheckFailed) {}
};

/// Thrown by ClothSolver::load for a scene that the solver cannot run at its settings: the run ends as `unsupported`.
class UnsupportedScene : public SolverError {
 public:
  using SolverError::SolverError;
};

}  // namespace clothbench
