#pragma once
// The command as a user calls it.
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>

#include "with_folder.hpp"

namespace clothbench::testing_command {

struct Answer {
  int code = -1;  ///< exit code, or 128 + the signal's number
  std::string text;
};

/// Streams in a command's text.
enum class Streams { Both, Out };

/// Runs `clothbench <arguments>` in a shell. `before`: assignments of its environment.
inline Answer command(const std::string& arguments, Streams streams = Streams::Both, const std::string& before = "") {
  const std::string line =
      before + " " + CLOTHBENCH_COMMAND + " " + arguments + (streams == Streams::Both ? " 2>&1" : " 2>/dev/null");
  Answer a;
  FILE* pipe = popen(line.c_str(), "r");
  if (pipe == nullptr) return a;
  std::array<char, 4096> chunk{};
  while (const std::size_t n = fread(chunk.data(), 1, chunk.size(), pipe)) a.text.append(chunk.data(), n);
  const int status = pclose(pipe);
  a.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return a;
}

}  // namespace clothbench::testing_command
