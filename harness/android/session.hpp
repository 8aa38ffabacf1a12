#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace clothbench::android {

/// Services that a session needs from the operating system. Called from the session's thread.
class System {
 public:
  virtual ~System() = default;
  /// Writes one line to the device's log; works until the end of the process.
  virtual void log(const std::string& line) = 0;
  /// Waits until everything printed so far is in the log.
  virtual void flush() = 0;
  /// Asks the system to end the activity. Not called after `Session::destroy`.
  virtual void finish() = 0;
};

/// Start arguments of an activity.
struct Launch {
  std::filesystem::path files;  ///< folder of results and args.txt
  std::string extra;            ///< the intent's string extra "args"; empty = none
};

/// Runs one command, such as {"study", "table3"}; the exit code of `clothbench`.
using Command = std::function<int(const std::vector<std::string>& words)>;

/// Splits a command line at blanks, except within words in double quotes.
std::vector<std::string> split_words(const std::string& line);

/// Life cycle of an activity, independent of the operating system. The command of the intent extra, else of
/// `<files>/args.txt`, else `study table3`, runs in a separate thread:
///   - `study`, `run` and `xr` without --out write to `<files>/runs/<name>-<UTC>`;
///   - `<files>/session.json` stores the command and its folder while it runs. A start with the same command continues
///     one that was killed or destroyed (it does not repeat finished trials);
///   - a paused run waits between frames; a destroyed run stops after its frame and keeps all finished trials;
///   - the last line logged is "RESULT PASS <path>" if the command exited with 0, else "RESULT FAIL <path>"; the path
///   is
///     the folder of its results (or `files`).
/// Member functions may be called in any order and from any thread. A second session of a process waits for the first.
class Session {
 public:
  Session(Launch launch, std::shared_ptr<System> system, Command command);
  ~Session();  ///< destroy()
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void pause();
  void resume();
  /// Stops the run and waits for it, but not longer than the system allows an activity's main thread to wait: a solver
  /// that is still loading then ends later.
  void destroy();

  /// State shared by the session and its thread, so that the thread may outlive the session.
  struct Shared;

 private:
  std::shared_ptr<Shared> shared_;
};

}  // namespace clothbench::android
