#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "cli/command_line.hpp"
#include "runner/interrupt.hpp"

namespace {

void on_signal(int) {
  // A second Ctrl-C exits at once.
  if (clothbench::interrupt_requested()) std::_Exit(130);
  clothbench::request_interrupt();
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  const int code = clothbench::run_command_line({argv + (argc > 0 ? 1 : 0), argv + argc});
  std::fflush(stdout);
  dup2(STDERR_FILENO, STDOUT_FILENO);  // plugins may print while they unload; the summary must not contain that
  return code;
}
