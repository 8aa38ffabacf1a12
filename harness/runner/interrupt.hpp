#pragma once
#include <functional>

namespace clothbench {

/// Called when the user presses Ctrl-C.
void request_interrupt();
bool interrupt_requested();
/// Called before another run in the same process.
void clear_interrupt();

/// While held, runs wait between frames; used when a device's activity is paused. Waits are never timed. A trial that
/// was held is run again, since its device was asleep.
void hold_runs(bool held);
/// How often runs have been held so far.
int times_held();

/// While there is one, stop_if_interrupted calls `report` at most once per second: the sign of life of a worker.
class FrameReports {
 public:
  explicit FrameReports(std::function<void()> report);
  ~FrameReports();
  FrameReports(const FrameReports&) = delete;
  FrameReports& operator=(const FrameReports&) = delete;
};

/// Messages on Ctrl-C for a command that keeps its finished work.
inline constexpr char kTrialsKept[] = "interrupted; every finished trial is kept (continue with --resume)";
inline constexpr char kRunsKept[] = "interrupted; finished runs are kept (continue with --resume)";

/// Waits while runs are held. Throws Error(`message`, Interrupted) once the user pressed Ctrl-C.
void stop_if_interrupted(const char* message);

}  // namespace clothbench
