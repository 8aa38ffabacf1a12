#pragma once

namespace clothbench {

/// Once the user pressed Ctrl-C.
void request_interrupt();
bool interrupt_requested();
/// Before another run in the same process.
void clear_interrupt();

/// While held, runs wait between frames: for a device whose activity is paused. Waits are never timed, and a trial that
/// was held is run again, since its device went to sleep.
void hold_runs(bool held);
/// How often runs have been held so far.
int times_held();

/// What Ctrl-C says to a command that keeps what it has finished.
inline constexpr char kTrialsKept[] = "interrupted; every finished trial is kept (continue with --resume)";
inline constexpr char kRunsKept[] = "interrupted; finished runs are kept (continue with --resume)";

/// Waits while runs are held. Throws Error(`message`, Interrupted) once the user pressed Ctrl-C.
void stop_if_interrupted(const char* message);

}  // namespace clothbench
