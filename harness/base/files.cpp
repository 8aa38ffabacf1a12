#include "base/files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "clothbench/error.hpp"

namespace clothbench {
namespace {

/// Throws. A path at which no file can exist is a wrong argument (its own exit code); a full or broken disk is not.
[[noreturn]] void fail(const std::filesystem::path& path, const char* what) {
  const int why = errno;
  const bool wrong_path = why == ENOENT || why == ENOTDIR || why == EISDIR || why == ENAMETOOLONG || why == EACCES ||
                          why == EROFS || why == EPERM;
  throw Error(fmt::format("{}: {}: {}", path.string(), what, std::strerror(why)),
              wrong_path ? ExitCode::BadInput : ExitCode::CheckFailed);
}

/// A file descriptor that closes itself.
class Descriptor {
 public:
  Descriptor(const std::filesystem::path& path, int flags) : fd_(open(path.c_str(), flags, 0644)) {}
  ~Descriptor() {
    if (fd_ >= 0) close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

}  // namespace

std::string content_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::filesystem::path temporary_name(const std::filesystem::path& path) {
  return path.string() + fmt::format("{}{}", kTemporaryMark, getpid());
}

void publish(const std::filesystem::path& temporary, const std::filesystem::path& path) {
  {
    const Descriptor file(temporary, O_RDONLY);
    if (file.get() < 0 || fsync(file.get()) != 0) fail(temporary, "cannot be synced");
  }
  if (std::rename(temporary.c_str(), path.c_str()) != 0) fail(path, "cannot be renamed into place");
  const auto folder = path.parent_path().empty() ? std::filesystem::path(".") : path.parent_path();
  const Descriptor dir(folder, O_RDONLY | O_DIRECTORY);
  if (dir.get() < 0) fail(folder, "cannot be opened");
  // Some file systems, a phone's shared storage among them, do not sync folders.
  if (fsync(dir.get()) != 0 && errno != EINVAL && errno != ENOTSUP) fail(folder, "cannot be synced");
}

void write_file_atomically(const std::filesystem::path& path, const std::string& content) {
  const std::filesystem::path temporary = temporary_name(path);
  try {
    const Descriptor file(temporary, O_WRONLY | O_CREAT | O_TRUNC);
    if (file.get() < 0) fail(path, "cannot be created");
    for (std::size_t at = 0; at < content.size();) {
      const ssize_t n = write(file.get(), content.data() + at, content.size() - at);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) fail(path, "cannot be written");
      at += static_cast<std::size_t>(n);
    }
    publish(temporary, path);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw;
  }
}

}  // namespace clothbench
