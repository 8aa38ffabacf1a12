#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace clothbench {

/// Makes a folder for result files and locks it: a second process that would write the same files is refused. The
/// kernel releases a lock with its process, so that one that died blocks nothing. Children of the process write under
/// its lock.
class ResultFolder {
 public:
  /// `runs`: numbers of the runs of a study that this process executes, next to processes with other runs of it; empty:
  /// no other process may write into the folder. `command_line`: for the message of a process that is refused. Throws
  /// Error naming the folder and who writes into it, or why it cannot be made or written (a file, a path too long, no
  /// permission).
  ResultFolder(const std::filesystem::path& folder, const std::vector<std::size_t>& runs,
               const std::string& command_line);
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

 private:
  std::filesystem::path file_;
  int lock_ = -1;
};

/// Bytes that a file's name may have before the endings of result files.
inline constexpr std::size_t kMostRunName = 200;

/// Throws Error unless the files of a run of this name can be made in the folder.
void require_short_name(const std::filesystem::path& folder, const std::string& run);

}  // namespace clothbench
