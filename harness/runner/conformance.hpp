#pragma once
#include <string>
#include <vector>

#include "clothbench/scene.hpp"
#include "clothbench/solver.hpp"
#include "runner/worker.hpp"

namespace clothbench {

/// Checks for every solver, whatever its method: six frames of each scene with every value of `sides`, on three grids
/// and a triangle mesh; every scene at its own size to its end; and relations of two runs that need no exact solution.
struct ConformanceCase {
  std::string scene;    ///< as commands name it: "paper/gravity"
  std::string sides;    ///< "single", "double-duplicated", "double"; empty: the scene's own
  std::string grid;     ///< "[9,7]"; empty: the scene's own
  std::string profile;  ///< a device class (DeviceOptions::profile), or empty
  bool whole = false;   ///< all frames of the scene instead of six
  bool mesh = false;    ///< the grid's cloth as a triangle mesh (as_mesh)
  /// Relation of this run of the whole scene to a run of the unchanged scene. The maximum distance of a vertex in any
  /// frame from its expected position, divided by the longer side, is at most:
  ///   "repeat"    a second solver object, and a reset: 0 (bit-identical); 1e-6 for the averaged Jacobi of `paper`,
  ///               whose atomic additions have no fixed order
  ///   "restart"   a second solver object continues from the positions and velocities of the middle frame: 1e-4, or
  ///               the change due to frames half as long, whichever is larger
  ///   "mirror"    x -> -x: 1e-4
  ///   "renumber"  vertices numbered column by column: the bound of "restart", because the order of solving may
  ///               change the result within the solver's own error
  ///   "no-op"     a sphere and a box with friction 100 m away: 1e-6
  ///   "small", "large"  all lengths and gravity divided by 64 or multiplied by 256, times unchanged: 1e-2
  std::string relation = {};
};

/// Cases of one scene; for GPU solvers, `profiles` adds cases on device classes that emulate small devices, and of
/// scaled scenes, because contact of other engines has lengths in metres.
/// Relation cases come before the case of the whole scene; only scenes of the folder "conformance" have them.
std::vector<ConformanceCase> conformance_cases(const std::string& scene, bool profiles);

/// The scene of a case. Scenes for which two or three grid lines are too few get the smallest grid that works. A mesh
/// has bending for solvers that support bending of meshes.
Scene conformance_scene(const ConformanceCase&, const std::string& solver);

/// Reason why a case does not apply to the solver, such as "xpbd has no render"; empty if it applies.
std::string conformance_skip(const SolverInfo&, const Scene&);

struct ConformanceResult {
  std::string unsupported;          ///< the solver's own reason for refusing the scene (UnsupportedScene)
  int frames = 0;                   ///< number of frames computed
  std::vector<std::string> faults;  ///< empty: the case passes
};

/// Runs a case and lists its faults: stages that do not serve the scene's needs; a start that differs from the scene's
/// (1e-6 of the width); a frame that fails or is not finite; pins that move (1e-6 of the width); attached vertices over
/// 1 mm from their prescribed positions; costs without a stage; device times from a CPU solver, or none from a GPU
/// solver; a reset to a start that is not bit-identical; validation messages. A whole scene ends after `limit_s` of
/// wall time (0: never) with the faults so far. A case with a relation checks only the relation.
ConformanceResult run_conformance(const SolverEntry&, const nlohmann::json& settings, const DeviceOptions&,
                                  const Scene&, const ConformanceCase&, double limit_s = 0);

/// Names of the relations that apply to a scene; relations.cpp has the changes to the scene and the checks. `scaled`:
/// also relations to scaled scenes.
std::vector<std::string> relations_of(const std::string& scene, bool scaled);
Scene related_scene(const std::string& scene, const std::string& relation);
ConformanceResult run_relation(const SolverEntry&, const nlohmann::json& settings, const DeviceOptions&,
                               const Scene& related, const ConformanceCase&);

/// One row of the command's output, for all cases of a scene: scene, status ("pass", "FAIL", or "skipped" if no case
/// applies to the solver), cases, skipped, frames_whole, frames_of_scene, and faults with the case before each (for a
/// skipped row: the reason). A crash is a fault.
nlohmann::json ask_conformance(Worker&, const SolverEntry&, const nlohmann::json& settings, const DeviceOptions&,
                               const std::string& scene, bool whole, double limit_s);
/// Executes the request of ask_conformance in the worker.
nlohmann::json conformance_answer(const nlohmann::json& request);
/// A row as text for the terminal.
std::string conformance_text(const std::string& solver, const nlohmann::json& row);

/// The chosen scenes; if `chosen` is empty, all tested scenes. Throws Error if a chosen scene is not a tested one.
std::vector<std::string> conformance_scenes(const std::vector<std::string>& chosen);

}  // namespace clothbench
