#pragma once
#include <functional>

namespace clothbench {

/// Records that the user pressed Ctrl-C.
void request_interrupt();
bool interrupt_requested();
/// Clears that record; call before another run in the same process.
void clear_interrupt();

/// While `held`, runs pause between frames, because the Android activity is paused. Pauses are never timed. A trial
/// with a pause is repeated, because its device was asleep.
void hold_runs(bool held);
/// Number of pauses so far.
int times_held();

/// While one exists, stop_if_interrupted calls `report` at most once per second, to show that a worker is alive.
class FrameReports {
 public:
  explicit FrameReports(std::function<void()> report);
  ~FrameReports();
  FrameReports(const FrameReports&) = delete;
  FrameReports& operator=(const FrameReports&) = delete;
};

/// Message on Ctrl-C for a command that keeps its finished work.
inline constexpr char kTrialsKept[] = "interrupted; every finished trial is kept (continue with --resume)";
inline constexpr char kRunsKept[] = "interrupted; finished runs are kept (continue with --resume)";

/// Waits while runs are paused. Throws Error(`message`, Interrupted) after Ctrl-C.
void stop_if_interrupted(const char* message);

}  // namespace clothbench
