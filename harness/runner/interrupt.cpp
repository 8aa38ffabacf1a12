#include "runner/interrupt.hpp"

#include <atomic>
#include <chrono>
#include <thread>

#include "clothbench/error.hpp"

namespace clothbench {
namespace {

std::atomic<bool> interrupted{false}, held{false};
std::atomic<int> holds{0};

}  // namespace

void request_interrupt() { interrupted = true; }
bool interrupt_requested() { return interrupted; }
void clear_interrupt() { interrupted = false; }

void hold_runs(bool on) {
  if (on && !held.exchange(true)) ++holds;
  if (!on) held = false;
}
int times_held() { return holds; }

void stop_if_interrupted(const char* message) {
  while (held && !interrupted) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  if (interrupted) throw Error(message, ExitCode::Interrupted);
}

}  // namespace clothbench
