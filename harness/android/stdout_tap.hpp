#pragma once
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>

namespace clothbench::android {

/// Sends what the process prints (stdout and stderr) to `line`, line by line, for the rest of the process's life: an
/// activity's own go nowhere. Make one, and keep it.
class StdoutTap {
 public:
  explicit StdoutTap(std::function<void(const std::string&)> line);
  StdoutTap(const StdoutTap&) = delete;
  StdoutTap& operator=(const StdoutTap&) = delete;
  /// Returns once everything printed so far has been sent, or after 2 s.
  void flush();

 private:
  void read_all();
  void take(const std::string& text);

  std::function<void(const std::string&)> line_;
  int read_end_ = -1;
  std::mutex mutex_;
  std::condition_variable changed_;
  unsigned asked_ = 0, answered_ = 0;
};

}  // namespace clothbench::android
