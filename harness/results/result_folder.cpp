#include "results/result_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cstring>

#include "base/files.hpp"
#include "base/words.hpp"
#include "clothbench/error.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kShown = 200;  // bytes of a path or a command in a message

[[noreturn]] void refuse_folder(const fs::path& folder, const std::string& why) {
  throw Error(fmt::format("{}: {}; give another --out", shortened(folder.string(), kShown), why));
}

/// Whether `path` still names the open file: a process that ends removes it.
bool is_named(int file, const fs::path& path) {
  struct stat open_file {
  }, named{};
  return fstat(file, &open_file) == 0 && stat(path.c_str(), &named) == 0 && open_file.st_ino == named.st_ino &&
         open_file.st_dev == named.st_dev;
}

/// Locks one byte, or all with `count` 0; record locks also work over NFS. False if another process has one of them.
bool lock(int file, std::size_t first, int count) {
  struct flock range {};
  range.l_type = F_WRLCK;
  range.l_start = static_cast<off_t>(first);
  range.l_len = count;
  return fcntl(file, F_OFD_SETLK, &range) == 0 || (errno != EAGAIN && errno != EACCES);  // a file system without locks
}

std::string holder(const fs::path& file) {
  const std::string text = content_of(file);
  return text.empty() ? "another process" : shortened(text, kShown);
}

}  // namespace

ResultFolder::ResultFolder(const fs::path& folder, const std::vector<std::size_t>& runs,
                           const std::string& command_line)
    : file_(folder / ".lock") {
  std::error_code ec;
  if (fs::exists(folder, ec) && !fs::is_directory(folder, ec))
    refuse_folder(folder, "it is a file; expected a folder for the result files");
  fs::create_directories(folder, ec);
  if (ec) refuse_folder(folder, "the folder cannot be made: " + ec.message());
  for (;;) {
    lock_ = open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (lock_ < 0) refuse_folder(folder, std::string("no file can be made in it: ") + std::strerror(errno));
    if (runs.empty() ? !lock(lock_, 0, 0)
                     : !std::all_of(runs.begin(), runs.end(), [&](std::size_t run) { return lock(lock_, run, 1); })) {
      const std::string by = holder(file_);
      close(lock_);
      refuse_folder(folder, fmt::format("{} writes its results there", by));
    }
    if (is_named(lock_, file_)) break;
    close(lock_);
  }
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  const std::string text = fmt::format("process {} on {} ({})", getpid(), host.data(), command_line);
  if (ftruncate(lock_, 0) != 0 || pwrite(lock_, text.data(), text.size(), 0) < 0)
    refuse_folder(folder, std::string("no file can be written in it: ") + std::strerror(errno));
}

ResultFolder::~ResultFolder() {
  // The last one removes the file; one that waits for the same name opens it anew.
  if (lock(lock_, 0, 0) && is_named(lock_, file_)) unlink(file_.c_str());
  close(lock_);
}

void require_short_name(const fs::path& folder, const std::string& run) {
  if (run.size() > kMostRunName)
    throw Error(
        fmt::format("{}: the names of its result files would have {} bytes and an ending; expected at most {}: "
                    "shorten the name of the scene or the settings",
                    in_quotes(run), run.size(), kMostRunName));
  if (fs::absolute(folder).string().size() + kMostRunName + 56 > PATH_MAX)
    refuse_folder(folder, "the paths of result files in it would be too long");
}

}  // namespace clothbench
