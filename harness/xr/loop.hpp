#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"
#include "xr/frame_log.hpp"

namespace clothbench::xr {

/// Maximum length of a session, set by the recordings that a scene can read: two minutes at 72 Hz.
inline constexpr int kMostFrames = 8640;

struct LoopOptions {
  std::string scenario;
  std::vector<std::string> overrides;
  const SolverEntry* entry = nullptr;
  nlohmann::json settings;  ///< complete
  std::string setting = "default";
  DeviceOptions device;    ///< its index is ignored, because the runtime chooses the device
  double rate_hz = 72;     ///< requested refresh rate of the display
  int frames = 0;          ///< 0: the scene's length
  double timeout_s = 120;  ///< how long to wait for tracked hands
  bool table = false;      ///< the cloth is put over the user's table, which replaces the scene's static colliders
  std::filesystem::path out;
  std::function<void(const std::string&)> tell;  ///< receives messages for the user; may be empty
};

struct LoopResult {
  FrameLog log;
  StoredGroup counters;  ///< of the runtime, frame by frame; no array if it has none
  Outcome outcome;
  std::filesystem::path scenario;  ///< file that replays the session
  std::filesystem::path file;      ///< the result file
  std::vector<double> final_position_m;
  std::map<std::string, double> summary;
  int validation_messages = 0;
};

/// A live session: the user sees a cloth and touches it. Waits until hands are tracked. Then steps the solver once per
/// displayed frame, by the display's refresh period, as the application of the paper does. If frames are displayed
/// late, the cloth moves slower than real time, and the log shows it. Ends after `frames`, when the runtime ends the
/// session, on interruption, or if the device is lost or a call fails after the first step (`outcome` states which); in
/// all of these cases the frames so far are stored. Throws Error with ExitCode::NoDevice if there is no headset.
LoopResult run_loop(const LoopOptions&);

}  // namespace clothbench::xr
