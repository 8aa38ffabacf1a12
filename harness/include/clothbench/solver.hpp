#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "clothbench/feature.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {

/// One knob of a solver. `default_json` is a JSON literal and fixes the type.
struct SettingSpec {
  std::string name, default_json, doc;
};

/// What a backend is and can do. A scene feature outside `supports | ignores` makes the cell an `unsupported` row.
struct SolverInfo {
  std::string name;     ///< as on the command line: "xpbd"
  std::string folder;   ///< where it lives: "solvers/pbd-gpu"
  std::string summary;  ///< one line
  std::string version;
  std::string precision;  ///< "float32" or "float64"
  bool on_gpu = false;
  FeatureSet supports;
  FeatureSet ignores;  ///< runs without serving these, and every table says so (only `ballistic` does)
  /// Features supported only beside another: {StaticMesh, DuplicatedLayer} = meshes only with a duplicated layer.
  std::vector<std::pair<Feature, Feature>> only_with = {};
  std::vector<SettingSpec> settings;
  int time_order = 1;  ///< order of accuracy in the time step that the integrator declares, everything else solved
  /// Knobs for tests and measurements alone, members of one setting that is an object: "tuning": {"shuffles": false}.
  /// No list shows them.
  std::vector<SettingSpec> tuning = {};
};

/// What of a scene's needs the solver cannot do, `only_with` taken into account; empty if it can run the scene.
FeatureSet unsupported(const SolverInfo&, FeatureSet needs);

/// The device a solver runs on; the CPU for CPU solvers.
struct DeviceInfo {
  std::string name, driver, api;
  bool is_software = false;  ///< a CPU rasteriser such as lavapipe: good for correctness, not for speed claims
  std::string properties_json = "{}";  ///< everything the API tells of it
};

enum class StepStatus { Ok, NotFinite, Diverged, DeviceLost, TimedOut };

/// One stage of a frame as the solver declares it after `load`. `serves` ties the stage to the scene's needs: empty
/// for what every frame does (integration), otherwise only features the scene asked for.
struct StagePlan {
  std::string name;
  FeatureSet serves;
  int dispatches = 0;  ///< per frame; 0 on a CPU
  /// Bytes that shaders load and store in a frame, computed by the host from the scene and the kernels' loops and
  /// checked against an instrumented build of the kernels in tests; not the traffic on the memory bus. NaN on a CPU.
  double read_B = 0, write_B = 0;
  bool at_least = false;  ///< read_B is a lower bound: how much more is read depends on how the cloth lies
};

struct BufferPlan {
  std::string name;
  std::uint64_t bytes = 0;
  bool device_local = true;
};

struct LeftOut {
  std::string what, why;
};

/// Everything `load` set up for this scene and nothing else.
struct Plan {
  std::vector<StagePlan> stages;
  std::vector<BufferPlan> buffers;
  std::vector<LeftOut> left_out;
  /// Distance [m] at which the solver holds the cloth off each collider of the scene, where that is not the collider's
  /// own margin_m (which NaN stands for); empty = it is for all of them. Metrics judge touch and slip by it.
  std::vector<double> contact_margins_m = {};
};

/// Cost of the last step. Device times are NaN where the device has no timestamps or the solver runs on the CPU.
struct FrameCost {
  double device_s;                     ///< first to last timestamp
  std::vector<double> stage_device_s;  ///< one per StagePlan, same order
  std::vector<double> stage_read_B, stage_write_B;
};

/// What changes in a frame. Times are those at the frame's end.
struct FrameInput {
  int index = 0;
  double time_s = 0;
  double dt_s = 0;
  const FrameMotion* motion =
      nullptr;  ///< at the frame's end; null where nothing moves. At reset it is scene.motion[0]
};

/// Positions [m] and velocities [m/s], xyz interleaved, scene vertex order.
struct ClothState {
  std::vector<double> position, velocity;
};

/// Options of the run that are not the solver's own.
struct DeviceOptions {
  int index = -1;           ///< -1: best present
  bool validation = false;  ///< Vulkan core + synchronization validation; any message makes the run fail
  /// A class of devices to stand in for, such as "adreno-like": less memory, smaller groups, shorter submissions.
  /// Empty: $CLOTHBENCH_DEVICE_PROFILE, else the device as it is.
  std::string profile = "";
};

/// A cloth backend. Life: construct -> load -> (reset -> step...)*. Never sees a metric, a clock or a file.
class ClothSolver {
 public:
  virtual ~ClothSolver() = default;
  virtual const SolverInfo& info() const = 0;
  virtual DeviceInfo device() const = 0;
  /// Allocates for this scene and nothing else, and puts the cloth in its initial state. Throws Error on a missing
  /// device. `scene` outlives the solver's use of it.
  virtual void load(const Scene& scene) = 0;
  /// Back to the initial state of the loaded scene, bit for bit.
  virtual void reset() = 0;
  /// One displayed frame, complete on return (the device has finished).
  virtual StepStatus step(const FrameInput&) = 0;
  /// How many frames of the loaded scene `run_frames` keeps in flight; 1: it is `step` after `step`.
  virtual int frames_in_flight() const { return 1; }
  /// As `step` for each, all complete on return, but a frame need not be complete before the next is begun. The cloth
  /// ends bit for bit as it would by `step`. Stops at the first that does not end well.
  virtual StepStatus run_frames(const std::vector<FrameInput>& frames) {
    StepStatus status = StepStatus::Ok;
    for (std::size_t k = 0; k < frames.size() && status == StepStatus::Ok; ++k) status = step(frames[k]);
    return status;
  }
  virtual void read_state(ClothState&) const = 0;
  /// Goes on from positions and velocities that `read_state` gave on this scene. False, and nothing changes, where they
  /// do not tell all: a solver that keeps more, a scene in which something moves.
  virtual bool restart(const ClothState&) { return false; }
  virtual FrameCost last_cost() const = 0;
  virtual Plan plan() const = 0;
  /// Messages of the validation layer that this solver has caused so far; 0 where there is none.
  virtual int validation_messages() const { return 0; }
};

/// What a solver folder registers: its description and how to make one. `settings` is complete: every SettingSpec
/// is present with its declared type.
struct SolverEntry {
  SolverInfo info;
  std::function<std::unique_ptr<ClothSolver>(const nlohmann::json& settings, const DeviceOptions&)> make;
  /// Exact velocity-update order of the integrator, for the free-fall check: position after n frames of a body
  /// that only falls, relative to its start [m] (vertical component, downwards negative), from the scene's vertical
  /// gravity, vertical initial velocity and damping.
  std::function<double(const Scene&, const nlohmann::json& settings, int frames)> free_fall_m;
  /// Devices this backend could run on, in the order of --device; empty function = the CPU alone.
  std::function<std::vector<DeviceInfo>()> devices = nullptr;
};

/// All registered solvers, in registration order (solvers/CMakeLists.txt).
const std::vector<SolverEntry>& solvers();
/// Before the path of a shared library, on the command line; with the path a plugin's `folder`.
inline constexpr char kPluginPrefix[] = "plugin:";
/// A solver that was built elsewhere (clothbench_plugin.h): "plugin:PATH", or the name of one that was loaded so
/// before, here or in the process that started this one. Null if it is neither; throws Error if the library is no
/// solver.
const SolverEntry* external_solver(const std::string& name);
inline bool is_external(const SolverInfo& info) { return info.folder.starts_with(kPluginPrefix); }
/// By name or as "plugin:PATH". Throws Error naming the nearest known solver.
const SolverEntry& find_solver(const std::string& name);
/// The setting whose members are SolverInfo::tuning.
inline constexpr char kTuning[] = "tuning";
/// Fills in defaults; throws Error on an unknown key (with the nearest known one) or a wrong type. Members of `tuning`
/// are taken beside the others too, where they were once: they are put into their place, and stderr says so once.
nlohmann::json complete_settings(const SolverInfo&, const nlohmann::json& given);
/// With the members of `tuning` beside the others: settings that are equal so are the same, however they are written.
nlohmann::json flat_settings(nlohmann::json settings);
/// Nearest of `known` by edit distance, for messages; empty if none is near.
std::string nearest(const std::string& word, const std::vector<std::string>& known);

}  // namespace clothbench
