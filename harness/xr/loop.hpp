#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"
#include "xr/frame_log.hpp"

namespace clothbench::xr {

/// The longest session whose recording a scene can read again: two minutes at 72 Hz.
inline constexpr int kMostFrames = 8640;

struct LoopOptions {
  std::string scenario;
  std::vector<std::string> overrides;
  const SolverEntry* entry = nullptr;
  nlohmann::json settings;  ///< complete
  std::string setting = "default";
  DeviceOptions device;  ///< its index does not count: the runtime chooses
  std::string runtime;   ///< as Instance takes it
  double rate_hz = 72;   ///< asked of the display
  int frames = 0;        ///< 0: as many as the scenario lasts
  /// The scene's origin in the user's space; left out: 60 cm before and 10 cm below the eyes, or where the floor is for
  /// a room.
  std::optional<Vec3> place_m;
  bool passthrough = true;
  double timeout_s = 120;  ///< for hands to be seen and points to be picked
  std::filesystem::path out;
  std::function<void(const std::string&)> tell;  ///< what the user should know; may be empty
};

struct LoopResult {
  FrameLog log;
  Outcome outcome;
  std::filesystem::path scenario;  ///< replays the session
  std::filesystem::path file;      ///< the result file
  std::vector<double> final_position_m;
  std::map<std::string, double> summary;
  int validation_messages = 0;
};

/// A live session: the user sees a cloth and touches it. Waits until hands are seen or points are picked,
/// then steps the solver once a displayed frame, by the display's refresh period, as the application of the paper does:
/// where frames are shown late the cloth moves slower, and the log says so. Ends after `frames`, when the runtime ends
/// the session, when it is interrupted, or where the device is lost or a call fails once the first frame was stepped
/// (`outcome` says which); all of these store what there is. Throws Error with ExitCode::NoDevice where there is no
/// headset.
LoopResult run_loop(const LoopOptions&);

}  // namespace clothbench::xr
