#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace clothbench::android {

/// What a session wants of the system it runs in. Called from the session's own thread.
class System {
 public:
  virtual ~System() = default;
  /// One line of the device's log; works to the end of the process.
  virtual void log(const std::string& line) = 0;
  /// Returns once everything printed so far stands in the log.
  virtual void flush() = 0;
  /// Asks the system to end the activity. Not called once `Session::destroy` was.
  virtual void finish() = 0;
};

/// What an activity was started with.
struct Launch {
  std::filesystem::path files;  ///< where results and args.txt lie
  std::string extra;            ///< the intent's string extra "args"; empty = none
};

/// Runs one command, such as {"study", "table3"}; the exit code of `clothbench`.
using Command = std::function<int(const std::vector<std::string>& words)>;

/// Words of a command line: blanks part them; "…", '…' and \ keep them together as a shell does. Throws Error on a
/// quote that is not closed.
std::vector<std::string> split_words(const std::string& line);

/// One command a line; blank lines and lines that begin with # are left out.
std::vector<std::string> command_lines(const std::string& text);

/// The life of an activity, without the system it lives in. The commands of the intent extra, else of
/// `<files>/args.txt`, else `study table3`, run one after another in a thread of their own:
///   - `study`, `run` and `xr` without --out write to `<files>/runs/<name>-<UTC>`;
///   - `<files>/session.json` says what runs where. A start with the same commands goes on where a killed or destroyed
///     one stopped (finished commands are not repeated, finished trials neither); after an ended one it begins anew;
///   - paused, the run holds between frames; destroyed, it stops after its frame and all finished trials are kept;
///   - the last line logged is "RESULT PASS <path>" if every command exited with 0, else "RESULT FAIL <path>", the path
///     being the folder of the last command that ran (or `files`).
/// The calls below may come in any order and from any thread; a second session of one process waits for the first.
class Session {
 public:
  Session(Launch launch, std::shared_ptr<System> system, Command command);
  ~Session();  ///< destroy()
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void pause();
  void resume();
  void low_memory();
  /// Stops the run and waits for it, but not longer than a system lets an activity's main thread wait: a solver that is
  /// still loading then ends by itself later.
  void destroy();

  /// What the session and its thread share, so that the thread may outlive it.
  struct Shared;

 private:
  std::shared_ptr<Shared> shared_;
};

}  // namespace clothbench::android
