#pragma once
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>

namespace clothbench::android {

/// Redirects stdout and stderr of the process to `line`, line by line, until the process ends; Android discards the
/// output of an activity. Create one object and keep it.
class StdoutTap {
 public:
  explicit StdoutTap(std::function<void(const std::string&)> line);
  StdoutTap(const StdoutTap&) = delete;
  StdoutTap& operator=(const StdoutTap&) = delete;
  /// Waits until everything printed so far has been sent, at most 2 s.
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
