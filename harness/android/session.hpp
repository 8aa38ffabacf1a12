#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace clothbench::android {

/// Functions of the activity that a session needs; called from the session's thread.
struct Activity {
  std::string arguments;  ///< command line; empty: study table3
  /// Writes one line to the device's log after everything printed before; works until the process ends.
  std::function<void(const std::string& line)> log;
  /// Asks the system to end the activity. Not called after `Session::destroy`.
  std::function<void()> finish;
  /// Runs one command, such as {"study", "table3"}; returns the exit code of `clothbench`.
  std::function<int(const std::vector<std::string>& words)> command;
};

/// Splits a command line at blanks, except within words in double quotes.
std::vector<std::string> split_words(const std::string& line);

/// Life cycle of an activity, independent of the operating system. Its command runs in a separate thread:
///   - a paused run waits between frames; a destroyed run stops after its frame and keeps all finished trials, and
///     the log names the command that continues it;
///   - the last line logged is "RESULT PASS" if the command exited with 0, otherwise "RESULT FAIL".
/// Member functions may be called in any order and from any thread. A process's second session waits for the first.
class Session {
 public:
  explicit Session(Activity activity);
  ~Session();  ///< destroy()
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void pause();
  void resume();
  /// Stops the run and waits for its end, but no longer than the system lets an activity's main thread wait. If the
  /// solver is still loading, the run ends later.
  void destroy();

  /// State shared by the session and its thread, so that the thread may outlive the session.
  struct Shared;

 private:
  std::shared_ptr<Shared> shared_;
};

/// Returns the content of the packed file at a path; empty if there is none.
using AssetReader = std::function<std::optional<std::string>(const std::string& path)>;

/// Unpacks the files of pack_assets.py into the folder `to`, so that all other code reads plain files. `index.txt` has
/// one line per file: SHA-256 and path. A folder with an equal index is kept; otherwise its content is removed first.
/// Throws Error naming a file that is missing or damaged.
void unpack_assets(const AssetReader& read, const std::filesystem::path& to);

}  // namespace clothbench::android
