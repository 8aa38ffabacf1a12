#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "clothbench/error.hpp"
#include "clothbench/feature.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {

/// One setting of a solver. `default_json` is a JSON literal, whose type is the type of the setting.
struct SettingSpec {
  std::string name, default_json, doc;
};

/// Description of a solver. A scene that needs a feature outside `supports | ignores` gives the status `unsupported`.
struct SolverInfo {
  std::string name;     ///< as on the command line: "xpbd"
  std::string folder;   ///< source folder, such as "solvers/pbd-gpu"
  std::string summary;  ///< one line
  std::string version;
  std::string precision;  ///< "float32" or "float64"
  bool on_gpu = false;
  FeatureSet supports;
  FeatureSet ignores;  ///< accepted but not simulated, as every table notes (only `ballistic`)
  /// Pairs (feature, condition): {StaticMesh, DuplicatedLayer} = meshes are supported only with a duplicated layer.
  std::vector<std::pair<Feature, Feature>> only_with = {};
  std::vector<SettingSpec> settings;
  int time_order = 1;  ///< declared order of accuracy in the time step, if inner solves are exact
  /// Settings only for tests and measurements; members of the object "tuning": {"shuffles": false}. Help omits them.
  std::vector<SettingSpec> tuning = {};
  std::string engine = {};  ///< engine that a plugin wraps, from clothbench_plugin.h; otherwise empty
};

/// The features of `needs` that the solver cannot run, given `only_with`; empty if it can run the scene.
FeatureSet unsupported(const SolverInfo&, FeatureSet needs);
/// unsupported() as a message: "xpbd has no grips, friction"; empty if the solver can run the scene.
std::string missing_features(const SolverInfo&, FeatureSet needs);

/// The device that a solver runs on; the CPU for CPU solvers.
struct DeviceInfo {
  std::string name, driver, api;
  bool is_software = false;            ///< a CPU rasteriser such as lavapipe: results are valid, times are not
  std::string properties_json = "{}";  ///< all properties that the API reports
};

enum class StepStatus { Ok, NotFinite, Diverged, DeviceLost, TimedOut };

/// One stage of a frame, declared by the solver after `load`. `serves` names the features of the scene that need the
/// stage; it is empty for work in every frame (integration).
struct StagePlan {
  std::string name;
  FeatureSet serves;
  int dispatches = 0;  ///< per frame; 0 on a CPU
  /// Bytes that shaders load and store per frame; not bus traffic. NaN if unknown before a frame, or on a CPU.
  double read_B = 0, write_B = 0;
};

struct BufferPlan {
  std::string name;
  std::uint64_t bytes = 0;
  bool device_local = true;
};

struct LeftOut {
  std::string what, why;
  /// Stiffness that the model does not control without this feature: "strip_Y" (Y of cloth without shear), "sheet_Y" or
  /// "B". Empty if none. The report does not rank the run by a quantity that depends on it.
  std::string no_parameter = {};
};

/// Everything that `load` set up for this scene, and nothing else.
struct Plan {
  std::vector<StagePlan> stages;
  std::vector<BufferPlan> buffers;
  std::vector<LeftOut> left_out;
  /// Contact offset [m] of the solver for each collider of the scene. NaN: the collider's margin_m; empty: margin_m for
  /// all colliders. Metrics use it to decide where the cloth touches and slides.
  std::vector<double> contact_margins_m = {};
  int substeps = 0;  ///< maximum per frame; 0: unknown
};

/// Cost of the last step. Device times are NaN if the device has no timestamps or the solver runs on the CPU.
struct FrameCost {
  double device_s;                                  ///< first to last timestamp
  std::vector<double> stage_device_s;               ///< one per StagePlan, same order
  std::vector<double> stage_read_B, stage_write_B;  ///< NaN unless counted (`count_bytes`) or declared in the plan
};

/// Number of events since `reset` in which a solver missed a guarantee. Stored as a series over the frames of a run.
struct SolverCount {
  std::string name, long_name;
  double count = 0;
  std::string fault = {};  ///< error message if a count above 0 makes the run an error
};

/// Input of one frame. All times are at the frame's end.
struct FrameInput {
  int index = 0;
  double time_s = 0;
  double dt_s = 0;
  const FrameMotion* motion =
      nullptr;  ///< at the frame's end; null if the scene has no motion. At reset it is scene.motion[0]
};

/// Positions [m] and velocities [m/s], xyz interleaved, scene vertex order.
struct ClothState {
  std::vector<double> position, velocity;
};

/// Options of the run that are not settings of the solver.
struct DeviceOptions {
  int index = -1;           ///< -1: the best device present
  bool validation = false;  ///< Vulkan core + synchronization validation; any message makes the run fail
  /// Device class whose limits to emulate, such as "adreno-like": less memory, smaller workgroups. Empty:
  /// $CLOTHBENCH_DEVICE_PROFILE, otherwise the device's own limits.
  std::string profile = "";
};

/// A cloth solver. Order of calls: construct -> load -> (reset -> step...)*. It never uses a metric, a clock or a file.
class ClothSolver {
 public:
  virtual ~ClothSolver() = default;
  virtual const SolverInfo& info() const = 0;
  virtual DeviceInfo device() const = 0;
  /// Allocates only what this scene needs and sets the cloth to its initial state. Throws Error if the device is
  /// missing. `scene` must outlive the solver's use of it.
  virtual void load(const Scene& scene) = 0;
  /// Restores the initial state of the loaded scene, bit for bit.
  virtual void reset() = 0;
  /// Computes one displayed frame and returns when the device has finished it.
  virtual StepStatus step(const FrameInput&) = 0;
  /// Number of frames of the loaded scene that `run_frames` keeps in flight; 1: it calls `step` for each.
  virtual int frames_in_flight() const { return 1; }
  /// Equivalent to `step` for each frame; all are complete on return, but a frame may start before the previous one is
  /// complete. The final state is bit-identical to `step`'s. Stops at the first frame whose status is not Ok.
  virtual StepStatus run_frames(const std::vector<FrameInput>& frames) {
    StepStatus status = StepStatus::Ok;
    for (std::size_t k = 0; k < frames.size() && status == StepStatus::Ok; ++k) status = step(frames[k]);
    return status;
  }
  virtual void read_state(ClothState&) const = 0;
  /// Continues from positions and velocities that `read_state` returned for this scene. Returns false and changes
  /// nothing if they are not the complete state, because the solver keeps more or the scene has motion.
  virtual bool restart(const ClothState&) { return false; }
  /// As `restart`, from the state at the end of frame `last`, for solvers whose state depends on the time in the scene.
  virtual bool restart_at(const ClothState& state, const FrameInput& /*last*/) { return restart(state); }
  virtual FrameCost last_cost() const = 0;
  virtual Plan plan() const = 0;
  /// The same counters in the same order after every frame of a loaded scene; empty if the solver has none.
  virtual std::vector<SolverCount> counts() const { return {}; }
  /// Messages of the validation layer that this solver has caused so far; 0 without a validation layer.
  virtual int validation_messages() const { return 0; }
};

/// A solver's registry entry. The `settings` for `make` are complete: every SettingSpec, with its type.
struct SolverEntry {
  SolverInfo info;
  std::function<std::unique_ptr<ClothSolver>(const nlohmann::json& settings, const DeviceOptions&)> make;
  /// Vertical displacement [m] (downwards negative) of a body in free fall after `frames` frames, from the scene's
  /// vertical gravity, vertical initial velocity and damping. It follows the integrator's exact order of updates.
  std::function<double(const Scene&, const nlohmann::json& settings, int frames)> free_fall_m;
  /// Devices that this solver can run on, in the order of --device; null = only the CPU.
  std::function<std::vector<DeviceInfo>()> devices = nullptr;
};

/// For solvers that bend only grids: throws if the scene has a triangle mesh with bending rigidity.
inline void refuse_mesh_bending(const Scene& scene) {
  if (scene.cloth.mesh && scene.material.bending_rigidity_N_m > 0)
    throw UnsupportedScene("it cannot bend triangle meshes; the solvers reference and xpbd can");
}

/// All registered solvers, in registration order (solvers/CMakeLists.txt).
const std::vector<SolverEntry>& solvers();
/// Names of the solvers whose sources are in this tree, built or not, from solvers/CMakeLists.txt. If a study names one
/// that is not in this build, its rows are `unsupported`; any other unknown name is an error.
const std::vector<std::string>& solver_names_of_tree();
/// Prefix of a shared library's path on the command line; prefix and path make up the plugin's SolverInfo::folder.
inline constexpr char kPluginPrefix[] = "plugin:";
/// The solver in a shared library (clothbench_plugin.h). `name`: "plugin:PATH", or the name of a plugin that this
/// process or its parent has loaded. Null for another name. Throws Error if the library is not a solver.
const SolverEntry* external_solver(const std::string& name);
inline bool is_external(const SolverInfo& info) { return info.folder.starts_with(kPluginPrefix); }
/// Finds a solver by name or "plugin:PATH". Throws Error that suggests the most similar known name.
const SolverEntry& find_solver(const std::string& name);
/// Name of the setting whose members are SolverInfo::tuning.
inline constexpr char kTuning[] = "tuning";
/// Fills in defaults; throws Error for a wrong type or an unknown key (and suggests the most similar known one).
nlohmann::json complete_settings(const SolverInfo&, const nlohmann::json& given);
/// The most similar of `known` by edit distance, for messages; empty if none is similar.
std::string nearest(const std::string& word, const std::vector<std::string>& known);

}  // namespace clothbench
