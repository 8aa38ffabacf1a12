#include "runner/interrupt.hpp"

#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>

#include "clothbench/error.hpp"

namespace clothbench {
namespace {

std::atomic<bool> interrupted{false}, held{false};
std::atomic<int> holds{0};
std::function<void()> report_frames;

void report_at_most_once_a_second() {
  static std::mutex mutex;  // reference solutions are computed on several threads
  static std::chrono::steady_clock::time_point reported;
  const std::unique_lock lock(mutex, std::try_to_lock);
  const auto now = std::chrono::steady_clock::now();
  if (!lock || now - reported < std::chrono::seconds(1)) return;
  reported = now;
  report_frames();
}

}  // namespace

void request_interrupt() { interrupted = true; }
bool interrupt_requested() { return interrupted; }
void clear_interrupt() { interrupted = false; }

void hold_runs(bool on) {
  if (on && !held.exchange(true)) ++holds;
  if (!on) held = false;
}
int times_held() { return holds; }

FrameReports::FrameReports(std::function<void()> report) { report_frames = std::move(report); }
FrameReports::~FrameReports() { report_frames = nullptr; }

void stop_if_interrupted(const char* message) {
  if (report_frames) report_at_most_once_a_second();
  while (held && !interrupted) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  if (interrupted) throw Error(message, ExitCode::Interrupted);
}

}  // namespace clothbench
