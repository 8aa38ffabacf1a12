// Stand-in for Android's liblog: one line a call on the stderr the process began with, as logcat prints it.
#include <android/log.h>
#include <unistd.h>

#include <string>

namespace {
// The activity sends the process's stdout and stderr to the log; the log must not go there again.
const int kOut = dup(STDERR_FILENO);
}  // namespace

extern "C" int __android_log_write(int, const char* tag, const char* text) {
  const std::string line = std::string("I ") + tag + ": " + text + "\n";
  return static_cast<int>(write(kOut, line.data(), line.size()));
}
